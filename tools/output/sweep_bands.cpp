#include "tools/output/sweep_bands.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "tools/output/compare_output.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_output.hpp"

namespace hb::tools {
namespace {

struct BandQuantity {
  const char *key, *inner, *label;  // in the document of a rod; inner: below the key, or null
  double ComparedFactors::*factor;
};

constexpr BandQuantity band_quantities[] = {{"deflection", nullptr, "deflection [mm]", &ComparedFactors::length},
                                            {"stress", "max_abs", "stress [MPa]", &ComparedFactors::stress},
                                            {"growth_rate", nullptr, "growth rate", nullptr}};

const Json* array_of(const Json& rod, const BandQuantity& quantity) {
  if (!rod.contains(quantity.key)) return nullptr;
  const Json& found = rod.at(quantity.key);
  if (!quantity.inner) return &found;
  return found.is_object() && found.contains(quantity.inner) ? &found.at(quantity.inner) : nullptr;
}

Json end_of(const Json& document) {
  Json end = Json::object();
  if (document.contains("verdict")) end["verdict"] = document["verdict"];
  Json& rods = end["rods"] = Json::object();
  for (const auto& [name, rod] : document.at("rods").items()) {
    Json own = Json::object();
    for (const char* key :
         {"max_abs", "deflection", "bending_moment", "stress", "growth_rate", "growth_error", "verdict"})
      if (rod.contains(key)) own[key] = rod[key];
    rods[name] = std::move(own);
  }
  return end;
}

std::size_t unstable_points(const Json& document) {
  std::size_t count = 0;
  if (document.contains("verdict"))
    for (const Json& verdict : document["verdict"]) count += verdict == "unstable";
  return count;
}

double largest_of(const Json* array) {
  double most = nan;
  for (const Json& value : *array)
    if (value.is_number()) most = std::fmax(most, value.get<double>());
  return most;
}

double entry_of(const Json* array, std::size_t k) {
  return array && k < array->size() && (*array)[k].is_number() ? (*array)[k].get<double>() : nan;
}

}  // namespace

Json sweep_bands_json(const Json& nominal, const std::vector<SweepBand>& bands) {
  (void)nominal;
  Json list = Json::array();
  for (const SweepBand& band : bands)
    list.push_back({{"parameter", to_string(band.asked.parameter)},
                    {"from", band.asked.from},
                    {"to", band.asked.to},
                    {"at_from", end_of(sweep_json(*band.low.scene, band.low, false))},
                    {"at_to", end_of(sweep_json(*band.high.scene, band.high, false))}});
  return list;
}

std::vector<BandExtreme> band_extremes(const Json& nominal, const Json& band) {
  const ComparedFactors factors = compared_factors(nominal);
  std::vector<BandExtreme> list;
  for (const auto& [rod, own] : nominal.at("rods").items())
    for (const BandQuantity& quantity : band_quantities) {
      const Json *here = array_of(own, quantity), *low = array_of(band["at_from"]["rods"][rod], quantity),
                 *high = array_of(band["at_to"]["rods"][rod], quantity);
      if (!here || !low || !high) continue;
      const double factor = quantity.factor ? factors.*quantity.factor : 1;
      list.push_back({rod + " " + quantity.label + (quantity.factor ? "" : " [" + factors.rate_unit + "]"),
                      factor * largest_of(low), factor * largest_of(here), factor * largest_of(high)});
    }
  const auto unstable = [](const Json& document) { return static_cast<double>(unstable_points(document)); };
  if (nominal.contains("verdict"))
    list.push_back({fmt::format("unstable points of {}", nominal["verdict"].size()), unstable(band["at_from"]),
                    unstable(nominal), unstable(band["at_to"])});
  return list;
}

std::string sweep_bands_table(const Json& nominal, const Json& bands) {
  std::string text;
  for (const Json& band : bands) {
    const std::string name = band["parameter"];
    const double from = band["from"], to = band["to"];
    text += fmt::format(
        "\n{} of the elastic links times {:g} to {:g}, largest of all points\n  {:<34}  {:>12}  {:>12}  {:>12}\n", name,
        from, to, "", fmt::format("{:g} {}", from, name), "as given", fmt::format("{:g} {}", to, name));
    for (const BandExtreme& extreme : band_extremes(nominal, band))
      text += fmt::format("  {:<34}  {:>12.5g}  {:>12.5g}  {:>12.5g}\n", extreme.name, extreme.low, extreme.given,
                          extreme.high);
  }
  return text;
}

std::vector<BandCurves> band_curves(const Json& nominal, const Json& bands, const std::string& axis) {
  const ComparedFactors factors = compared_factors(nominal);
  const auto x = nominal.at("x").at("values").get<std::vector<double>>();
  std::vector<BandCurves> list;
  for (const Json& band : bands)
    for (const auto& [rod, own] : nominal.at("rods").items()) {
      BandCurves curves{rod, band["parameter"], band["from"], band["to"], {}, {}};
      curves.csv.name = file_name(fmt::format("sweep_band_{}_{}", curves.parameter, rod)) + ".csv";
      curves.csv.comment = {fmt::format("{}: {} times {:g} and {:g}", rod, curves.parameter, curves.from, curves.to)};
      curves.csv.columns = {axis};
      std::vector<std::pair<const Json*, double>> columns;
      for (const BandQuantity& quantity : band_quantities) {
        const Json *here = array_of(own, quantity), *low = array_of(band["at_from"]["rods"][rod], quantity),
                   *high = array_of(band["at_to"]["rods"][rod], quantity);
        if (!here || !low || !high) continue;
        const double factor = quantity.factor ? factors.*quantity.factor : 1;
        const std::string label = std::string(quantity.label) + (quantity.factor ? "" : " [" + factors.rate_unit + "]");
        curves.labels.push_back(label);
        for (const auto& [array, what] : {std::pair(here, "as given"), {low, "from"}, {high, "to"}}) {
          columns.push_back({array, factor});
          curves.csv.columns.push_back(label + " " + what);
        }
      }
      if (columns.empty()) continue;
      curves.csv.rows.resize(static_cast<Eigen::Index>(x.size()), static_cast<Eigen::Index>(columns.size()) + 1);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        curves.csv.rows(row, 0) = x[k];
        for (std::size_t c = 0; c < columns.size(); ++c)
          curves.csv.rows(row, static_cast<Eigen::Index>(c) + 1) = columns[c].second * entry_of(columns[c].first, k);
      }
      list.push_back(std::move(curves));
    }
  return list;
}

