#include "tools/report/report_data.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "tools/output/branches_output.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/scene_report.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/report/branch_data.hpp"
#include "tools/report/map_data.hpp"
#include "tools/report/mechanism_motion.hpp"
#include "tools/report/page_values.hpp"
#include "tools/report/place_curves.hpp"
#include "tools/report/rigid_forces.hpp"
#include "tools/report/sweep_band_data.hpp"

namespace hb::tools {
namespace {

std::vector<double> at(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  std::vector<double> chosen;
  for (const std::size_t k : indices) chosen.push_back(k < values.size() ? values[k] : nan);
  return chosen;
}

// As `hb steady --json` has it.
Json document(const ReportPlace& place, const Settings& settings) {
  return place.motion ? nonlinear_json(*place.model, *place.motion, settings, false)
                      : steady_json(*place.model, place.result, settings, false);
}

// The document of one speed without what the page has once: warnings of the scene are at its top.
Json own_numbers(Json steady, const std::vector<std::string>& known_warnings) {
  if (steady.contains("warnings")) {
    Json fresh = Json::array();
    for (const Json& warning : steady["warnings"])
      if (std::find(known_warnings.begin(), known_warnings.end(), warning) == known_warnings.end())
        fresh.push_back(warning);
    steady.erase("warnings");
    if (!fresh.empty()) steady["warnings"] = std::move(fresh);
  }
  for (const char* key : {"title", "units", "tolerance", "stats", "accuracy"}) steady.erase(key);
  for (auto& [name, rod] : steady["rods"].items()) {
    if (rod.contains("q")) rod["q"].erase("fourier");
    // The exponents in other words.
    for (const char* key : {"multipliers", "frequencies", "frequencies_hz", "frequencies_hz_errors", "damping_ratios",
                            "damping_ratio_errors"})
      rod.erase(key);
  }
  return steady;
}

}  // namespace

ReportData::ReportData(const Scene& scene) : scene_(scene) {
  const bool linkage = std::holds_alternative<Linkage>(scene_.model);
  data_["kind"] = linkage ? "linkage" : "hill";
  data_["units"] = units_json(scene_.units);
  data_["units"]["time_in_s"] = scene_.units.time_in_s;
  const FrequencyUnit frequency = frequency_unit(scene_);
  data_["units"]["frequency"] = {{"name", frequency.name}, {"factor", frequency.factor}};
  data_["axis"] = axis_json("rpm", scene_.units);
  data_["points"] = {{"count", 0}};
  data_["rods"] = Json::array();
  data_["verdicts"] = Json::object();
  data_["places"] = Json::array();
  data_["motions"] = Json::array();
  data_["warnings"] = scene_.warnings;
  if (linkage) {
    const Linkage& mechanism = std::get<Linkage>(scene_.model);
    data_["motions"].push_back(motion_json(mechanism, block_));
    std::string frames = force_frames(elastic_rockers(mechanism));
    data_["force_frames"] = fmt::format(
        "Components: {}. LINK.1 acts on the link, LINK.0 is passed on to the link before it, pivots and guides act on "
        "their link.",
        frames);
  }
}

void ReportData::add_rods(const SceneModel& model, const Scene& scene) {
  for (const RodModel& rod : model.rods) {
    if (!rod.reported) continue;
    Json entry = {{"name", rod.name}, {"modes", rod.num_modes}};
    if (const auto* linkage = std::get_if<Linkage>(&scene.model)) {
      const Body& body = *body_at(*linkage, rod.link);
      entry["length"] = body.length;
      entry["section"] = body.elastic->section_height > 0;
    }
    rods_.push_back(rod.name);
    data_["rods"].push_back(std::move(entry));
  }
}

void ReportData::add_speed(const ReportPlace& place, const Settings& settings) {
  add_rods(*place.model, scene_);
  const double speed = place.motion ? place.motion->speed : place.result.speed, rpm = rpm_of(speed, scene_.units);
  if (place.motion) data_["theory"] = "nonlinear";
  data_["points"] = {{"count", 1},
                     {"x", block_.doubles(std::vector{rpm})},
                     {"rpm", block_.doubles(std::vector{rpm})},
                     {"omega", block_.doubles(std::vector{speed})}};
  data_["first_rpm"] = rpm;
  subtitle_ = speed_text(speed, scene_);
  const Json steady = document(place, settings);
  for (const auto& [name, rod] : steady["rods"].items())
    if (rod.contains("verdict")) data_["verdicts"][name] = std::string(1, letter(rod["verdict"]));
  if (steady.contains("verdict")) data_["verdicts"][""] = std::string(1, letter(steady["verdict"]));
  for (const char* key : {"status", "notes"})
    if (steady.contains(key)) data_[key] = steady[key];
  if (steady.contains("warnings")) data_["warnings"] = steady["warnings"];
  add_places({place}, settings, false);
}

void ReportData::add_bands(Json bands) { data_["bands"] = std::move(bands); }

void ReportData::add_sweep_bands(const Json& sweep) { data_["sweep_bands"] = sweep_band_data(sweep, block_); }

void ReportData::add_sweep(const SweepScene& scene, const SweepResult& result, const std::vector<ReportPlace>& places,
                           const NonlinearSweep* branches) {
  const Settings& settings = scene.settings();
  add_rods(scene.first(), scene.scene());
  Json sweep = sweep_json(scene, result, false);
  if (branches != nullptr) {
    add_branches(sweep, scene, *branches);
    data_["theory"] = "nonlinear";
  }
  const std::size_t count = result.points.size();
  const std::vector<std::size_t> kept = kept_points(count);
  data_["axis"] = axis_json(scene.axis().path, scene_.units);
  data_["points"] = {{"count", count},
                     {"x", block_.doubles(scene.axis().values)},
                     {"rpm", block_.doubles(numbers(sweep["rpm"]))},
                     {"omega", block_.doubles(numbers(sweep["omega"]))}};
  data_["first_rpm"] = sweep["rpm"].front();
  const std::vector<double>& values = scene.axis().values;
  const std::string unit = data_["axis"]["unit"];
  subtitle_ = fmt::format("{} = {:.10g} to {:.10g}{}{}, {} {}", data_["axis"]["label"].get<std::string>(),
                          values.front(), values.back(), unit.empty() ? "" : " ", unit, count,
                          scene.axis().kind == Axis::Kind::parameter ? "values" : "speeds");
  // Without linearisation all rods have one verdict together.
  for (const auto& [name, rod] : sweep["rods"].items())
    if (rod.contains("verdict"))
      data_[branches != nullptr ? "linear_verdicts" : "verdicts"][name] = letters(rod["verdict"]);
  if (sweep.contains("verdict")) data_["verdicts"][""] = letters(sweep["verdict"]);
  if (kept.size() < count) {
    data_["points"]["kept"] = kept;
    data_["points"]["every"] = kept.size() > 1 ? kept[1] : 1;
    data_["thinned"] = fmt::format(
        "{} points were computed. This page keeps numbers and curves of every {}th and of the last; the verdicts and "
        "growth rates of all.",
        count, kept[1]);
    for (const auto& [name, rod] : sweep["rods"].items()) {
      if (rod.contains("growth_rate"))
        data_["growth"][name] = {{"rate", block_.doubles(numbers(rod["growth_rate"]))},
                                 {"error", block_.doubles(numbers(rod["growth_error"]))}};
    }
    if (branches != nullptr && sweep["system"].contains("growth_rate"))
      data_["growth"][""] = {{"rate", block_.doubles(numbers(sweep["system"]["growth_rate"]))},
                             {"error", block_.doubles(numbers(sweep["system"]["growth_error"]))}};
  }
  add_along(scene, result);
  for (const char* key : {"status", "notes"})
    if (sweep.contains(key)) data_[key] = sweep[key];
  if (sweep.contains("warnings")) add_warnings(sweep["warnings"]);
  add_places(places, settings, scene.axis().kind != Axis::Kind::parameter);

  // What the page reads of the sweep's own document; its columns are elsewhere.
  Json& own = data_["sweep"] = Json::object();
  for (const char* key : {"critical", "band_details", "not_excluded", "problems"})
    if (sweep.contains(key)) own[key] = std::move(sweep[key]);
  if (branches != nullptr) own["nonlinear"] = branch_data(sweep, *branches, block_);
  const auto columns = [&](Json& range) {
    for (const char* end : {"min", "max"}) range[end] = block_.floats(at(numbers(range[end]), kept));
  };
  if (sweep.contains("joints")) {
    for (auto& [joint, components] : sweep["joints"].items())
      for (auto& [component, range] : components.items()) columns(range);
    own["joints"] = std::move(sweep["joints"]);
    if (sweep.contains("torque")) {
      columns(sweep["torque"]);
      columns(sweep["torque"]["rigid"]);
      own["torque"] = std::move(sweep["torque"]);
    }
    own["forces_x"] = block_.doubles(at(scene.axis().values, kept));
  }
}

// Rows along the axis: the points asked for and those refined between them.
void ReportData::add_along(const SweepScene& scene, const SweepResult& result) {
  Json& along = data_["along"];
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const SweepRod& rod = result.rods[r];
    if (!rod.reported) continue;
    const CsvFile table = sweep_rod_csv(scene, result, r);
    const SweepColumns columns = sweep_columns(scene, result, r);
    const auto column = [&](Eigen::Index number) {
      const Eigen::VectorXd values = table.rows.col(number - 1);
      return std::vector<double>(values.begin(), values.end());
    };
    if (!along.contains("x")) {
      along["x"] = block_.doubles(column(1));
      const std::size_t between = static_cast<std::size_t>(table.rows.rows()) - result.points.size();
      along["words"] = fmt::format(
          "{} computed points{}", result.points.size(),
          between > 0 ? fmt::format(" and {} between them, where peaks and the ends of bands were located.", between)
                      : ".");
    }
    Json& own = along["rods"][rod.name];
    if (result.computed.steady)
      for (int i = 0; i < rod.num_modes; ++i) own["max_abs"].push_back(block_.floats(column(columns.first_peak + i)));
    if (result.computed.stability) {
      own["growth_rate"] = block_.floats(column(columns.growth));
      own["growth_error"] = block_.floats(column(columns.growth + 1));
      for (int i = 0; i < rod.num_modes; ++i) {
        own["frequency"].push_back(block_.floats(column(columns.first_frequency + 2 * i)));
        own["growth"].push_back(block_.floats(column(columns.first_frequency + 2 * i + 1)));
      }
    }
    if (columns.beyond > 0) {
      // 1 where the linear theory does not hold, in the order of the rows.
      std::string marks;
      for (const double beyond : column(columns.beyond)) marks += beyond == 1 ? '1' : '0';
      own["beyond"] = marks;
    }
  }
}

