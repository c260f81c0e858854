#include "tools/output/compare_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "tools/output/json.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// The number at a path of keys; empty where there is none.
std::optional<double> compared_number_at(const Json& json, std::initializer_list<const char*> keys) {
  const Json* at = &json;
  for (const char* key : keys) {
    if (!at->is_object() || !at->contains(key)) return std::nullopt;
    at = &at->at(key);
  }
  return at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

struct Entry {
  std::string of, name, unit;
  double value = 0;
  std::optional<double> error;
};

class Entries {
 public:
  explicit Entries(const Json& document) : document_(document), factors_(compared_factors(document)) {
    for (const auto& [name, rod] : document.at("rods").items()) add_rod(name, rod);
    add_machine();
    add("all rods", "growth rate", factors_.rate_unit, 1, compared_number_at(document_, {"system", "growth_rate"}),
        compared_number_at(document_, {"system", "exponent_error"}));
  }
  const std::vector<Entry>& list() const { return list_; }

 private:
  void add(const std::string& of, const std::string& name, const std::string& unit, double factor,
           std::optional<double> value, std::optional<double> error) {
    if (value)
      list_.push_back({of, name, unit, factor * *value, error ? std::optional(factor * *error) : std::nullopt});
  }
  // Error relative to the value itself.
  void add_relative(const std::string& of, const std::string& name, const std::string& unit, double factor,
                    std::optional<double> value, std::optional<double> relative) {
    add(of, name, unit, factor, value, value && relative ? std::optional(*relative * std::abs(*value)) : std::nullopt);
  }

  void add_rod(const std::string& name, const Json& rod) {
    const ComparedFactors& f = factors_;
    const bool is_rod = name != "system";
    const double bound = compared_number_at(rod, {"error_bound"}).value_or(0);
    if (rod.contains("q") && !rod["q"]["max_abs"].empty())
      add_relative(name, "largest |q_1|", f.length_unit, f.length, rod["q"]["max_abs"][0].get<double>(), bound);
    add(name, "deflection", f.length_unit, f.length, compared_number_at(rod, {"deflection", "max_abs"}),
        compared_number_at(rod, {"deflection", "error"}));
    add(name, "deflection at rest", f.length_unit, f.length, compared_number_at(rod, {"static_deflection", "max_abs"}),
        compared_number_at(rod, {"static_deflection", "error"}));
    add(name, "bending moment", "N m", f.moment, compared_number_at(rod, {"bending_moment", "max_abs"}),
        compared_number_at(rod, {"bending_moment", "error"}));
    add(name, "stress, axial", "MPa", f.stress, compared_number_at(rod, {"stress", "axial"}),
        compared_number_at(rod, {"stress", "axial_error"}));
    add(name, "stress, bending", "MPa", f.stress, compared_number_at(rod, {"stress", "bending"}),
        compared_number_at(rod, {"stress", "bending_error"}));
    for (const char* key : {"max_abs", "amplitude"})
      add(name, std::string("stress, ") + (key[0] == 'm' ? "together" : "amplitude"), "MPa", f.stress,
          compared_number_at(rod, {"stress", key}), compared_number_at(rod, {"stress", "error"}));
    for (const char* what : {"yield", "fatigue"})
      add(name, std::string("safety, ") + what, "", 1,
          compared_number_at(rod, {"stress", (std::string(what) + "_safety").c_str()}),
          compared_number_at(rod, {"stress", (std::string(what) + "_safety_error").c_str()}));
    add(name, "share of buckling load", "", 1, compared_number_at(rod, {"axial_force", "buckling_share"}),
        compared_number_at(rod, {"axial_force", "buckling_share_error"}));
    const std::optional<double> theory = compared_number_at(rod, {"theory_error"});
    constexpr double share_of_estimate = 0.1;  // what it may be off by itself
    add(name, "theory error", "", 1, theory, theory ? std::optional(share_of_estimate * *theory) : std::nullopt);
    add(name, "amplification", "", 1, compared_number_at(rod, {"amplification"}), std::nullopt);
    add(name, "omega_1", is_rod ? "Hz" : "rad" + f.rate_unit.substr(1), f.frequency,
        compared_number_at(rod, {"nearest_resonance", "frequency"}), std::nullopt);
    add(name, "growth rate", f.rate_unit, 1, compared_number_at(rod, {"growth_rate"}),
        compared_number_at(rod, {"exponent_error"}));
  }

  void add_machine() {
    const ComparedFactors& f = factors_;
    const auto number_at = [&](std::initializer_list<const char*> path) { return compared_number_at(document_, path); };
    if (document_.contains("bearings"))
      for (const auto& [name, bearing] : document_["bearings"].items())
        add("bearings", name, "N", f.force, compared_number_at(bearing, {"max"}),
            compared_number_at(bearing, {"error"}));
    add("frame", "shaking force", "N", f.force, number_at({"frame", "max"}), number_at({"frame", "force_error"}));
    const std::optional<double> error = number_at({"torque", "error"});
    add("drive", "torque, largest", "N m", f.moment, number_at({"torque", "max"}), error);
    add("drive", "torque, smallest", "N m", f.moment, number_at({"torque", "min"}), error);
    add("drive", "torque, rms", "N m", f.moment, number_at({"torque", "rms"}), error);
    add("drive", "power, mean", "W", f.power, number_at({"power", "mean"}), number_at({"power", "error"}));
    add("drive", "energy of the flywheel", "J", f.moment, number_at({"flywheel", "energy_fluctuation"}),
        number_at({"flywheel", "energy_fluctuation_error"}));
  }

  const Json& document_;
  ComparedFactors factors_;
  std::vector<Entry> list_;
};

std::string title_of(const ComparedSide& side) {
  const std::string title = side.document.value("title", "");
  const bool system = side.document.at("rods").contains("system");
  const double speed = side.document.at(system ? "omega" : "rpm");
  return fmt::format("{}, {}", title.empty() ? side.source : title,
                     system ? fmt::format("omega = {:.10g}", speed) : fmt::format("{:.10g} rpm", speed));
}

std::string side_line(const char* letter, const ComparedSide& side) {
  const std::string verdict = side_verdict(side);
  return fmt::format("{}  {} ({}){}{}\n", letter, title_of(side), side.source, verdict.empty() ? "" : ": ", verdict);
}

// c_0..c_H of q_1; empty where the document has none.
std::vector<std::complex<double>> first_unknown(const ComparedSide& side, const std::string& rod) {
  const Json& rods = side.document.at("rods");
  if (!rods.contains(rod) || !rods[rod].contains("q") || rods[rod]["q"]["fourier"].empty()) return {};
  std::vector<std::complex<double>> c;
  for (const Json& pair : rods[rod]["q"]["fourier"][0]) c.emplace_back(pair[0].get<double>(), pair[1].get<double>());
  return c;
}

double value_at(const std::vector<std::complex<double>>& c, double tau) {
  double value = c[0].real();
  for (std::size_t n = 1; n < c.size(); ++n) value += 2 * (c[n] * std::polar(1.0, static_cast<double>(n) * tau)).real();
  return value;
}

}  // namespace

