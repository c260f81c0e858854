// What is said where an answer lies beyond the linear theory (theory_error.hpp) or beyond small deflections
// (rod_stress.hpp), and where that was not judged.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/sweep_analysis.hpp"

namespace hb::tools {

// How a link's warning ends where there is no theory error to judge by; tables say it once for all links.
inline constexpr const char* not_judged = "theory not judged: q was not computed";

// One sentence for each elastic link, reported or not, whose answer is beyond the theory or not judged.
[[nodiscard]] std::vector<std::string> theory_warnings(const SceneModel& model, const SpeedResult& result);
[[nodiscard]] std::vector<std::string> theory_warnings(const std::vector<std::string>& rods,
                                                       const std::optional<TheoryErrors>& errors);
// A place along a sweep; without an answer nothing counts.
struct TheoryAlong {
  double x = 0;
  bool there = true;
  std::optional<double> error;
  std::string reason;  // why there is none
};
// "AB: beyond the linear theory at 3 of 30 points (...): rpm = 1400 to 1600"; empty where it is nowhere.
[[nodiscard]] std::string theory_warning(const std::string& name, const std::string& path,
                                         const std::vector<TheoryAlong>& places);
// Where along the sweep; one sentence for each elastic link.
[[nodiscard]] std::vector<std::string> theory_warnings(const SweepScene& scene, const SweepResult& result);

// One sentence for each elastic link whose answer is beyond small deflections.
[[nodiscard]] std::vector<std::string> limit_warnings(const SceneModel& model, const SpeedResult& result);
// Where along the sweep.
[[nodiscard]] std::vector<std::string> limit_warnings(const SweepScene& scene, const SweepResult& result);
[[nodiscard]] inline bool beyond_limits(const RodPoint& rod) {
  return rod.buckling_share > buckling_share_limit || rod.strain > strain_limit;
}

// Theory errors were asked for and exist: a linkage with q computed.
[[nodiscard]] bool has_theory(const SweepScene& scene, const SweepResult& result);

// For titles of pictures: "beyond the linear theory (0.17)", "beyond small deflections"; empty where it is neither.
[[nodiscard]] std::string beyond_text(const SpeedResult& result, std::size_t rod);
// The same of all rods.
[[nodiscard]] std::string beyond_text(const SpeedResult& result);

}  // namespace hb::tools
