#include "tools/output/branches_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "hb/analysis/rod_stress.hpp"
#include "lib/constants.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_machine.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/text.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

double rpm_at(const SweepScene& scene, double x, double speed) {
  return scene.axis().kind == Axis::Kind::rpm ? x : rpm_from_speed(speed, scene.scene().units);
}

// What a fold is called by: its speed in rpm, or the number of the axis.
double place_of(const SweepScene& scene, double x, double speed) {
  return is_speed(scene) ? rpm_at(scene, x, speed) : x;
}

const char* kind_text(BifurcationKind kind) {
  switch (kind) {
    case BifurcationKind::fold:
    case BifurcationKind::branch_point:
      return "+1";
    case BifurcationKind::period_doubling:
      return "-1";
    case BifurcationKind::neimark_sacker:
      return "complex";
  }
  return "";
}

template <class Value>
Json over(const std::vector<NonlinearPoint>& points, const Value& value) {
  Json array = Json::array();
  for (const NonlinearPoint& point : points) array.push_back(value(point));
  return array;
}

// Axial and bending stress together, of links with a section; null between the values asked for.
void add_cycles(Json& stress, const std::vector<NonlinearPoint>& points, std::size_t r) {
  const auto known = [&](const std::function<bool(const StressCycle&)>& has) {
    return std::ranges::any_of(points, [&](const NonlinearPoint& p) {
      return !p.loads.empty() && p.loads[r].cycle && has(*p.loads[r].cycle);
    });
  };
  if (!known([](const StressCycle&) { return true; })) return;
  const auto each = [&](const std::function<double(const StressCycle&)>& value) {
    return over(points, [&](const NonlinearPoint& p) {
      return p.loads.empty() || !p.loads[r].cycle ? Json(nullptr) : number(value(*p.loads[r].cycle));
    });
  };
  stress["max_abs"] = each([](const StressCycle& c) { return c.max_abs; });
  stress["mean"] = each([](const StressCycle& c) { return c.mean; });
  stress["amplitude"] = each([](const StressCycle& c) { return c.amplitude; });
  stress["error"] = each([](const StressCycle& c) { return c.error; });
  if (known([](const StressCycle& c) { return c.yield.has_value(); })) {
    stress["yield_safety"] = each([](const StressCycle& c) { return c.yield->value; });
    stress["yield_safety_error"] = each([](const StressCycle& c) { return c.yield->error; });
  }
  if (known([](const StressCycle& c) { return c.fatigue.has_value(); })) {
    stress["fatigue_safety"] = each([](const StressCycle& c) { return c.fatigue->factor.value; });
    stress["fatigue_safety_error"] = each([](const StressCycle& c) { return c.fatigue->factor.error; });
  }
}

// Deflection and stress at the values asked for; null between them.
void add_bent_loads(Json& rod, const std::vector<NonlinearPoint>& points, std::size_t r) {
  if (std::ranges::none_of(points, [](const NonlinearPoint& p) { return !p.loads.empty(); })) return;
  const auto each = [&](const std::function<Json(const NonlinearPoint&)>& value) {
    return over(points, [&](const NonlinearPoint& p) { return p.loads.empty() ? Json(nullptr) : value(p); });
  };
  rod["deflection"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].deflection); });
  rod["bending_moment"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].bending_moment); });
  const auto peak_error = [&](double PeakErrors::*error) {
    return each([r, error](const NonlinearPoint& p) {
      const std::optional<PeakErrors>& errors = p.loads[r].errors;
      return errors ? number((*errors).*error) : Json(nullptr);
    });
  };
  rod["deflection_error"] = peak_error(&PeakErrors::deflection);
  rod["bending_moment_error"] = peak_error(&PeakErrors::bending_moment);
  rod["buckling_share"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.buckling_share()); });
  rod["buckling_share_error"] =
      each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.buckling_share_error()); });
  Json stress;
  stress["axial"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.axial); });
  stress["axial_error"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.axial_error); });
  stress["bending"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.bending); });
  stress["bending_error"] = each([r](const NonlinearPoint& p) { return number(p.loads[r].stress.bending_error); });
  add_cycles(stress, points, r);
  rod["stress"] = std::move(stress);
}

