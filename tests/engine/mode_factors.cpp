// The preconditioner of the steady state: the inverse of the operator where modes are not coupled, near it where they
// are a little.
#include "hb/engine/steady/mode_factors.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <random>

#include "hb/engine/steady/steady_iterative.hpp"

namespace hb {
namespace {

using cplx = std::complex<double>;
using Eigen::Index;

// Couplings among `I` modes with P harmonics, those between different modes `between` times as large.
ScaledSystem coupled(Index I, Index P, double own, double between, std::mt19937& random) {
  std::normal_distribution<double> normal;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = 0.05 * Eigen::MatrixXd::Identity(I, I);
  FourierSeries K(I * I, P), h(I, 2);
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i)
      for (Index m = 1; m <= P; ++m)
        K.c(i + I * j, m) = own * (i == j ? 1.0 : between) * cplx(normal(random), normal(random));
  for (Index i = 0; i < I; ++i) K.c(i + I * i, 0) = 3.3 + 4.0 * double(i);
  h.c.setConstant(0.5);
  system.stiffness[0] = K;
  system.load[0] = h;
  return scale_system(system, 1);
}

steady::Spectrum random_spectrum(Index H, Index I, std::mt19937& random) {
  std::normal_distribution<double> normal;
  steady::Spectrum x(H + 1, I);
  for (Index i = 0; i < I; ++i)
    for (Index k = 0; k <= H; ++k) x(k, i) = {normal(random), k > 0 ? normal(random) : 0};
  return x;
}

// |M^-1 A x - x|, largest.
double defect(const ScaledSystem& scaled, Index H, std::mt19937& random) {
  const steady::WeightedSystem system = steady::weighted(scaled);
  steady::Operator A(system, H);
  const steady::Spectrum x = random_spectrum(H, system.I, random);
  steady::Spectrum y;
  A.couple(x, H, y);
  y += A.D().cwiseProduct(x);
  steady::ModeFactors(A).solve_in_place(y);
  return (y - x).cwiseAbs().maxCoeff();
}

TEST(ModeFactors, AreTheInverseOfModesThatAreNotCoupled) {
  std::mt19937 random(3);
  for (const Index I : {1, 3, 9})
    for (const Index P : {0, 1, 2, 6})
      for (const Index H : {P + (P == 0), P + 1, 2 * P + 3, Index{30}})
        EXPECT_LT(defect(coupled(I, P, 0.7, 0, random), H, random), 1e-10) << I << ' ' << P << ' ' << H;
}

TEST(ModeFactors, AreNearItWhereModesAreCoupledALittle) {
  std::mt19937 random(4);
  EXPECT_LT(defect(coupled(6, 3, 0.3, 0.01, random), 25, random), 0.1);
}

TEST(ModeFactors, SolveToWhatIsAsked) {
  std::mt19937 random(5);
  const steady::WeightedSystem system = steady::weighted(coupled(5, 4, 0.3, 0.3, random));
  const Index H = 25;
  steady::Operator A(system, H);
  steady::IterativeInverse inverse(A);
  for (const double relative : {1e-3, 1e-10}) {
    const steady::Spectrum rhs = random_spectrum(H, system.I, random);
    steady::Spectrum z, r;
    ASSERT_TRUE(inverse.solve(rhs, relative, z));
    A.couple(z, H, r);
    r = rhs - A.D().cwiseProduct(z) - r;
    EXPECT_LE(A.scaled_norm(r), 1.01 * relative * A.scaled_norm(rhs));
  }
}

}  // namespace
}  // namespace hb