std::vector<BandCurves> band_responses(const SteadyResult& nominal, const std::vector<SensitivityBand>& bands) {
  constexpr Eigen::Index N = 720;
  std::vector<BandCurves> list;
  const std::string unit = bracketed(output_units(nominal.model->scene).response);
  for (const SensitivityBand& band : bands)
    for (std::size_t r = 0; r < nominal.rods.size(); ++r) {
      const RodResult* sides[] = {&nominal.rods[r], &band.low.rods[r], &band.high.rods[r]};
      const bool known = nominal.rods[r].reported && std::ranges::all_of(sides, [](const RodResult* rod) {
                           return rod->steady && rod->steady->status != SteadyStatus::singular;
                         });
      if (!known) continue;
      BandCurves curves{nominal.rods[r].name, to_string(band.asked.parameter), band.asked.from, band.asked.to, {}, {}};
      curves.csv.name = file_name(fmt::format("band_{}_{}", curves.parameter, curves.rod)) + ".csv";
      curves.csv.comment = {
          fmt::format("{}: q_1 with {} times {:g} and {:g}", curves.rod, curves.parameter, curves.from, curves.to)};
      curves.labels = {"q_1" + unit};
      curves.csv.columns = {"crank angle [deg]", "q_1 as given" + unit, "q_1 from" + unit, "q_1 to" + unit};
      curves.csv.rows.resize(N + 1, 4);
      for (Eigen::Index j = 0; j <= N; ++j) {
        const double tau = two_pi * static_cast<double>(j) / N;
        curves.csv.rows(j, 0) = 360 * static_cast<double>(j) / N;
        for (int s = 0; s < 3; ++s) curves.csv.rows(j, s + 1) = fourier::evaluate(sides[s]->steady->q, tau)(0);
      }
      list.push_back(std::move(curves));
    }
  return list;
}

}  // namespace hb::tools
