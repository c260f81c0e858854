// Exponents of a shooting run with errors from a second one at another accuracy.
#pragma once

#include <vector>

#include "hb/engine/time/floquet_product.hpp"
#include "hb/engine/time/shooting.hpp"

namespace hb {

struct ComparedRuns {
  const LogMultipliers& fine;
  const LogMultipliers* coarse;  // null: no errors are known
  // Of the segment maps, relative to their largest entry; an exponent far below the leading one feels it amplified,
  // more than the difference of two runs shows.
  double map_error = 0;
  int num_segments = 1;
  long steps = 0;  // of the finer run
  double speed = 0;  // of the period: rad per unit time
};

[[nodiscard]] std::vector<Exponent> exponents_of(const ComparedRuns& runs);

// Fills exponents, some_below, complete_above, growth and verdict. False, with status and message, if no mode is left
// above the integrator's noise.
[[nodiscard]] bool judge_exponents(const ComparedRuns& runs, ShootingResult& result);

}  // namespace hb
