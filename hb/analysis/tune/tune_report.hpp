// What came of a search for a design: values before and after, what holds the goal, what it depends on.
#pragma once

#include "hb/analysis/tune/tune_search.hpp"

namespace hb {

// The rest of the result, after search.run().
void report_design(TuneSearch& search, TuneResult& result);

}  // namespace hb
