// The JSON documents of `hb`: keys as users and outside checks read them, numbers in the scene's units with all their
// digits. A number that does not exist (the error bound of a state that was not found) is null.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb::tools {

[[nodiscard]] nlohmann::ordered_json steady_json(const SceneModel& model, const SpeedResult& result,
                                                 const Settings& settings, bool stats);
[[nodiscard]] nlohmann::ordered_json units_json(const Units& units);
// Keys of --stats: what was computed, and what the tolerance means for each solver.
void add_stats(nlohmann::ordered_json& json, const std::vector<Stage>& stages, const Settings& settings);
[[nodiscard]] nlohmann::ordered_json accuracy_json(const Settings& settings);
// The document with a newline at its end, on one line for standard output, on many for files that are read.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& document);
[[nodiscard]] std::string json_file_text(const nlohmann::ordered_json& document);

}  // namespace hb::tools
