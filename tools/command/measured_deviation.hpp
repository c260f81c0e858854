// How far measured values (--measured) are from the computed ones: numbers beside the circles in pictures.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "tools/pictures/measured.hpp"

namespace hb::tools {

// Of one measured column, measured less computed, in the unit of the pictures. NaN where no value has a computed one.
struct MeasuredDeviation {
  std::string quantity, unit;
  std::string theory = "linear";  // that the computed values are of, or "nonlinear"
  int values = 0, left_out = 0;  // compared; outside the range, or where nothing was computed
  double mean = 0, rms = 0;
  double largest = 0, at = 0;  // that of the largest magnitude, and its place
  double size = 0;  // largest measured magnitude
};

struct MeasuredComparison {
  std::string file;
  MeasuredQuantity axis;
  std::vector<MeasuredDeviation> deviations;
  MeasuredOverlay overlay;  // with the computed values as further columns
};

// Over one turn, or over the `turns` of a motion: the response's series at each angle. `theory`: whose result it is.
[[nodiscard]] MeasuredComparison compare_measured(const std::string& file, const SceneModel& model,
                                                  const SpeedResult& result, const std::string& theory = "linear",
                                                  int turns = 1);
// Along a sweep: computed anew at each measured place within its range. A frequency is that of the nearest mode, a
// force or torque the nearer of its smallest and largest over the turn. With `branches` (motion without linearisation)
// deflection, moment, stress and q_i are those of the motions there that are not unstable, the nearest; everything else
// is the linear theory's.
[[nodiscard]] MeasuredComparison compare_measured(const std::string& file, const SceneFamily& family,
                                                  const SweepRequest& request, const SweepScene& scene,
                                                  const std::optional<NonlinearSweepOptions>& branches, Work& work);

// The value of `measured` in the document.
[[nodiscard]] nlohmann::ordered_json measured_json(const MeasuredComparison& comparison);
[[nodiscard]] std::string measured_table(const MeasuredComparison& comparison);

}  // namespace hb::tools
