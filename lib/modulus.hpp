// |z| by squares: what is scaled stays far from the ends of the range, where hypot would be needed.
#pragma once

#include <cmath>
#include <complex>

namespace hb {

inline double modulus(std::complex<double> z) { return std::sqrt(std::norm(z)); }

// Of a whole matrix, an expression.
template <class Matrix>
auto moduli(const Matrix& z) {
  return z.cwiseAbs2().cwiseSqrt();
}

}  // namespace hb
