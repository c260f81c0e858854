// Moduli of many complex numbers without the branches of std::abs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <type_traits>

namespace hb::fourier {

// A power of two that brings the largest of the numbers to order one, so that no square of those that count overflows
// or vanishes; 1 for zeros and where one is not finite.
template <class Numbers>
double unit_of(const Numbers& numbers) {
  if (numbers.size() == 0) return 1;
  double part = 0;
  if constexpr (std::is_same_v<Numbers, Eigen::MatrixXcd>) {
    const auto* parts = reinterpret_cast<const double*>(numbers.data());
    part = Eigen::Map<const Eigen::VectorXd>(parts, 2 * numbers.size()).cwiseAbs().maxCoeff();
  } else {
    part = std::max(numbers.real().cwiseAbs().maxCoeff(), numbers.imag().cwiseAbs().maxCoeff());
  }
  constexpr int most = 1000;
  return part > 0 && std::isfinite(part) ? std::ldexp(1, std::min(most, -std::ilogb(part))) : 1;
}

// To two roundings of those of order of the largest.
template <class Numbers>
Eigen::MatrixXd moduli(const Numbers& numbers) {
  const double unit = unit_of(numbers);
  return (unit * numbers).cwiseAbs2().cwiseSqrt() / unit;
}

}  // namespace hb::fourier
