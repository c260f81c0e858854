#include "tools/output/compare_along.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hb/analysis/theory_error.hpp"
#include "lib/constants.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/work/errors.hpp"

namespace hb::tools {
namespace {

using Path = std::vector<std::string>;

const Json* json_at(const Json& json, const Path& path) {
  const Json* at = &json;
  for (const std::string& key : path) {
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &at->at(key);
  }
  return at;
}

double value_or_nan(const Json* array, std::size_t k) {
  return array && array->is_array() && k < array->size() && (*array)[k].is_number() ? (*array)[k].get<double>() : nan;
}

std::vector<double> places(const Json& document) { return document.at("x").at("values").get<std::vector<double>>(); }

// Points asked for and, of rods, those between.
struct Points {
  std::vector<double> x;
  std::vector<bool> trusted;  // stable, and within the linear theory as far as that is known
};

// `rods`: of the document, or of what was computed between.
Points points_of(const std::vector<double>& x, const Json& rods) {
  Points points{x, std::vector<bool>(x.size(), true)};
  for (const auto& [name, rod] : rods.items())
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Json *verdict = json_at(rod, {"verdict"}), *theory = json_at(rod, {"theory_error"});
      if (verdict && (*verdict)[k] == "unstable") points.trusted[k] = false;
      if (theory && !(value_or_nan(theory, k) <= theory_error_limit)) points.trusted[k] = false;
    }
  return points;
}

struct Range2 {
  double from = 0, to = 0;
};

Range2 common_range(const ComparedSide& a, const ComparedSide& b) {
  const std::vector<double> of_a = places(a.document), of_b = places(b.document);
  return {std::max(of_a.front(), of_b.front()), std::min(of_a.back(), of_b.back())};
}

struct Found {
  double value = nan, x = nan, error = nan;
};

// One quantity of one side.
struct Wanted {
  std::string of, name, unit;
  double factor = 1;
  Path values, errors;  // below a rod, or in the document
  bool relative = false;  // the errors are
  bool smallest = false, anywhere = false;  // not only where trusted
};

class AlongSide {
 public:
  AlongSide(const ComparedSide& side, Range2 range) : document_(side.document), range_(range) {
    asked_ = points_of(places(document_), document_.at("rods"));
    if (document_.contains("refined"))
      between_ = points_of(document_["refined"].at("x").get<std::vector<double>>(), document_["refined"].at("rods"));
    const auto inside = [&](const Points& points) {
      for (std::size_t k = 0; k < points.x.size(); ++k)
        if (points.trusted[k] && in_range(points.x[k])) return true;
      return false;
    };
    some_trusted_ = inside(asked_) || inside(between_);
  }

  // `rod`: empty: of the machine.
  Found find(const Wanted& wanted, const std::string& rod) const {
    Found found;
    const Path base = rod.empty() ? Path() : Path{"rods", rod};
    look(document_, asked_, base, wanted, found);
    if (!rod.empty() && document_.contains("refined")) look(document_["refined"], between_, base, wanted, found);
    return found;
  }
  bool some_trusted() const { return some_trusted_; }

 private:
  bool in_range(double x) const { return x >= range_.from && x <= range_.to; }

  void look(const Json& json, const Points& points, Path base, const Wanted& wanted, Found& found) const {
    Path error_path = base;
    base.insert(base.end(), wanted.values.begin(), wanted.values.end());
    error_path.insert(error_path.end(), wanted.errors.begin(), wanted.errors.end());
    const Json *values = json_at(json, base), *errors = wanted.errors.empty() ? nullptr : json_at(json, error_path);
    for (std::size_t k = 0; k < points.x.size(); ++k) {
      if (!in_range(points.x[k]) || !(wanted.anywhere || points.trusted[k] || !some_trusted_)) continue;
      const double value = value_or_nan(values, k);
      if (std::isnan(value) || (wanted.smallest ? value >= found.value : value <= found.value)) continue;
      const double error = value_or_nan(errors, k);
      found = {value, points.x[k], wanted.relative ? error * std::abs(value) : error};
    }
  }

