// The flags of hb tune as written.
#pragma once

#include <string>
#include <vector>

#include "tools/command/common_flags.hpp"

namespace hb::tools {

struct TuneFlags : CommonFlags {
  std::string theory = "linear";
  std::string minimise, maximise, over, algorithm, seed, analyses, speeds;
  std::vector<std::string> vary, keep, tie, height;
};

void add_tune_flags(CLI::App& command, TuneFlags& flags);

}  // namespace hb::tools
