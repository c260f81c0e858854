#include "tools/output/map_theory_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hb/analysis/theory_error.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

bool is_linkage(const MapDocument& document) { return std::holds_alternative<Linkage>(document.scene.model); }

std::size_t count_beyond(const MapResult& r) {
  return static_cast<std::size_t>(std::ranges::count_if(r.theory, &TheoryPlace::beyond));
}

std::string where(const MapDocument& document, const TheoryPlace& place) {
  return place_words(document, document.result.x()[place.x], document.result.y()[place.y]);
}

// The mechanism's growth rate at a place that was looked at.
double growth_at(const MapResult& r, const TheoryPlace& place) {
  return r.worst()[place.x + r.x().size() * place.y].growth_rate;
}

// Of a rod; empty where it is within the linear theory at all of them.
std::string beyond_words(const MapDocument& document, std::size_t rod) {
  const MapResult& r = document.result;
  std::size_t count = 0, without = 0;
  double largest = 0;
  const TheoryPlace *first = nullptr, *first_without = nullptr;
  for (const TheoryPlace& place : r.theory) {
    const std::optional<double>& error = place.rods[rod];
    if (!beyond_theory(error)) continue;
    ++count;
    if (!first) first = &place;
    if (error) largest = std::max(largest, *error);
    without += !error;
    if (!error && !first_without) first_without = &place;
  }
  if (count == 0) return "";
  std::string size = largest > 0 ? fmt::format("theory error up to {:.2g}", largest) : "";
  if (first_without)
    size += fmt::format("{}no value at {} of them, first at {}: {}", size.empty() ? "" : ", ", without,
                        where(document, *first_without), first_without->reason);
  return fmt::format("{}: beyond the linear theory at {} of {} points looked at ({}){}", r.rods[rod], count,
                     r.theory.size(), size, first == first_without ? "" : ", first at " + where(document, *first));
}

}  // namespace

Json theory_sample_json(const MapDocument& document) {
  const MapResult& r = document.result;
  Json sample = Json::array();
  for (const TheoryPlace& place : r.theory) {
    Json errors = Json::object();
    for (std::size_t k = 0; k < r.rods.size(); ++k) errors[r.rods[k]] = number(place.rods[k]);
    sample.push_back({{"x", r.x()[place.x]},
                      {"y", r.y()[place.y]},
                      {"theory_error", std::move(errors)},
                      {"growth_theory_error", number(place.growth)},
                      {"beyond", place.beyond()}});
  }
  return sample;
}

std::string map_theory_rows(const MapDocument& document) {
  const MapResult& r = document.result;
  if (!is_linkage(document)) return "";
  if (!r.theory_judged) return fmt::format("  {} (--only with steady)\n", not_judged);
  if (r.theory.empty()) return "";
  double largest = 0, growth = 0;
  std::string rod;
  for (const TheoryPlace& place : r.theory) {
    growth = std::max(growth, place.growth.value_or(0));
    for (std::size_t k = 0; k < r.rods.size(); ++k) {
      if (!place.rods[k] || *place.rods[k] < largest) continue;
      largest = *place.rods[k];
      rod = r.rods[k];
    }
  }
  const std::size_t beyond = count_beyond(r);
  return fmt::format(
      "  by the linear theory, whose error at {} points, corners included, is {}{}: {}\n", r.theory.size(),
      rod.empty() ? "without a value" : fmt::format("up to {:.2g} of q ({})", largest, rod),
      growth > 0 ? fmt::format(" and up to {:.2g} {} of the growth rate", growth, output_units(document.scene).rate)
                 : "",
      beyond == 0 ? "within it there" : fmt::format("beyond it at {} of them", beyond));
}

std::vector<std::string> map_theory_warnings(const MapDocument& document) {
  const MapResult& r = document.result;
  std::vector<std::string> sentences;
  if (!is_linkage(document)) return sentences;
  for (std::size_t k = 0; k < r.rods.size(); ++k) {
    std::string words = r.theory_judged ? beyond_words(document, k) : r.rods[k] + ": " + not_judged;
    if (!words.empty()) sentences.push_back(std::move(words));
  }
  const auto above = std::ranges::count_if(r.theory, [&](const TheoryPlace& place) {
    return place.growth && *place.growth >= std::abs(growth_at(r, place));
  });
  if (above > 0)
    sentences.push_back(fmt::format(
        "what the linear theory leaves out changes the growth rate by not less than the rate itself at {} of "
        "{} points looked at: there the verdict may be the other one (hb steady --theory nonlinear)",
        above, r.theory.size()));
  return sentences;
}

CsvFile map_theory_csv(const MapDocument& document) {
  const MapResult& r = document.result;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  CsvFile file;
  file.name = "map_theory.csv";
  file.comment = {fmt::format("{}: theory errors at some points of the map", scene_name(document.scene)),
                  "what the first nonlinear correction changes of q, of its largest; of the growth rate as it is; nan: "
                  "no value; beyond 1: above 0.05 or no value"};
  file.columns = {r.x_axis.path, r.y_axis.path};
  for (const std::string& rod : r.rods) file.columns.push_back("theory error " + rod);
  file.columns.push_back("theory error of growth" + bracketed(output_units(document.scene).rate));
  file.columns.push_back("beyond");
  file.rows.resize(static_cast<Eigen::Index>(r.theory.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t k = 0; k < r.theory.size(); ++k) {
    const TheoryPlace& place = r.theory[k];
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    Eigen::Index column = 0;
    row(column++) = r.x()[place.x];
    row(column++) = r.y()[place.y];
    for (const std::optional<double>& error : place.rods) row(column++) = error.value_or(none);
    row(column++) = place.growth.value_or(none);
    row(column) = place.beyond() ? 1 : 0;
  }
  return file;
}

std::string map_theory_caption(const MapDocument& document, const std::string& rods) {
  if (!is_linkage(document)) return "stability of the steady motion" + rods;
  const MapResult& r = document.result;
  std::string text = "stability by the linear theory" + rods;
  if (const std::size_t beyond = count_beyond(r); beyond > 0)
    text += fmt::format("; beyond it at {} of {} points looked at", beyond, r.theory.size());
  return text;
}

}  // namespace hb::tools