  const Json& document_;
  Range2 range_;
  Points asked_, between_;
  bool some_trusted_ = false;
};

std::vector<Wanted> of_rod(const std::string& name, const ComparedFactors& f) {
  return {
      {name, "largest |q_1|", f.length_unit, f.length, {"first"}, {"error_bound"}, true},
      {name, "deflection", f.length_unit, f.length, {"deflection"}, {"deflection_error"}},
      {name, "bending moment", "N m", f.moment, {"bending_moment"}, {"bending_moment_error"}},
      {name, "stress, together", "MPa", f.stress, {"stress", "max_abs"}, {"stress", "error"}},
      {name, "stress, amplitude", "MPa", f.stress, {"stress", "amplitude"}, {"stress", "error"}},
      {name, "safety, yield", "", 1, {"stress", "yield_safety"}, {"stress", "yield_safety_error"}, false, true, true},
      {name,
       "safety, fatigue",
       "",
       1,
       {"stress", "fatigue_safety"},
       {"stress", "fatigue_safety_error"},
       false,
       true,
       true},
      {name, "share of buckling load", "", 1, {"buckling_share"}, {"buckling_share_error"}, false, false, true},
      {name, "theory error", "", 1, {"theory_error"}, {}, false, false, true},
      {name, "growth rate", f.rate_unit, 1, {"growth_rate"}, {"growth_error"}, false, false, true}};
}

std::vector<Wanted> of_machine(const Json& a, const ComparedFactors& f) {
  std::vector<Wanted> list;
  if (const Json* bearings = json_at(a, {"bearings"}))
    for (const auto& [name, bearing] : bearings->items())
      list.push_back({"bearings", name, "N", f.force, {"bearings", name, "max"}, {"bearings", name, "error"}});
  list.push_back({"frame", "shaking force", "N", f.force, {"frame", "max"}, {"frame", "force_error"}});
  list.push_back({"drive", "torque, largest", "N m", f.moment, {"torque", "max"}, {"torque", "error"}});
  list.push_back({"drive", "torque, rms", "N m", f.moment, {"torque", "rms"}, {"torque", "error"}});
  list.push_back({"drive", "power, largest", "W", f.power, {"power", "max"}, {"power", "error"}});
  list.push_back({"drive",
                  "energy of the flywheel",
                  "J",
                  f.moment,
                  {"flywheel", "energy_fluctuation"},
                  {"flywheel", "energy_fluctuation_error"}});
  return list;
}

std::vector<std::string> common_rods(const ComparedSide& a, const ComparedSide& b) {
  std::vector<std::string> names;
  for (const auto& [name, rod] : a.document.at("rods").items())
    if (b.document.at("rods").contains(name)) names.push_back(name);
  return names;
}

std::string unit_along(const ComparedSide& side) {
  const std::string path = side.document.at("x").at("path");
  return path == "rpm"     ? " rpm"
         : path == "omega" ? " rad/" + side.document.at("units").at("time").get<std::string>()
                           : "";
}

// "7503.3 to 7948 rpm, ..."; "none".
std::string bands_text(const ComparedSide& side, const std::string& rod, Range2 range) {
  const Json* bands = json_at(side.document, {"unstable_bands", rod});
  if (!bands) return "not looked for";
  std::string text;
  for (const Json& band : *bands) {
    const double from = band[0], to = band[1];
    if (to < range.from || from > range.to) continue;
    text += fmt::format("{}{:.6g} to {:.6g}", text.empty() ? "" : ", ", from, to);
  }
  return text.empty() ? "none" : text + unit_along(side);
}

std::string peaks_text(const ComparedSide& side, const std::string& rod, Range2 range) {
  std::string text;
  if (!side.document.contains("critical")) return "not looked for";
  for (const Json& peak : side.document["critical"]) {
    const double x = peak.at("x");
    if (peak.at("rod") != rod || x < range.from || x > range.to) continue;
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", x);
  }
  return text.empty() ? "none" : text + unit_along(side);
}

std::string along_line(const char* letter, const ComparedSide& side) {
  const std::vector<double> x = places(side.document);
  const std::string title = side.document.value("title", ""), verdict = along_verdict(side);
  return fmt::format("{}  {}, {} = {:.8g} to {:.8g}, {} points ({}){}{}\n", letter, title.empty() ? side.source : title,
                     side.document.at("x").at("path").get<std::string>(), x.front(), x.back(), x.size(), side.source,
                     verdict.empty() ? "" : ": ", verdict);
}

// Columns by function of the point; points asked for and between, ascending.
CsvFile curves_csv(const ComparedSide& side, const std::string& name, const std::vector<std::string>& labels,
                   const std::vector<std::function<double(const Json& part, std::size_t k)>>& columns,
                   bool with_refined) {
  std::vector<std::vector<double>> rows;
  const auto add = [&](const Json& part, const std::vector<double>& x) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      std::vector<double> row = {x[k]};
      for (const auto& column : columns) row.push_back(column(part, k));
      rows.push_back(std::move(row));
    }
  };
  add(side.document, places(side.document));
  if (with_refined && side.document.contains("refined"))
    add(side.document["refined"], side.document["refined"].at("x").get<std::vector<double>>());
  std::ranges::sort(rows, {}, [](const std::vector<double>& row) { return row[0]; });
  CsvFile file;
  file.name = name;
  file.comment = {fmt::format("{} ({})", side.document.value("title", ""), side.source)};
  file.columns = {along_label(side)};
  file.columns.insert(file.columns.end(), labels.begin(), labels.end());
  file.rows.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t c = 0; c < rows[k].size(); ++c)
      file.rows(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) = rows[k][c];
  return file;
}

}  // namespace