// "largest stress where stable: AB 12.3 MPa axial and 45.6 MPa of bending at rpm = 900"
std::string bent_stress_rows(const SweepScene& scene, const NonlinearSweep& sweep, const NonlinearBranch& branch) {
  const OutputUnits units = output_units(scene.scene());
  std::string text;
  for (std::size_t r = 0; r < sweep.rods.size(); ++r) {
    if (!sweep.reported[r]) continue;
    const NonlinearPoint* most = nullptr;
    const auto sum = [r](const NonlinearPoint& p) {
      const BentLoads& loads = p.loads[r];
      return loads.cycle ? loads.cycle->max_abs : loads.stress.axial + loads.stress.bending;
    };
    bool all = true;
    for (const NonlinearPoint& point : branch.points) {
      if (point.loads.empty()) continue;
      const bool stable = !point.stability || point.stability->verdict != Verdict::unstable;
      all = all && stable;
      if (stable && (!most || sum(point) > sum(*most))) most = &point;
    }
    if (!most) continue;
    const RodStress& stress = most->loads[r].stress;
    const std::optional<StressCycle>& cycle = most->loads[r].cycle;
    const std::string where =
        fmt::format("at {} = {:.8g}{}", scene.axis().path, most->x, all ? "" : ", where not unstable");
    if (!cycle) {
      text += fmt::format("  {}: stress at most {:.4g} MPa axial and {:.4g} MPa of bending (as a rectangle) {}\n",
                          sweep.rods[r], units.megapascal * stress.axial, units.megapascal * stress.bending, where);
      continue;
    }
    text += fmt::format(
        "  {}: stress at most {:.4g} MPa, amplitude {:.4g} MPa about {:.4g} MPa{}{} {}\n", sweep.rods[r],
        units.megapascal * cycle->max_abs, units.megapascal * cycle->amplitude, units.megapascal * cycle->mean,
        cycle->yield ? fmt::format(", safety against yielding {:.4g}", cycle->yield->value) : "",
        cycle->fatigue ? fmt::format(", against fatigue {:.4g}", cycle->fatigue->factor.value) : "", where);
  }
  return text;
}

Json branch_json(const SweepScene& scene, const NonlinearSweep& sweep, const NonlinearBranch& branch) {
  const std::vector<NonlinearPoint>& points = branch.points;
  Json json;
  json["period"] = branch.turns;
  json["x"] = over(points, [](const NonlinearPoint& p) { return Json(p.x); });
  json["rpm"] = over(points, [&](const NonlinearPoint& p) {
    return Json(is_speed(scene) ? rpm_at(scene, p.x, p.speed) : scene.fixed_rpm());
  });
  json["omega"] = over(points, [](const NonlinearPoint& p) { return Json(p.speed); });
  json["asked"] = over(points, [](const NonlinearPoint& p) { return Json(p.asked); });
  for (std::size_t r = 0; r < sweep.rods.size(); ++r) {
    if (!sweep.reported[r]) continue;
    Json rod;
    rod["max_abs"] = over(points, [&](const NonlinearPoint& p) { return Json(p.max_abs[r]); });
    add_bent_loads(rod, points, r);
    json["rods"][sweep.rods[r]] = std::move(rod);
  }
  if (std::ranges::any_of(points, [](const NonlinearPoint& p) { return p.machine.has_value(); })) {
    std::vector<const MachinePoint*> machine;
    for (const NonlinearPoint& p : points) machine.push_back(p.machine ? &*p.machine : nullptr);
    add_machine(json, sweep.joints, machine);
  }
  json["error_bound"] = over(points, [](const NonlinearPoint& p) { return number(p.error_bound); });
  json["growth_rate"] =
      over(points, [](const NonlinearPoint& p) { return p.stability ? number(p.stability->growth_rate) : Json(); });
  json["growth_error"] =
      over(points, [](const NonlinearPoint& p) { return p.stability ? number(p.stability->growth_error) : Json(); });
  json["verdict"] = over(
      points, [](const NonlinearPoint& p) { return p.stability ? Json(to_string(p.stability->verdict)) : Json(); });
  json["end"] = to_string(branch.end);
  if (!branch.why.empty()) json["why"] = branch.why;
  return json;
}

Json event_json(const SweepScene& scene, const NonlinearEvent& event) {
  Json json;
  if (is_speed(scene)) json["rpm"] = rpm_at(scene, event.x, event.speed);
  json["x"] = event.x;
  json["omega"] = event.speed;
  json["kind"] = kind_text(event.kind);
  json["name"] = to_string(event.kind);
  json["error"] = number(event.error);
  json["period"] = event.turns;
  json["branch"] = event.branch;
  return json;
}

