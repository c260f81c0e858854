// A periodic motion where Newton's method from the start does not find one.
#pragma once

#include "hb/engine/nonlinear/periodic_motion.hpp"

namespace hb {

// solve_periodic_motion; where that ends without a motion, along the branch of
//     r(q; p) = (1 - lambda) r(q_start; p),     lambda = 0..1,
// through its folds (Newton's homotopy: E. L. Allgower, K. Georg, Numerical Continuation Methods, Springer 1990,
// doi:10.1007/978-3-642-61257-2). Which of several motions is found is left open.
[[nodiscard]] PeriodicMotion find_periodic_motion(const NonlinearSystem& system, double parameter,
                                                  const FourierSeries& start, const MotionOptions& options = {});

}  // namespace hb
