// The discriminant of one mode over a rectangle of two parameters by Chebyshev polynomials in both:
// hb/engine/README.md, "One mode".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/exponents/verdict.hpp"

namespace hb {

struct ParameterBox {
  std::array<double, 2> low{}, high{};

  // -1 at `low`, 1 at `high`; 0 where both are one.
  double unit(std::size_t axis, double v) const {
    const double width = high[axis] - low[axis];
    return width > 0 ? ((v - low[axis]) - (high[axis] - v)) / width : 0;
  }
  double value(std::size_t axis, double t) const { return 0.5 * ((1 - t) * low[axis] + (1 + t) * high[axis]); }
  bool contains(double x, double y) const { return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1]; }
};

// A sum of products c_kl T_k T_l, (degree + 1) x (degree + 1).
class ChebyshevProduct {
 public:
  ChebyshevProduct() = default;
  // Values at the Lobatto nodes of both axes (lib/chebyshev.hpp). Terms below rounding are dropped.
  explicit ChebyshevProduct(const Eigen::MatrixXd& values);

  // Largest sum of coefficients of one degree along the axis, of the last three degrees.
  [[nodiscard]] double tail(std::size_t axis) const;
  // Sum of the terms that are dropped: bound on what that changes.
  [[nodiscard]] double dropped() const { return dropped_; }
  [[nodiscard]] double at(double u, double v) const;
  // Coefficients along one axis where the other one's place is given.
  [[nodiscard]] Eigen::VectorXd along(std::size_t axis, double other) const;
  // At the products of places: row i for u_i, column j for v_j.
  [[nodiscard]] Eigen::MatrixXd at_all(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;

 private:
  Eigen::MatrixXd c_;  // of all degrees given
  Eigen::Index rows_ = 0, columns_ = 0;  // of those that count
  double dropped_ = 0;
};

// What is known at one place.
struct DiscriminantValue {
  double value = 0, limit = 1, error = HUGE_VAL;  // Delta, L, and the error of their difference
  double damping = 0, damping_error = 0;  // b
  double speed = 0, speed_error = HUGE_VAL;  // of the shortest period
};

struct DiscriminantPatch {
  ParameterBox box;
  ChebyshevProduct value, limit, damping, speed;
  double error = HUGE_VAL;  // of value and limit together, (D4)
  double damping_error = HUGE_VAL, speed_error = HUGE_VAL;

  [[nodiscard]] DiscriminantValue at(double x, double y) const;
};

// Growth rate and verdict that a place has without doubt.
struct SettledGrowth {
  Verdict verdict = Verdict::undecided;
  double growth_rate = 0, growth_error = 0;  // 1/time
  bool real = false;  // the multiplier over the shortest period is real, of the sign of the discriminant
};

// hb/engine/README.md, (D5): false where the verdict, or the growth rate to 1e-8 of the speed, needs exponents.
[[nodiscard]] bool settled(const DiscriminantValue& value, bool undamped, SettledGrowth& growth);

}  // namespace hb
