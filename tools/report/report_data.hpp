// The data document of a report, from what the commands computed and from the documents that they print: the page's
// numbers are those of --json, its curves are Fourier series.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/report/byte_block.hpp"
#include "tools/report/packed_numbers.hpp"
#include "tools/report/report_page.hpp"
#include "tools/report/report_places.hpp"

namespace hb::tools {

class ReportData {
 public:
  explicit ReportData(const Scene& scene);

  // One speed: its place alone.
  void add_speed(const ReportPlace& place, const Settings& settings);
  // Points along an axis: places at kept_points(), in that order; with `branches` of the motion without linearisation.
  void add_sweep(const SweepScene& scene, const SweepResult& result, const std::vector<ReportPlace>& places,
                 const NonlinearSweep* branches = nullptr);
  // How the answer of one speed moves, as bands_json has it.
  void add_bands(nlohmann::ordered_json bands);
  // How a sweep does: `sweep` as sweep_json has it, with `bands`.
  void add_sweep_bands(const nlohmann::ordered_json& sweep);
  // `map` as map_json has it; values of the scene's own numbers where they are known.
  void add_map(nlohmann::ordered_json map, const SceneSource& source);

  // The way from one design to another: `tune` as tune_json has it, `words` as the table says it. The page's points are
  // those of the design after.
  struct DesignCurve {
    std::string title, unit;
    std::vector<double> before_x, before, after_x, after;  // along the page's axis
  };
  void add_design(nlohmann::ordered_json tune, const std::string& words, const Scene& before,
                  const std::vector<DesignCurve>& curves);

  // The page; `text` holds what only the caller knows (subtitle, provenance, the scene's file, pictures).
  [[nodiscard]] std::string page(PageText text) const;

 private:
  // Each once, those of a part of the page with its name before them.
  void add_warnings(const nlohmann::ordered_json& sentences, const std::string& of = "");
  void add_rods(const SceneModel& model, const Scene& scene);
  void add_places(const std::vector<ReportPlace>& places, const Settings& settings, bool one_scene);
  void add_along(const SweepScene& scene, const SweepResult& result);

  Scene scene_;
  nlohmann::ordered_json data_;
  ByteBlock block_;
  PackedNumbers packed_;
  std::vector<std::string> rods_;
  std::string subtitle_;
};

}  // namespace hb::tools
