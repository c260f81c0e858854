// Products with the block Hill operator, by convolution or by FFT, and what their rounding is said to be.
#include <gtest/gtest.h>

#include <complex>
#include <random>

#include "hb/engine/steady/steady_operator.hpp"

namespace hb {
namespace {

using cplx = std::complex<double>;
using Extended = std::complex<long double>;

ScaledSystem random_system(Eigen::Index I, Eigen::Index P, std::mt19937& random) {
  std::normal_distribution<double> normal;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = Eigen::MatrixXd::Constant(I, I, 0.01) + 0.1 * Eigen::MatrixXd::Identity(I, I);
  FourierSeries K(I * I, P), h(I, 2);
  for (auto* series : {&K, &h})
    for (cplx& c : series->c.reshaped()) c = {normal(random), normal(random)};
  for (auto* series : {&K, &h}) series->c.col(0) = series->c.col(0).real().cast<cplx>().eval();
  for (Eigen::Index i = 0; i < I; ++i) K.c(i + I * i, 0) += 10.0 * double(i + 1);
  system.stiffness[0] = K;
  system.load[0] = h;
  return scale_system(system, 1.3);
}

// Row k of f - A x in 64 bits.
Extended exact_row(const steady::WeightedSystem& s, const steady::Spectrum& x, Eigen::Index i, Eigen::Index k) {
  const auto at = [&](Eigen::Index j, Eigen::Index l) -> Extended {
    if (std::abs(l) >= x.rows()) return 0;
    const Extended value = x(std::abs(l), j);
    return l < 0 ? std::conj(value) : value;
  };
  const long double n = static_cast<long double>(k);
  Extended sum = k < s.f.rows() ? Extended(s.f(k, i)) : Extended(0);
  for (Eigen::Index j = 0; j < s.I; ++j) {
    for (Eigen::Index m = -s.P; m <= s.P; ++m) {
      const Extended E = s.K(i + s.I * j, std::abs(m));
      if (m != 0 || i != j) sum -= (m < 0 ? std::conj(E) : E) * at(j, k - m);
    }
    sum -= Extended(0, n * s.G(i, j)) * at(j, k);
  }
  return sum - (static_cast<long double>(s.mean(i)) - n * n) * at(i, k);
}

TEST(HillProducts, ResidualsAreRightToTheRoundingStated) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const auto& [I, P] : {std::pair{1, 1}, {1, 3}, {2, 1}, {1, 4}, {2, 2}, {3, 6}}) {
    const ScaledSystem scaled = random_system(I, P, random);
    const steady::WeightedSystem s = steady::weighted(scaled);
    for (const Eigen::Index H : {2, 9, 20}) {
      steady::Spectrum x(H + 1, I);
      for (Eigen::Index k = 0; k <= H; ++k)
        for (Eigen::Index i = 0; i < I; ++i)
          x(k, i) = cplx(normal(random), k > 0 ? normal(random) : 0) * std::pow(0.3, double(k));
      steady::Operator A(s, H);
      const steady::Spectrum r = A.residual(x);
      ASSERT_GE(r.rows(), H + s.P + 1);
      EXPECT_GT(A.noise().minCoeff(), 0) << I << " " << P;
      for (Eigen::Index i = 0; i < I; ++i)
        for (Eigen::Index k = 0; k < r.rows(); ++k) {
          const Extended exact = exact_row(s, x, i, k);
          const double own = k <= H ? 4e-16 * (std::abs(A.D()(k, i) * x(k, i)) + std::abs(exact)) : 0;
          const double error = double(std::abs(Extended(r(k, i)) - exact));
          EXPECT_LE(error, A.noise()(i) + own + 1e-16 * double(std::abs(exact)))
              << I << " " << P << " " << H << " " << k;
        }
    }
  }
}

}  // namespace
}  // namespace hb
