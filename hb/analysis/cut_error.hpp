// Errors of deflection and bending moment: of what is computed with I modes, and of the modes left out.
#pragma once

#include "lib/rod/rod.hpp"

namespace hb {

// Estimates of max |error of w| / max |w| and of EJ w'' likewise, over rod and turn, from cutting the Ritz series,
// quasi-static tail included.
struct CutError {
  double deflection = 0, bending_moment = 0;
};

// From two steady states of the same rod, the second (`finer`) with comparison_modes.
[[nodiscard]] CutError cut_error(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                                 const FourierSeries& finer);

// Of the largest w and EJ w'', in their units: modes left out, and |error of q_i| <= error_bound largest_q, the largest
// |q_i| over the turn.
struct PeakErrors {
  double deflection = 0, bending_moment = 0;
};
[[nodiscard]] PeakErrors peak_errors(const Body& link, const RodShape& shape, Eigen::Index num_modes, double largest_q,
                                     double error_bound, const CutError& cut);

}  // namespace hb