ComparedFactors compared_factors(const Json& document) {
  static const std::map<std::string, double> metres = {{"m", 1},     {"mm", 1e-3}, {"cm", 1e-2},   {"dm", 0.1},
                                                       {"um", 1e-6}, {"km", 1e3},  {"in", 0.0254}, {"ft", 0.3048}};
  static const std::map<std::string, double> seconds = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}};
  const Json& units = document.at("units");
  const std::string time = units.at("time").get<std::string>();
  const double second = seconds.at(time);
  ComparedFactors factors;
  factors.rate_unit = "1/" + time;
  if (document.at("rods").contains("system")) return factors;
  const double metre = metres.at(units.at("length").get<std::string>());
  factors.length_unit = "mm";
  factors.length = metre * 1e3;
  factors.force = units.at("force_in_newton");
  factors.moment = units.at("torque_in_newton_metre");
  factors.stress = factors.force / (metre * metre) * 1e-6;
  factors.frequency = 1 / (2 * std::numbers::pi * second);
  factors.power = factors.moment / second;
  return factors;
}

namespace {

std::string compared_cell(const std::optional<double>& value, const std::optional<double>& error) {
  if (!value) return "";
  return fmt::format("{:.{}g}", *value, std::min(6, trusted_digits(*value, error.value_or(1e-6 * std::abs(*value)))));
}

Json compared_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

}  // namespace

std::optional<double> ComparedQuantity::change() const {
  if (!a || !b || *a == 0) return std::nullopt;
  return (*b - *a) / std::abs(*a);
}

bool ComparedQuantity::same() const { return a && b && std::abs(*b - *a) <= error_a.value_or(0) + error_b.value_or(0); }

std::vector<ComparedQuantity> compared_quantities(const ComparedSide& a, const ComparedSide& b) {
  std::vector<ComparedQuantity> quantities;
  const Entries of_a(a.document), of_b(b.document);
  for (const Entry& entry : of_a.list())
    quantities.push_back({entry.of, entry.name, entry.unit, entry.value, std::nullopt, entry.error, std::nullopt});
  for (const Entry& entry : of_b.list()) {
    const auto known = std::ranges::find_if(
        quantities, [&](const ComparedQuantity& q) { return q.of == entry.of && q.name == entry.name; });
    ComparedQuantity& quantity =
        known != quantities.end()
            ? *known
            : quantities.emplace_back(ComparedQuantity{entry.of, entry.name, entry.unit, {}, {}, {}, {}});
    quantity.b = entry.value;
    quantity.error_b = entry.error;
  }
  // What belongs together stands together, in the order of A.
  std::vector<std::string> order;
  for (const ComparedQuantity& q : quantities)
    if (std::ranges::find(order, q.of) == order.end()) order.push_back(q.of);
  std::ranges::stable_sort(quantities, {},
                           [&](const ComparedQuantity& q) { return std::ranges::find(order, q.of) - order.begin(); });
  return quantities;
}

