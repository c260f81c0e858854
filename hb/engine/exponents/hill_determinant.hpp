// Hill's determinant of x'' + G x' + K(tau) x = 0 with diagonal G, as a function of s: an analytic function whose zeros
// are the exponents. No spectrum is sorted and nothing is propagated.
#pragma once

#include <complex>
#include <optional>

#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/system/scaled_system.hpp"

namespace hb {

class HillDeterminant {
 public:
  // A complex number e^log, and an estimate of its relative error: what the last changes leave, and the core's
  // rounding.
  struct Value {
    std::complex<double> log;
    double error = 0;
  };

  // Throws std::invalid_argument unless the damping is diagonal.
  explicit HillDeterminant(const ScaledSystem& system);

  // F(s) = prod_j 2 sinh pi (s - s_j) over the 2I exponents s_j per radian of crank angle
  //      = det(L(s)) / det(D(s)) prod_j 2 sinh pi (s - p_j),     D_i(z) = z^2 + b_i z + w_i^2 = (z - p_i)(z - p_i'),
  // L(s)_kl = D(s + ik) delta_kl + E_(k-l); the sums of all s_j and of all p_j are both -tr G (Liouville). F has
  // period i up to its sign; F(0) and F(i/2) are real, change sign at the +1 and -1 boundaries and are negative only if
  // an odd number of real multipliers lies beyond +1 or -1 (I odd: F(i/2) after division by (2i)^2I).
  // The infinite determinant is that of the harmonics up to H, those beyond to second order, as far as four times the
  // fastest mode's; H doubles until the value settles. The last change is the error, while resonances lie beyond H ten
  // times the larger one of the last two.
  Value operator()(std::complex<double> s) const;

  // Exponents near the leading one: e^{2 pi I s} F(s) is a polynomial of degree 2I in e^{2 pi s}, interpolated on the
  // circle through the leading one. Their errors hold for every polynomial within the estimated errors of the values.
  Exponents exponents() const;

  // How many exponents have a real part above c, from the turns of that polynomial about zero on the circle
  // |z| = e^{2 pi c}; empty if one lies too near to it.
  std::optional<int> exponents_above(double c) const;

 private:
  // Of the same harmonics at several s; empty: not found. Errors relative, of all values or but for a common factor.
  struct Values {
    Eigen::VectorXcd log;
    Eigen::VectorXd error;
  };
  // sum a_r (z e^{-2 pi c})^r, scaled; |error| <= change at every point of the circle. Empty a: not found.
  struct Polynomial {
    Eigen::VectorXd a;
    double change = 0;
    double value_error = 0;  // the largest relative error of the determinant on the circle
  };
  class Matrix;
  Value truncated(std::complex<double> s, Eigen::Index H) const;
  // Error that is left after the last change and the one before it.
  double left_by(double change, double before, Eigen::Index H) const;
  Values settled_values(const Eigen::VectorXcd& s, bool but_for_a_factor) const;
  Polynomial on_circle(double c) const;
  Exponents roots_near(double c, const Polynomial& polynomial) const;

  Eigen::Index I_, P_;
  FourierSeries K_;
  Eigen::VectorXcd p_, p_other_;  // the two roots of each D_i
};

}  // namespace hb
