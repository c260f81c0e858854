// Reference for tests: the real dense harmonic balance system in cosines and sines, built term by term from the
// product formulas, LU in double and iterative refinement with residuals in long double. Shares nothing with the
// engine but the types.
#pragma once

#include <Eigen/Core>

#include "lib/hill_system.hpp"

namespace hb::reference {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

struct Response {
  Matrix cosine, sine;  // I x (H+1): q = sum cosine_k cos k tau + sine_k sin k tau
  long double change = 0;  // size of the last refinement, relative
};

Response dense_harmonic_balance(const HillSystem& system, double speed, Eigen::Index H);

// max over turn and components of |q - reference|, relative to that of the reference.
double true_error(const FourierSeries& q, const Response& reference);

}  // namespace hb::reference