bool is_along(const ComparedSide& side) { return side.document.contains("x"); }

void require_comparable(const ComparedSide& a, const ComparedSide& b) {
  const std::string path = a.document.at("x").at("path"), other = b.document.at("x").at("path");
  if (path != other)
    throw UsageError(
        fmt::format("compare: found A along {} and B along {}, allowed: both along one number", path, other));
  const Range2 range = common_range(a, b);
  if (!(range.from <= range.to)) {
    const std::vector<double> of_a = places(a.document), of_b = places(b.document);
    throw UsageError(
        fmt::format("compare: found A from {:g} to {:g} and B from {:g} to {:g}, allowed: ranges that have "
                    "a part in common",
                    of_a.front(), of_a.back(), of_b.front(), of_b.back()));
  }
}

std::vector<ComparedAlong> compared_along(const ComparedSide& a, const ComparedSide& b) {
  const Range2 range = common_range(a, b);
  // q_1 has a name of its own beside the list of all.
  const auto with_first = [](ComparedSide side) {
    const auto add = [](Json& rods) {
      for (auto& [name, rod] : rods.items()) {
        if (!rod.contains("max_abs")) continue;
        Json first = Json::array();
        for (const Json& values : rod["max_abs"])
          first.push_back(values.is_array() && !values.empty() ? values[0] : Json(nullptr));
        rod["first"] = std::move(first);
      }
    };
    add(side.document["rods"]);
    if (side.document.contains("refined")) add(side.document["refined"]["rods"]);
    return side;
  };
  const ComparedSide full_a = with_first(a), full_b = with_first(b);
  const AlongSide side_a(full_a, range), side_b(full_b, range);
  const ComparedFactors f_a = compared_factors(a.document), f_b = compared_factors(b.document);
  std::vector<ComparedAlong> list;
  const auto add = [&](const Wanted& of_a, const Wanted& of_b, const std::string& rod) {
    const Found here = side_a.find(of_a, rod), there = side_b.find(of_b, rod);
    if (std::isnan(here.value) && std::isnan(there.value)) return;
    const auto number = [](double value, double factor) {
      return std::isnan(value) ? std::nullopt : std::optional(factor * value);
    };
    list.push_back({{of_a.of, of_a.name, of_a.unit, number(here.value, of_a.factor), number(there.value, of_b.factor),
                     number(here.error, of_a.factor), number(there.error, of_b.factor)},
                    number(here.x, 1),
                    number(there.x, 1)});
  };
  for (const std::string& rod : common_rods(a, b)) {
    const std::vector<Wanted> of_a = of_rod(rod, f_a), of_b = of_rod(rod, f_b);
    for (std::size_t k = 0; k < of_a.size(); ++k) add(of_a[k], of_b[k], rod);
  }
  const std::vector<Wanted> of_a = of_machine(a.document, f_a), of_b = of_machine(a.document, f_b);
  for (std::size_t k = 0; k < of_a.size(); ++k) add(of_a[k], of_b[k], "");
  return list;
}

