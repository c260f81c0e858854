// The two sides of hb compare: scenes computed, or answers that hb wrote.
#pragma once

#include <string>
#include <vector>

#include "tools/command/common_flags.hpp"
#include "tools/output/compare_output.hpp"

namespace hb::tools {

struct CompareFlags : CommonFlags {
  std::string other;
  std::vector<std::string> set_b;
};

struct ComparedSides {
  ComparedSide a, b;
  std::string texts;  // of the scenes that were read
};

// Both of one kind, and with flags that fit what is compared; else UsageError.
[[nodiscard]] ComparedSides compared_sides(const CompareFlags& flags, int threads);

}  // namespace hb::tools
