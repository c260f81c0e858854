#include "tools/output/band_output.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/output/compare_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

// A slope is confirmed where the power law through it meets the value computed at an end to this share of the change,
// or of one per cent of the value.
constexpr double straight = 0.2, small_change = 0.01;

Json finite_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

const ComparedQuantity* same_quantity(const std::vector<ComparedQuantity>& list, const ComparedQuantity& of) {
  const auto found =
      std::ranges::find_if(list, [&](const ComparedQuantity& one) { return one.of == of.of && one.name == of.name; });
  return found == list.end() ? nullptr : &*found;
}

std::optional<double> slope_of(const BandSides& band, const ComparedQuantity& quantity) {
  for (const BandSlope& slope : band.slopes) {
    if (slope.quantity == "bearing" ? quantity.of == "bearings" && quantity.name == slope.of
                                    : quantity.of == slope.of && quantity.name == slope.quantity)
      return slope.value;
  }
  return std::nullopt;
}

// Whether value * factor^slope is what was computed there.
bool is_straight(double value, double slope, double factor, double computed) {
  const double predicted = value * std::pow(factor, slope);
  return std::abs(predicted - computed) <=
         std::max(straight * std::abs(computed - value), small_change * std::abs(value));
}

Json quantity_json(const BandSides& band, const ComparedQuantity& low, const ComparedQuantity* high) {
  Json json = {{"of", low.of},
               {"name", low.name},
               {"unit", low.unit},
               {"nominal", finite_number(low.a)},
               {"from", finite_number(low.b)},
               {"to", finite_number(high ? high->b : std::nullopt)},
               {"error", finite_number(low.error_a)},
               {"error_from", finite_number(low.error_b)},
               {"error_to", finite_number(high ? high->error_b : std::nullopt)}};
  const std::optional<double> slope = slope_of(band, low);
  json["slope"] = finite_number(slope);
  if (!slope || !low.a || !low.b || !high || !high->b) return json;
  json["straight"] = (band.asked.from == 0 || is_straight(*low.a, *slope, band.asked.from, *low.b)) &&
                     is_straight(*low.a, *slope, band.asked.to, *high->b);
  return json;
}

std::string shown(const Json& value, const Json& error) {
  if (!value.is_number()) return "none";
  const double number = value.get<double>();
  const double bar = error.is_number() ? error.get<double>() : 1e-6 * std::abs(number);
  return fmt::format("{:.{}g}", number, std::min(6, trusted_digits(number, bar)));
}

// What is rounding counts as 0.
double rounded(double slope) { return std::abs(slope) < 1e-6 ? 0 : slope; }

std::string verdict_at(const Json& verdict) {
  return verdict.is_string() ? verdict.get<std::string>() : "not computed";
}

}  // namespace

Json bands_json(const Json& nominal, const std::vector<SensitivityBand>& bands) {
  const auto document = [](const SteadyResult& result) {
    return steady_json(*result.model, result, result.settings, false);
  };
  std::vector<BandSides> sides;
  for (const SensitivityBand& band : bands)
    sides.push_back({band.asked, document(band.low), document(band.high), band.slopes});
  return bands_json(nominal, sides);
}

Json bands_json(const Json& nominal, const std::vector<NonlinearBand>& bands) {
  const auto document = [](const NonlinearSteady& result) {
    return nonlinear_json(*result.model, result, result.settings, false);
  };
  std::vector<BandSides> sides;
  for (const NonlinearBand& band : bands) sides.push_back({band.asked, document(band.low), document(band.high)});
  return bands_json(nominal, sides);
}

Json bands_json(const Json& nominal, const std::vector<BandSides>& bands) {
  Json list = Json::array();
  for (const BandSides& band : bands) {
    const ComparedSide here{"", nominal}, low{"", band.low}, high{"", band.high};
    const auto of = [](const Json& document, const char* key) {
      return document.contains(key) ? document.at(key) : Json(nullptr);
    };
    Json entry = {{"parameter", to_string(band.asked.parameter)},
                  {"from", band.asked.from},
                  {"to", band.asked.to},
                  {"verdict", of(nominal, "verdict")},
                  {"verdict_from", of(low.document, "verdict")},
                  {"verdict_to", of(high.document, "verdict")}};
    const std::vector<ComparedQuantity> at_low = compared_quantities(here, low),
                                        at_high = compared_quantities(here, high);
    Json& quantities = entry["quantities"] = Json::array();
    for (const ComparedQuantity& quantity : at_low)
      quantities.push_back(quantity_json(band, quantity, same_quantity(at_high, quantity)));
    list.push_back(std::move(entry));
  }
  return list;
}

std::string bands_table(const Json& bands) {
  std::string text;
  for (const Json& band : bands) {
    const std::string name = band["parameter"].get<std::string>();
    const double from = band["from"].get<double>(), to = band["to"].get<double>();
    text += fmt::format(
        "\n{} of the elastic links times {:g} to {:g}\n  {:<12}  {:<24}  {:<6}  {:>12}  {:>12}  {:>12}  {:>16}\n", name,
        from, to, "", "", "", fmt::format("{:g} {}", from, name), "as given", fmt::format("{:g} {}", to, name),
        "% per % of it");
    for (const Json& quantity : band["quantities"]) {
      std::string slope;
      if (quantity["slope"].is_number())
        slope = fmt::format("{:.3g}{}", rounded(quantity["slope"].get<double>()),
                            quantity.contains("straight") && !quantity["straight"].get<bool>() ? " *" : "  ");
      text +=
          fmt::format("  {:<12}  {:<24}  {:<6}  {:>12}  {:>12}  {:>12}  {:>16}\n", quantity["of"].get<std::string>(),
                      quantity["name"].get<std::string>(), quantity["unit"].get<std::string>(),
                      shown(quantity["from"], quantity["error_from"]), shown(quantity["nominal"], quantity["error"]),
                      shown(quantity["to"], quantity["error_to"]), slope);
    }
    if (band["verdict"].is_string())
      text += fmt::format("  verdict: {} at {:g}, {} as given, {} at {:g}\n", verdict_at(band["verdict_from"]), from,
                          verdict_at(band["verdict"]), verdict_at(band["verdict_to"]), to);
  }
  if (text.find(" *\n") != std::string::npos)
    text += "  * holds near the given value only: the ends, computed, are elsewhere\n";
  return text;
}

}  // namespace hb::tools
