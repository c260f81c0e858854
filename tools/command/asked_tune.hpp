// A design as it was asked for on the command line: checked, and ready to be searched for.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/scene_input.hpp"

namespace hb::tools {

struct TuneFlags : CommonFlags {
  std::string theory = "linear";
  std::string minimise, maximise, over, algorithm, seed, analyses, speeds;
  std::vector<std::string> vary, keep, tie, height;
};

struct AskedTune {
  TuneTask task;
  Scene scene;  // before; where that does not close, the start
  std::vector<std::string> remarks;  // where the search starts, where that is not the scene's own design
};

// Throws UsageError, RequestError or SceneError.
[[nodiscard]] AskedTune asked_tune(const TuneFlags& flags, const SceneInput& input);

}  // namespace hb::tools
