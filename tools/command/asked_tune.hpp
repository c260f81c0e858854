// A design as it was asked for on the command line: checked, and ready to be searched for.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/tune_flags.hpp"

namespace hb::tools {

struct AskedTune {
  SceneSource source;  // of the task's scenes
  TuneTask task;
  Scene scene;  // before; where that does not close, the start
  std::vector<std::string> remarks;  // where the search starts, where that is not the scene's own design
};

// Throws UsageError, RequestError or SceneError.
[[nodiscard]] AskedTune asked_tune(const TuneFlags& flags, const SceneInput& input);

}  // namespace hb::tools
