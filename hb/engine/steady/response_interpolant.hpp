// One component of a periodic response along a variable x, between c - r and c + r. With a resonance at x0 +- i w there
// (x - x0)^2 + w^2 times the response is interpolated, which has no pole: the square is fitted so that the last
// Chebyshev coefficients of all harmonics are least.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "lib/fourier/fourier.hpp"

namespace hb {

class ResponseInterpolant {
 public:
  static constexpr Eigen::Index num_places = 6;  // even: none in the middle, where a pole may be

  // Where the response has to be known.
  [[nodiscard]] static Eigen::VectorXd places(double c, double r);

  // At these places, one component each.
  ResponseInterpolant(double c, double r, std::span<const FourierSeries> responses);

  [[nodiscard]] FourierSeries operator()(double x) const;
  // d/dx of the response.
  [[nodiscard]] FourierSeries slope(double x) const;

  // Where the fitted square has a zero between c - r and c + r: the response has no bound there, if the fit is right.
  [[nodiscard]] std::optional<double> pole() const { return pole_; }

  // Estimates, given the response at c: of |response| at any angle and place, and with that of the slope at x.
  [[nodiscard]] double error(const FourierSeries& at_c) const;
  [[nodiscard]] double slope_error(double x, double error) const;
  // Where what is left out would be as small as rounding: it falls like r^6.
  [[nodiscard]] double better_radius(double error, const FourierSeries& at_c) const;

 private:
  double at(double x) const { return (x - c_) / r_; }

  double c_, r_;
  Eigen::Vector3d denominator_ = {1, 0, 0};  // 1 + d_1 t + d_2 t^2, t = (x - c)/r, positive
  Eigen::MatrixXcd coefficients_;  // of denominator times response: harmonics down, T_0 .. T_5 across
  std::optional<double> pole_;
};

}  // namespace hb