void ReportData::add_places(const std::vector<ReportPlace>& places, const Settings& settings, bool one_scene) {
  for (const ReportPlace& place : places) {
    Json entry;
    if (!place.model) {
      entry["problem"] = place.problem;
    } else {
      if (!place.problem.empty()) entry["lacking"] = place.problem;
      entry["curves"] = place_curves(place, block_);
      const std::optional<JointForces>& forces = place.motion ? place.motion->forces : place.result.forces;
      if (!one_scene && forces) {
        Json& rigid = entry["curves"]["rigid"];
        for (const JointForce& joint : forces->joints) rigid["joints"][joint.name] = block_.series(joint.rigid);
        rigid["torque"] = block_.series(forces->torque_rigid);
      }
      if (!one_scene && place.model->linkage() && places.size() > 1) {
        entry["motion"] = data_["motions"].size();
        data_["motions"].push_back(motion_json(*place.model->linkage(), block_));
      }
      const Json own = own_numbers(document(place, settings), scene_.warnings);
      for (const auto& [name, rod] : own["rods"].items())
        data_["has_theory"] = data_.value("has_theory", false) || rod.contains("theory_error");
      const PackedNumbers::Place packed = packed_.add(own);
      entry["shape"] = packed.shape;
      entry["numbers"] = packed.first;
    }
    data_["places"].push_back(std::move(entry));
  }
  if (one_scene) {
    if (Json rigid = rigid_forces_json(places, block_); !rigid.is_null()) data_["rigid"] = std::move(rigid);
  }
}