Json peaks_json(const NonlinearSweep& sweep, const RodPeaks& peaks) {
  Json rods = Json::object();
  for (std::size_t r = 0; r < sweep.rods.size(); ++r)
    if (sweep.reported[r]) rods[sweep.rods[r]] = {{"max_abs", peaks[r]}};
  return rods;
}

Json jump_json(const SweepScene& scene, const NonlinearSweep& sweep, const Jump& jump) {
  Json json;
  if (is_speed(scene)) json["rpm"] = rpm_at(scene, jump.x, jump.speed);
  json["x"] = jump.x;
  json["omega"] = jump.speed;
  json["direction"] = jump.upward ? "upward" : "downward";
  json["error"] = number(jump.error);
  json["from"] = peaks_json(sweep, jump.from);
  json["to"] = Json::array();
  for (const RodPeaks& peaks : jump.to) json["to"].push_back(peaks_json(sweep, peaks));
  return json;
}

// The motion followed from the first value, at each value of the axis: where its branch passes first.
void add_followed(Json& json, const SweepScene& scene, const NonlinearSweep& sweep) {
  const bool stability = scene.settings().only.stability;
  if (json.contains("verdict")) {
    Json linear = std::move(json["verdict"]);
    json.erase("verdict");
    json["linear_verdict"] = std::move(linear);
  }
  Json system = Json::object();
  for (const auto& place : sweep.followed) {
    const NonlinearPoint* point = place ? &sweep.branches[place->branch].points[place->point] : nullptr;
    system["branch"].push_back(place ? Json(place->branch) : Json());
    system["point"].push_back(place ? Json(place->point) : Json());
    system["error_bound"].push_back(point ? number(point->error_bound) : Json());
    if (!stability) continue;
    const bool known = point && point->stability;
    system["growth_rate"].push_back(known ? number(point->stability->growth_rate) : Json());
    system["growth_error"].push_back(known ? number(point->stability->growth_error) : Json());
    system["verdict"].push_back(known ? Json(to_string(point->stability->verdict)) : Json());
  }
  if (stability) {
    Json verdict = system["verdict"];
    json["verdict"] = std::move(verdict);
  }
  json["system"] = std::move(system);
}

std::string peaks_text(const NonlinearSweep& sweep, const RodPeaks& peaks, const OutputUnits& units) {
  std::string text;
  for (std::size_t r = 0; r < sweep.rods.size(); ++r)
    if (sweep.reported[r])
      text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", sweep.rods[r], peaks[r].front());
  return text + " " + units.length;
}

}  // namespace

void add_branches(Json& json, const SweepScene& scene, const NonlinearSweep& sweep) {
  json["theory"] = "nonlinear";
  json["motion_tolerance"] = sweep.tolerance;
  if (!sweep.shortfalls.empty()) {
    json["status"] = "tolerance not reached";
    for (const std::string& sentence : sweep.shortfalls) json["notes"].push_back(sentence);
  }
  Json branches = Json::array();
  for (const NonlinearBranch& branch : sweep.branches) branches.push_back(branch_json(scene, sweep, branch));
  json["branches"] = std::move(branches);
  // Filled before they are added: a document's members move when it grows.
  Json folds = Json::array(), details = Json::array(), bifurcations = Json::array(), jumps = Json::array();
  for (const NonlinearEvent& fold : sweep.folds) {
    folds.push_back(place_of(scene, fold.x, fold.speed));
    details.push_back(event_json(scene, fold));
  }
  for (const NonlinearEvent& event : sweep.bifurcations) bifurcations.push_back(event_json(scene, event));
  for (const Jump& jump : sweep.jumps) jumps.push_back(jump_json(scene, sweep, jump));
  json["folds"] = std::move(folds);
  json["fold_details"] = std::move(details);
  json["bifurcations"] = std::move(bifurcations);
  json["jumps"] = std::move(jumps);
  json["stopped"] = sweep.stopped;
  add_followed(json, scene, sweep);
}