std::string along_verdict(const ComparedSide& side) {
  const Json* verdicts = json_at(side.document, {"verdict"});
  if (!verdicts || !verdicts->is_array()) return "";
  std::size_t unstable = 0, undecided = 0, bounded = 0, known = 0;
  for (const Json& verdict : *verdicts) {
    known += !verdict.is_null();
    unstable += verdict == "unstable";
    undecided += verdict == "undecided";
    bounded += verdict == "bounded";
  }
  const std::size_t worst = unstable > 0 ? unstable : undecided > 0 ? undecided : bounded;
  const char* word = unstable > 0 ? "UNSTABLE" : undecided > 0 ? "undecided" : bounded > 0 ? "bounded" : "stable";
  if (known == 0) return "";
  if (worst == 0) return fmt::format("{} at all points", word);
  std::string because;
  for (const auto& [name, rod] : side.document.at("rods").items()) {
    const Json* own = json_at(rod, {"verdict"});
    const bool part = own && unstable > 0 && std::ranges::find(*own, Json("unstable")) != own->end();
    if (part && name != "system") because += (because.empty() ? " because of " : ", ") + name;
  }
  return fmt::format("{} at {} of {} points{}", word, worst, known, because);
}

std::string along_label(const ComparedSide& side) {
  const std::string path = side.document.at("x").at("path");
  const std::string unit = unit_along(side);
  return path == "rpm" || path == "omega" ? fmt::format("speed [{}]", unit.substr(1)) : path;
}

std::string compare_along_table(const ComparedSide& a, const ComparedSide& b) {
  const Range2 range = common_range(a, b);
  std::string text = along_line("A", a) + along_line("B", b);
  text += fmt::format(
      "compared from {:.8g} to {:.8g}{}: largest of each, where stable and within the linear theory if "
      "that is anywhere;\nsmallest safeties, buckling load, theory error and growth rate of all points\n",
      range.from, range.to, unit_along(a));
  text += fmt::format("\n{:<34}{:>16}{:>16}{:>12}{:>12}{:>12}\n", "", "A", "B", "B against A", "A at", "B at");
  std::string of;
  const auto at = [](const std::optional<double>& x) { return x ? fmt::format("{:.6g}", *x) : std::string(); };
  const auto rod_end = [&](const std::string& rod) {
    if (!a.document.at("rods").contains(rod)) return std::string();
    return fmt::format("  unstable bands: A {}; B {}\n  resonance peaks: A {}; B {}\n", bands_text(a, rod, range),
                       bands_text(b, rod, range), peaks_text(a, rod, range), peaks_text(b, rod, range));
  };
  for (const ComparedAlong& each : compared_along(a, b)) {
    const ComparedQuantity& q = each.quantity;
    if (q.of != of) text += rod_end(of) + q.of + "\n";
    of = q.of;
    text += fmt::format("{}{:>12}{:>12}\n", compared_row(q), at(each.at_a), at(each.at_b));
  }
  return text + rod_end(of) + "\nsame: no further apart than the errors of both computations\n" +
         compared_warnings(a, b);
}

