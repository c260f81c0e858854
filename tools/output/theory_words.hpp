// What is said where an answer lies beyond the linear theory (theory_error.hpp), and where that was not judged.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/sweep_analysis.hpp"

namespace hb::tools {

// One sentence for each elastic link, reported or not, whose answer is beyond the theory or not judged.
[[nodiscard]] std::vector<std::string> theory_warnings(const SceneModel& model, const SpeedResult& result);
[[nodiscard]] std::vector<std::string> theory_warnings(const std::vector<std::string>& rods,
                                                       const std::optional<TheoryErrors>& errors);
// Where along the sweep; one sentence for each elastic link.
[[nodiscard]] std::vector<std::string> theory_warnings(const SweepScene& scene, const SweepResult& result);

// Theory errors were asked for and exist: a linkage with q computed.
[[nodiscard]] bool has_theory(const SweepScene& scene, const SweepResult& result);

// For titles of pictures: "beyond the linear theory (0.17)", empty where it is not.
[[nodiscard]] std::string beyond_text(const TheoryErrors& errors, std::size_t rod);
// The same of all rods.
[[nodiscard]] std::string beyond_text(const SpeedResult& result);

}  // namespace hb::tools
