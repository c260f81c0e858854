// What `hb tune` says: table, JSON, designs tried and the tuned scene.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/verdict_words.hpp"

namespace hb::tools {

[[nodiscard]] std::string tune_table(const TuneTask& task, const TuneResult& result, const Scene& scene);
[[nodiscard]] nlohmann::ordered_json tune_json(const TuneTask& task, const TuneResult& result, const Scene& scene,
                                               bool stats);

// Every design tried: variables, goal, conditions' excess.
[[nodiscard]] CsvFile history_csv(const TuneTask& task, const TuneResult& result);
// Names of its files: the design found, or the nearest where none meets all conditions.
inline constexpr const char *tuned_file = "tuned.toml", *nearest_file = "nearest.toml";
[[nodiscard]] const char* scene_file(const TuneResult& result);
// `source`, the text that the task's scenes come from, with the tuned numbers, which begins with a comment where
// something was not reached; relative paths of further files lead from `folder`.
[[nodiscard]] std::string tuned_scene(const SceneSource& source, const TuneTask& task, const TuneResult& result,
                                      const Units& units, const std::filesystem::path& scene_file,
                                      const std::filesystem::path& folder);

// Of each elastic link over all speeds.
[[nodiscard]] NamedVerdicts tune_verdicts(const std::vector<RodMargin>& margins);

// Empty, or why the exit status is "not reached".
[[nodiscard]] std::string shortfall(const TuneResult& result);

}  // namespace hb::tools
