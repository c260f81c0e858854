// Exponents of a system reduced to a few modes: of a single fast one by its phase function, else by propagation over a
// turn with growing numbers of cells.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "hb/engine/exponents/slaving.hpp"

namespace hb {

// Exponents per radian of crank angle (s = lambda/Omega) with their bars.
struct Exponents {
  std::vector<std::complex<double>> s;
  std::vector<double> error;
  std::vector<double> imaginary_error;  // of Im s where Re s is known otherwise
  std::vector<Eigen::Index> mode;  // see Exponent
  std::vector<double> frequency;
  double others_below = -HUGE_VAL;  // upper bound on Re s of those of the group that are not listed
  bool converged = false;  // the leading one is as accurate as asked

  void add(std::complex<double> value, double bar) {
    s.push_back(value);
    error.push_back(bar);
    imaginary_error.push_back(bar);
  }
  void reserve(std::size_t count) {
    for (auto* numbers : {&error, &imaginary_error, &frequency}) numbers->reserve(count);
    s.reserve(count);
    mode.reserve(count);
  }
  void append(const Exponents& other) {
    s.insert(s.end(), other.s.begin(), other.s.end());
    error.insert(error.end(), other.error.begin(), other.error.end());
    imaginary_error.insert(imaginary_error.end(), other.imaginary_error.begin(), other.imaginary_error.end());
    mode.insert(mode.end(), other.mode.begin(), other.mode.end());
    frequency.insert(frequency.end(), other.frequency.begin(), other.frequency.end());
    others_below = std::max(others_below, other.others_below);
  }
};

// `tolerance`: wanted relative to the leading exponent, or to a hundredth of the crank's speed if it is smaller. With
// `leading_only` exponents far below the leading one are lost, and bounded.
[[nodiscard]] Exponents reduced_exponents(const ReducedSystem& reduced, double tolerance, bool leading_only = false);

// The same by propagation only.
[[nodiscard]] Exponents propagated_exponents(const ReducedSystem& reduced, double tolerance, bool leading_only = false);

}  // namespace hb
