// Where the search of a design starts.
#pragma once

#include "tools/command/tune_variables.hpp"

namespace hb::tools {

// Where the linkage does not close at the start, moves that to a design within the bounds that does, and says so.
// Throws UsageError where none is found.
void close_start(TuneTask& task, Remarks& remarks);

// Ends of the speed range that are varied start at the ends asked for. Throws UsageError.
void start_speeds(TuneTask& task, Remarks& remarks);

}  // namespace hb::tools
