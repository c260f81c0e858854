// How far a solution of harmonic balance on harmonics 0..H is from one with twice the samples and the harmonics that
// these show, about 4H.
#pragma once

#include "hb/engine/nonlinear/corrector.hpp"

namespace hb::nonlinear {

struct TruncationCheck {
  bool found = false;  // false: r does not exist between the samples, or the finer equations were not solved
  EvaluationFailure failure;
  Unknowns finer;
  Eigen::VectorXd error;  // n: sums over harmonics of the difference, and of what may be left of the iteration
  double parameter_error = 0;
  long evaluations = 0;
};

// Iterates on the finer equations with the factors of the coarser ones inside the window and the mean blocks outside,
// until corrections are below `tolerance` of the size of u; where that contracts too slowly, by Newton's method on
// twice as many.
[[nodiscard]] TruncationCheck check_truncation(const NonlinearSystem& system, const Corrector& corrector,
                                               const HarmonicBalance& coarse, const Unknowns& x,
                                               const Constraint& constraint, double p_scale, double tolerance,
                                               const std::function<bool()>& stop);

// Fewest harmonics beyond which those of u add up to at most `tolerance` of its size.
[[nodiscard]] Eigen::Index harmonics_needed(const Eigen::VectorXd& u, Eigen::Index num_components, double tolerance);

}  // namespace hb::nonlinear
