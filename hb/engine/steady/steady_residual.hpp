// Residual of the harmonic balance in extended precision (at least 64 bits of mantissa where the machine has them).
#pragma once

#include "lib/hill_system.hpp"

namespace hb::steady {

struct AccurateResidual {
  Eigen::MatrixXcd r;  // (rows+1) x I: (h - M q'' - B q' - C q) / scale, rounded to double
  Eigen::MatrixXd rounding;  // same shape: bound on the error of r that is left; what
                             // is known as a sum over harmonics only stands in row 0
};

// All rows that can differ from zero: harmonics of q plus those of C, and those of h.
[[nodiscard]] AccurateResidual accurate_residual(const HillSystem& system, double speed, const FourierSeries& q,
                                                 double scale);

}  // namespace hb::steady
