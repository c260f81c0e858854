// The numbers that a design varies, as written on the command line (--vary, --tie).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/command/tune_flags.hpp"

namespace hb::tools {

// Sentences: where the search starts, where that is not the scene's own design.
using Remarks = std::vector<std::string>;

// "A:B" with A < B. Throws UsageError.
[[nodiscard]] std::pair<double, double> bounds_flag(const std::string& flag, const std::string& text);

// An end of the speed range.
[[nodiscard]] bool is_speed_range(const TuneVariable& variable);

// Moved into the bounds if need be.
void start_at(TuneVariable& variable, double value, Remarks& remarks);

// Ends of the speed range start later, in `start_speeds`. Throws UsageError, SceneError.
[[nodiscard]] std::vector<TuneVariable> tune_variables(const TuneFlags& flags, const SceneSource& source,
                                                       Remarks& remarks);

}  // namespace hb::tools