std::string branches_words(const NonlinearSweep& sweep) {
  std::vector<NamedVerdicts> points;
  std::size_t without = 0;
  for (const auto& place : sweep.followed) {
    const NonlinearPoint* point = place ? &sweep.branches[place->branch].points[place->point] : nullptr;
    without += point == nullptr;
    if (point && point->stability) points.push_back({{"all rods together", point->stability->verdict}});
  }
  const std::string rest =
      without > 0 ? fmt::format("the branch followed does not come to {} of {}", without, sweep.followed.size()) : "";
  const std::string verdict = verdict_at_points(points, "points");
  return verdict + (verdict.empty() || rest.empty() ? "" : "; ") + rest;
}

std::string branches_verdict(const SweepScene& scene, const NonlinearSweep& sweep) {
  const std::string words = branches_words(sweep);
  return fmt::format("{}, motion without linearisation{}{}\n", scene_name(scene.scene()), words.empty() ? "" : ": ",
                     words);
}

std::string branches_table(const SweepScene& scene, const NonlinearSweep& sweep) {
  const OutputUnits units = output_units(scene.scene());
  const std::string path = scene.axis().path;
  Text text;
  add(text, "\nMotion without linearisation, all rods together\n");
  for (std::size_t b = 0; b < sweep.branches.size(); ++b) {
    const NonlinearBranch& branch = sweep.branches[b];
    add(text, "\nbranch {}: {} turn{}, {} points, ends: {}{}\n", b + 1, branch.turns, branch.turns == 1 ? "" : "s",
        branch.points.size(), to_string(branch.end), branch.why.empty() ? "" : " (" + branch.why + ")");
    add(text, "  {:>14}", path);
    for (std::size_t r = 0; r < sweep.rods.size(); ++r)
      if (sweep.reported[r]) add(text, "  {:>20}", sweep.rods[r] + " max |q_1|" + bracketed(units.response));
    add(text, "  {:>16}  {}\n", "growth" + bracketed(units.rate), "verdict");
    constexpr std::size_t rows = 24;
    const std::size_t every = (branch.points.size() + rows - 1) / rows;
    const std::size_t last = branch.points.size() - 1;  // a branch has a point
    for (std::size_t k = 0; k <= last; k = k < last ? std::min(k + every, last) : last + 1) {
      const NonlinearPoint& point = branch.points[k];
      add(text, "  {:>14.8g}", point.x);
      for (std::size_t r = 0; r < sweep.rods.size(); ++r)
        if (sweep.reported[r]) add(text, "  {:>20.8g}", point.max_abs[r].front());
      if (point.stability)
        add(text, "  {:>16.6g}  {}", point.stability->growth_rate,
            point.stability->verdict == Verdict::unstable ? "UNSTABLE" : to_string(point.stability->verdict));
      add(text, "\n");
    }
    if (every > 1) add(text, "  (every {} point and the last; --json and --out have all)\n", ordinal(every));
    add(text, "{}", bent_stress_rows(scene, sweep, branch));
  }
  add(text, "\n{}\n", sweep.folds.empty() ? "no fold" : "folds: the branch turns back");
  for (const NonlinearEvent& fold : sweep.folds)
    add(text, "  branch {}  {} = {}\n", fold.branch + 1, path, located(fold.x, fold.error));
  if (!sweep.jumps.empty())
    add(text, "jumps: a stable motion ends when {} is changed slowly\n  {:<9}  {:>16}  {:<32}  {}\n", path, "direction",
        path, "from max |q_1|", "to a stable motion with about");
  for (const Jump& jump : sweep.jumps) {
    std::string to;
    for (const RodPeaks& peaks : jump.to) to += (to.empty() ? "" : "; or ") + peaks_text(sweep, peaks, units);
    add(text, "  {:<9}  {:>16}  {:<32}  {}\n", jump.upward ? "upward" : "downward", located(jump.x, jump.error),
        peaks_text(sweep, jump.from, units), to.empty() ? "none found" : to);
  }
  add(text, "{}\n", sweep.bifurcations.empty() ? "no other bifurcation" : "other bifurcations");
  for (const NonlinearEvent& event : sweep.bifurcations)
    add(text, "  branch {}  {} = {}  {} ({})\n", event.branch + 1, path, located(event.x, event.error),
        to_string(event.kind), kind_text(event.kind));
  for (const std::string& sentence : sweep.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
  return fmt::to_string(text);
}

int branch_verdict_column(const NonlinearSweep& sweep, std::size_t rod) {
  const std::size_t modes = sweep.branches.empty() ? 0 : sweep.branches.front().points.front().max_abs[rod].size();
  return branch_first_peak_column + static_cast<int>(modes) + 3;
}

CsvFile branches_csv(const SweepScene& scene, const NonlinearSweep& sweep, std::size_t r) {
  const OutputUnits units = output_units(scene.scene());
  const int verdict = branch_verdict_column(sweep, r);
  const int modes = verdict - 3 - branch_first_peak_column;
  CsvFile file;
  file.name = file_name("branches_" + sweep.rods[r]) + ".csv";
  file.comment = {scene_name(scene.scene()) + ": " + sweep.rods[r] + " along " + scene.axis().path +
                      ", motion without linearisation",
                  "points of each branch along its arc; growth rate and verdict of all rods together", verdict_numbers};
  file.columns = {"branch", "turns", axis_label(scene), "asked for"};
  for (int i = 1; i <= modes; ++i) file.columns.push_back(fmt::format("max |q_{}|{}", i, bracketed(units.response)));
  file.columns.insert(file.columns.end(),
                      {"error bound", "growth rate" + bracketed(units.rate), "growth error" + bracketed(units.rate),
                       "verdict", "deflection" + bracketed(units.response), "bending moment [N m]",
                       "axial stress [MPa]", "bending stress [MPa]", "stress [MPa]", "stress mean [MPa]",
                       "stress amplitude [MPa]", "safety against yielding", "safety against fatigue"});
  std::size_t count = 0;
  for (const NonlinearBranch& branch : sweep.branches) count += branch.points.size();
  file.rows.setConstant(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(file.columns.size()), nan);
  Eigen::Index line = 0;
  for (std::size_t b = 0; b < sweep.branches.size(); ++b)
    for (const NonlinearPoint& point : sweep.branches[b].points) {
      auto row = file.rows.row(line++);
      Eigen::Index column = 0;
      row(column++) = static_cast<double>(b + 1);
      row(column++) = sweep.branches[b].turns;
      row(column++) = point.x;
      row(column++) = point.asked ? 1 : 0;
      for (const double value : point.max_abs[r]) row(column++) = value;
      row(column++) = point.error_bound;
      if (!point.loads.empty()) {
        const BentLoads& loads = point.loads[r];
        row.tail(9).head(4) << loads.deflection, units.moment * loads.bending_moment,
            units.megapascal * loads.stress.axial, units.megapascal * loads.stress.bending;
        if (const std::optional<StressCycle>& cycle = loads.cycle)
          row.tail(5) << units.megapascal * cycle->max_abs, units.megapascal * cycle->mean,
              units.megapascal * cycle->amplitude, cycle->yield ? cycle->yield->value : nan,
              cycle->fatigue ? cycle->fatigue->factor.value : nan;
      }
      if (!point.stability) continue;
      row(column++) = point.stability->growth_rate;
      row(column++) = point.stability->growth_error;
      row(column++) = verdict_number(point.stability->verdict);
    }
  return file;
}

CsvFile bifurcations_csv(const SweepScene& scene, const NonlinearSweep& sweep) {
  CsvFile file;
  file.name = "bifurcations.csv";
  file.comment = {
      scene_name(scene.scene()) + ": folds, bifurcations and jumps along " + scene.axis().path,
      "kind: 0 fold, 1 branch point (+1), 2 period doubling (-1), 3 Neimark-Sacker (complex pair); jump: 1 a "
      "stable motion ends there upward, -1 downward, 0 no jump"};
  file.columns = {"branch", axis_label(scene), "error", "kind", "jump"};
  std::vector<NonlinearEvent> all = sweep.folds;
  all.insert(all.end(), sweep.bifurcations.begin(), sweep.bifurcations.end());
  file.rows.resize(static_cast<Eigen::Index>(all.size()), 5);
  for (std::size_t k = 0; k < all.size(); ++k) {
    double jumps = 0;
    for (const Jump& jump : sweep.jumps)
      if (all[k].kind == BifurcationKind::fold && jump.x == all[k].x) jumps = jump.upward ? 1 : -1;
    file.rows.row(static_cast<Eigen::Index>(k)) << static_cast<double>(all[k].branch + 1), all[k].x, all[k].error,
        static_cast<double>(all[k].kind), jumps;
  }
  return file;
}

}  // namespace hb::tools