void ReportData::add_warnings(const Json& sentences, const std::string& of) {
  Json& known = data_["warnings"];
  for (const Json& sentence : sentences)
    if (std::find(known.begin(), known.end(), sentence) == known.end())
      known.push_back(of + sentence.get<std::string>());
}

void ReportData::add_map(Json map, const SceneSource& source) {
  if (rods_.empty())
    for (const auto& [name, rod] : map["rods"].items()) {
      rods_.push_back(name);
      data_["rods"].push_back({{"name", name}, {"modes", map.value("modes", 0)}});
    }
  const std::string over =
      fmt::format("stability over {} and {}", map["x"]["path"].get<std::string>(), map["y"]["path"].get<std::string>());
  subtitle_ = subtitle_.empty() ? over : subtitle_ + "; " + over;
  if (map.contains("warnings")) add_warnings(map["warnings"], "map: ");
  data_["map"] = map_data(std::move(map), source, scene_.units, block_);
}

void ReportData::add_design(Json tune, const std::string& words, const Scene& before,
                            const std::vector<DesignCurve>& curves) {
  Json& design = data_["design"];
  for (const char* key : {"title", "units", "stats", "accuracy"}) tune.erase(key);
  for (Json& variable : tune["variables"]) variable["unit"] = path_unit(variable["path"], scene_.units);
  design["tune"] = std::move(tune);
  design["text"] = words;
  if (const auto* linkage = std::get_if<Linkage>(&before.model)) {
    design["before_motion"] = data_["motions"].size();
    data_["motions"].push_back(motion_json(*linkage, block_));
  }
  for (const DesignCurve& curve : curves)
    design["curves"].push_back({{"title", curve.title},
                                {"unit", curve.unit},
                                {"before_x", block_.doubles(curve.before_x)},
                                {"before", block_.doubles(curve.before)},
                                {"after_x", block_.doubles(curve.after_x)},
                                {"after", block_.doubles(curve.after)}});
}

