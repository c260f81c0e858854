// The numbers of a Hill system in one vector, so that they can be interpolated, and what interpolation leaves wrong.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "hb/engine/system/scaled_system.hpp"

namespace hb::scene_plane {

constexpr std::size_t num_powers = 3;

// What they are: mass, damping, then per power the harmonics of the stiffness.
struct Layout {
  Eigen::Index num_modes = 0;
  std::array<Eigen::Index, num_powers> columns{};  // harmonics + 1; 0: no such power

  Eigen::Index matrix() const { return num_modes * num_modes; }
  Eigen::Index size() const { return (2 + 2 * (columns[0] + columns[1] + columns[2])) * matrix(); }
  void widen(const HillSystem& system) {
    num_modes = system.num_modes();
    for (std::size_t p = 0; p < num_powers; ++p) columns[p] = std::max(columns[p], system.stiffness[p].c.cols());
  }
};

[[nodiscard]] Eigen::VectorXd packed(const HillSystem& system, const Layout& layout);
[[nodiscard]] HillSystem unpacked(const Eigen::VectorXd& v, const Layout& layout);

// Per entry (i, k) of each matrix sqrt(d_i d_k) with d the largest of the diagonal, or its own largest value.
[[nodiscard]] Eigen::VectorXd scales(const Eigen::VectorXd& v, const Layout& layout);

// What the interpolated numbers of a system may be wrong by, I x I each; those of stiffness summed over the harmonics,
// per power, and beside them their largest sizes.
struct NumberErrors {
  Eigen::MatrixXd mass, damping;
  std::array<Eigen::MatrixXd, num_powers> stiffness, stiffness_sizes;
};

// Of sums of products of Chebyshev polynomials, a column of coefficients each, from the largest differences at a few
// places.
[[nodiscard]] NumberErrors errors_of(const Eigen::VectorXd& differences, const Eigen::MatrixXd& coefficients,
                                     const Layout& layout);

// At one speed; relative errors of the mass are taken to be errors of both.
[[nodiscard]] GivenErrors given_errors(const HillSystem& system, const NumberErrors& errors, double speed);

}  // namespace hb::scene_plane
