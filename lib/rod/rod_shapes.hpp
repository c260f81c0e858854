// Shapes along the rod of deflection and bending moment in closed form: those of rod_shape.cpp. Used inside the
// library.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <vector>

namespace hb {

// A(s) + Im( P(s) e^{iKs} ) on s = x/l in [0, 1].
struct WavePolynomial {
  std::array<double, 6> A{};
  std::array<std::complex<double>, 3> P{};
  double K = 0;

  // `wave`: e^{iKs}.
  double at(double s, std::complex<double> wave) const {
    double a = 0;
    for (std::size_t j = A.size(); j-- > 0;) a = a * s + A[j];
    return a + ((P[0] + s * (P[1] + s * P[2])) * wave).imag();
  }
  double operator()(double s) const { return at(s, std::polar(1.0, K * s)); }
};

// sin(i pi x/l) of each mode, then the static deflections y_0, y_1, y_3k, y_2k less their first sine terms, and their
// derivatives, order 0..4.
class RodShapes {
 public:
  // flexibility = 1/S in shear
  RodShapes(double length, Eigen::Index num_modes, double flexibility = 0);

  Eigen::Index size() const { return I_ + num_static(); }

  // d^order/dx^order of every shape at x.
  Eigen::RowVectorXd values(double x, int order) const { return values(x, order, 1); }

  // Of `count` orders from the first, a row each.
  Eigen::MatrixXd values(double x, int first, int count) const;

 private:
  Eigen::Index num_static() const { return 2 + 2 * I_; }
  void add(WavePolynomial load);
  void fill_sine_terms(Eigen::Index i);

  double l_;
  Eigen::Index I_;
  double flexibility_;
  Eigen::MatrixXd tail_;  // I x static shapes
  std::vector<std::array<WavePolynomial, 5>> static_;
};

}  // namespace hb