std::string side_verdict(const ComparedSide& side) {
  const std::string verdict = side.document.value("verdict", "");
  if (verdict.empty()) return "";
  std::string because;
  for (const auto& [name, rod] : side.document.at("rods").items())
    if (name != "system" && rod.value("verdict", "") == verdict) because += (because.empty() ? "" : ", ") + name;
  const bool good = verdict == "stable" || verdict == "bounded";
  return (verdict == "unstable" ? "UNSTABLE" : verdict) + (good || because.empty() ? "" : " because of " + because);
}

std::string compare_table(const ComparedSide& a, const ComparedSide& b) {
  std::string text = side_line("A", a) + side_line("B", b);
  text += fmt::format("\n{:<34}{:>16}{:>16}{:>12}\n", "", "A", "B", "B against A");
  std::string of;
  for (const ComparedQuantity& q : compared_quantities(a, b)) {
    if (q.of != of) text += q.of + "\n";
    of = q.of;
    text += compared_row(q) + "\n";
  }
  text += "\nsame: no further apart than the errors of both computations\n";
  if (a.document.at("omega") != b.document.at("omega")) text += "WARNING: the two are at different speeds\n";
  return text + compared_warnings(a, b);
}

std::string compared_warnings(const ComparedSide& a, const ComparedSide& b) {
  const auto of = [](const ComparedSide& side) { return side.document.value("warnings", std::vector<std::string>()); };
  const std::vector<std::string> of_a = of(a), of_b = of(b);
  const auto has = [](const std::vector<std::string>& list, const std::string& sentence) {
    return std::ranges::find(list, sentence) != list.end();
  };
  std::string text;
  for (const std::string& sentence : of_a)
    text += fmt::format("WARNING: {}: {}\n", has(of_b, sentence) ? "A and B" : "A", sentence);
  for (const std::string& sentence : of_b)
    if (!has(of_a, sentence)) text += fmt::format("WARNING: B: {}\n", sentence);
  return text;
}

Json compared_json(const ComparedQuantity& q) {
  return {{"of", q.of},
          {"name", q.name},
          {"unit", q.unit},
          {"a", compared_number(q.a)},
          {"b", compared_number(q.b)},
          {"error_a", compared_number(q.error_a)},
          {"error_b", compared_number(q.error_b)},
          {"change", compared_number(q.change())},
          {"same", q.same()}};
}

std::string compared_row(const ComparedQuantity& q) {
  const std::optional<double> change = q.change();
  return fmt::format("  {:<32}{:>16}{:>16}{:>12}", q.name + (q.unit.empty() ? "" : " [" + q.unit + "]"),
                     compared_cell(q.a, q.error_a), compared_cell(q.b, q.error_b),
                     q.same() ? "same"
                     : change ? fmt::format("{:+.3g} %", 100 * *change)
                              : "");
}

Json compare_json(const ComparedSide& a, const ComparedSide& b) {
  Json json;
  for (const auto& [key, side] : {std::pair("a", &a), std::pair("b", &b)}) {
    Json entry = {{"source", side->source}};
    for (const char* copied : {"title", "rpm", "omega", "verdict", "warnings", "notes"})
      if (side->document.contains(copied)) entry[copied] = side->document[copied];
    json[key] = std::move(entry);
  }
  Json list = Json::array();
  for (const ComparedQuantity& q : compared_quantities(a, b)) list.push_back(compared_json(q));
  json["quantities"] = std::move(list);
  return json;
}

std::vector<CsvFile> compare_csvs(const ComparedSide& a, const ComparedSide& b) {
  std::vector<CsvFile> files;
  const double factor_a = compared_factors(a.document).length, factor_b = compared_factors(b.document).length;
  const std::string unit = compared_factors(a.document).length_unit;
  for (const auto& [name, rod] : a.document.at("rods").items()) {
    const auto first = first_unknown(a, name), second = first_unknown(b, name);
    if (first.empty() || second.empty()) continue;
    constexpr Eigen::Index N = 720;
    CsvFile file;
    file.name = file_name("compare_" + name) + ".csv";
    file.comment = {fmt::format("{}: q_1 over one turn; A: {}; B: {}", name, title_of(a), title_of(b))};
    file.columns = {"crank angle [deg]", "q_1 A" + (unit.empty() ? "" : " [" + unit + "]"),
                    "q_1 B" + (unit.empty() ? "" : " [" + unit + "]")};
    file.rows.resize(N + 1, 3);
    for (Eigen::Index j = 0; j <= N; ++j) {
      const double tau = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N);
      file.rows.row(j) << 360 * static_cast<double>(j) / static_cast<double>(N), factor_a * value_at(first, tau),
          factor_b * value_at(second, tau);
    }
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace hb::tools