std::string ReportData::page(PageText text) const {
  Json data = data_;
  ByteBlock block = block_;
  data["numbers"] = block.doubles(packed_.numbers());
  data["shapes"] = packed_.shapes();
  data["words"] = packed_.words();
  data["bytes"] = block.base64();
  // As the other documents have it; the scene's text is in the page.
  data["provenance"] = {
      {"program", text.origin.program},
      {"command", text.origin.command},
      {"scene", {{"file", text.origin.scene_file}, {"crc32", fmt::format("{:08x}", crc32(text.origin.scene_text))}}}};
  text.title = scene_name(scene_);
  if (text.subtitle.empty()) text.subtitle = subtitle_;
  text.scene_table = scene_table(scene_);
  text.num_points = data["points"]["count"];
  text.has_map = data.contains("map");
  if (data.contains("first_rpm")) text.first_rpm = data["first_rpm"].dump();
  for (const std::string& rod : rods_) {
    const std::string verdicts = data["verdicts"].value(rod, data["verdicts"].value(std::string(), std::string()));
    const char first = verdicts.empty() ? '-' : verdicts.front();
    text.rods.push_back({rod, first == 's'   ? "stable"
                              : first == 'b' ? "bounded"
                              : first == 'u' ? "unstable"
                              : first == '?' ? "undecided"
                                             : "–"});
  }
  return report_page(text, data);
}

}  // namespace hb::tools