Json compare_along_json(const ComparedSide& a, const ComparedSide& b) {
  const Range2 range = common_range(a, b);
  Json json;
  for (const auto& [key, side] : {std::pair("a", &a), std::pair("b", &b)}) {
    Json entry = {{"source", side->source}, {"verdict", along_verdict(*side)}};
    for (const char* copied : {"title", "x", "warnings", "notes", "unstable_bands", "critical_x"})
      if (side->document.contains(copied)) entry[copied] = side->document[copied];
    json[key] = std::move(entry);
  }
  json["along"] = {{"path", a.document.at("x").at("path")}, {"from", range.from}, {"to", range.to}};
  Json list = Json::array();
  for (const ComparedAlong& each : compared_along(a, b)) {
    Json entry = compared_json(each.quantity);
    entry["at_a"] = each.at_a ? Json(*each.at_a) : Json(nullptr);
    entry["at_b"] = each.at_b ? Json(*each.at_b) : Json(nullptr);
    list.push_back(std::move(entry));
  }
  json["quantities"] = std::move(list);
  return json;
}

std::vector<AlongCurves> along_curves(const ComparedSide& a, const ComparedSide& b) {
  std::vector<AlongCurves> list;
  for (const std::string& rod : common_rods(a, b)) {
    AlongCurves curves{rod, {}, {}, {}};
    std::vector<std::pair<Path, double ComparedFactors::*>> wanted;
    const auto both = [&](const Path& path) {
      return json_at(a.document.at("rods").at(rod), path) && json_at(b.document.at("rods").at(rod), path);
    };
    const ComparedFactors f = compared_factors(a.document);
    const auto add = [&](const Path& path, const std::string& label, double ComparedFactors::*factor) {
      if (!both(path)) return;
      wanted.push_back({path, factor});
      curves.labels.push_back(label);
    };
    add({"deflection"}, "deflection [mm]", &ComparedFactors::length);
    add({"stress", "max_abs"}, "stress [MPa]", &ComparedFactors::stress);
    add({"growth_rate"}, "growth rate [" + f.rate_unit + "]", nullptr);
    if (wanted.empty()) continue;
    const auto csv = [&](const ComparedSide& side, const char* letter) {
      const ComparedFactors own = compared_factors(side.document);
      std::vector<std::function<double(const Json&, std::size_t)>> columns;
      for (const auto& [path, factor] : wanted)
        columns.push_back([&rod, path, factor = factor ? own.*factor : 1.0](const Json& part, std::size_t k) {
          return factor * value_or_nan(json_at(part.at("rods").at(rod), path), k);
        });
      return curves_csv(side, file_name(fmt::format("compare_sweep_{}_{}", rod, letter)) + ".csv", curves.labels,
                        columns, true);
    };
    curves.a = csv(a, "a");
    curves.b = csv(b, "b");
    list.push_back(std::move(curves));
  }
  if (!a.document.contains("frame") || !b.document.contains("frame")) return list;
  AlongCurves machine{"machine", {"bearing force [N]", "shaking force [N]", "rms torque [N m]"}, {}, {}};
  const auto csv = [&](const ComparedSide& side, const char* letter) {
    const ComparedFactors f = compared_factors(side.document);
    const auto bearing = [f](const Json& part, std::size_t k) {
      double most = nan;
      for (const auto& [name, each] : part.at("bearings").items())
        most = std::fmax(most, value_or_nan(json_at(each, {"max"}), k));
      return f.force * most;
    };
    return curves_csv(side, fmt::format("compare_sweep_machine_{}.csv", letter), machine.labels,
                      {bearing,
                       [f](const Json& part, std::size_t k) {
                         return f.force * value_or_nan(json_at(part, {"frame", "max"}), k);
                       },
                       [f](const Json& part, std::size_t k) {
                         return f.moment * value_or_nan(json_at(part, {"torque", "rms"}), k);
                       }},
                      false);
  };
  machine.a = csv(a, "a");
  machine.b = csv(b, "b");
  list.push_back(std::move(machine));
  return list;
}

}  // namespace hb::tools
