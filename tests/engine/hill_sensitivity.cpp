#include "hb/engine/exponents/hill_sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "hb/engine/steady/steady_state.hpp"
#include "lib/rod/rod_functional.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;
using Eigen::Index;
using Eigen::MatrixXd;

// A family of systems with M, B, C, h moving along a fixed direction: p = 0 is the middle.
struct Family {
  HillSystem base, direction;

  HillSystem at(double p) const {
    HillSystem system = base;
    system.mass += p * direction.mass;
    system.damping += p * direction.damping;
    for (std::size_t k = 0; k < 3; ++k) {
      if (base.stiffness[k].c.size() > 0) system.stiffness[k].c += p * direction.stiffness[k].c;
      if (base.load[k].c.size() > 0) system.load[k].c += p * direction.load[k].c;
    }
    return system;
  }
};

HillSystem random_system(Index I, std::mt19937& random, double scale, bool whole) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto matrix = [&] { return MatrixXd(MatrixXd::NullaryExpr(I, I, [&] { return scale * unit(random); })); };
  HillSystem system;
  system.mass = 0.2 * matrix();
  system.damping = 0.2 * matrix();
  system.stiffness[0] = FourierSeries(I * I, 3);
  system.stiffness[2] = FourierSeries(I * I, 1);
  system.load[0] = FourierSeries(I, 5);
  system.load[1] = FourierSeries(I, 2);
  for (FourierSeries* series : {&system.stiffness[0], &system.stiffness[2], &system.load[0], &system.load[1]})
    for (Index k = 0; k < series->c.cols(); ++k)
      for (Index i = 0; i < series->c.rows(); ++i)
        series->c(i, k) = 0.3 * scale * std::complex<double>(unit(random), k > 0 ? unit(random) : 0.0);
  if (!whole) return system;
  for (Index i = 0; i < I; ++i) {
    system.mass(i, i) += 1;
    system.damping(i, i) += 0.5;
    system.stiffness[0].c(i + I * i, 0) += 2.0 + 3 * static_cast<double>(i);
  }
  return system;
}

Family random_family(Index I, unsigned seed) {
  std::mt19937 random(seed);
  return {random_system(I, random, 1, true), random_system(I, random, 1, false)};
}

// Central differences with steps h and h/2. Their difference is three times the truncation error of the finer one
// (error h^2); `noise` is the error of f, known when f was called.
void expect_derivative(double derivative, const std::function<double(double)>& f, double h, const double& noise) {
  const double coarse = (f(h) - f(-h)) / (2 * h), fine = (f(h / 2) - f(-h / 2)) / h;
  EXPECT_NEAR(derivative, fine, std::abs(coarse - fine) + 4 * noise / h);
  EXPECT_LE(std::abs(coarse - fine) + 4 * noise / h, 1e-4 * std::max(1.0, std::abs(fine)));  // that says something
}

FourierSeries steady(const HillSystem& system, double speed) {
  SteadyOptions options;
  options.tolerance = 1e-12;
  return solve_steady_state(system, speed, options).q;
}

// The derivative along the family by a small step of what is affine in p.
FourierSeries residual_slope(const Family& family, double speed, const FourierSeries& q) {
  FourierSeries slope = equation_residual(family.at(1), speed, q);
  slope.c -= equation_residual(family.at(0), speed, q).c;
  return slope;
}

TEST(HillSensitivity, ResidualOfTheSteadyStateVanishes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const HillSystem system = random_family(3, seed).base;
    const FourierSeries q = steady(system, 1.3);
    const FourierSeries r = equation_residual(system, 1.3, q);
    EXPECT_LE(r.c.cwiseAbs().maxCoeff(), 1e-9 * load_at(system, 1.3).c.cwiseAbs().maxCoeff());
  }
}

TEST(HillSensitivity, AdjointGivesTheDerivativeOfTheResponse) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Index I = 1 + seed % 4, mode = seed % I;
    const double speed = 0.7 + 0.1 * seed, tau = 0.5 * seed;
    const Family family = random_family(I, seed);
    const FourierSeries q = steady(family.base, speed);
    const FourierSeries g = point_functional(I, q.num_harmonics(), mode, tau);
    const double value = fourier::evaluate(q, tau)(mode);
    EXPECT_NEAR(fourier::mean_product(g, q), value, 1e-13 * q.c.cwiseAbs().sum());
    const auto lambda = solve_adjoint(family.base, speed, g, q.num_harmonics());
    ASSERT_TRUE(lambda);
    const double derivative = fourier::mean_product(*lambda, residual_slope(family, speed, q));
    expect_derivative(
        derivative, [&](double p) { return fourier::evaluate(steady(family.at(p), speed), tau)(mode); }, 1e-4,
        1e-12 * q.c.cwiseAbs().sum());
  }
}

TEST(HillSensitivity, AdjointAndLinearisedSolutionAgreeToRounding) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Index I = 1 + seed % 4, H = 20;
    const Family family = random_family(I, 100 + seed);
    const FourierSeries q = fourier::resized(steady(family.base, 1.1), H);
    const FourierSeries g = point_functional(I, H, 0, 0.3 * seed), r = residual_slope(family, 1.1, q);
    const auto lambda = solve_adjoint(family.base, 1.1, g, H), slope = solve_linearised(family.base, 1.1, r, H);
    ASSERT_TRUE(lambda && slope);
    const double by_adjoint = fourier::mean_product(*lambda, r), directly = fourier::mean_product(g, *slope);
    EXPECT_NEAR(by_adjoint, directly, 1e-9 * slope->c.cwiseAbs().sum());
  }
}

// Exponents that the two neighbours have nearest to the first one's.
double nearest_real(const HillSystem& system, double speed, std::complex<double> wanted, double& error) {
  const Stability stability = analyse_stability(system, speed);
  double best = HUGE_VAL, real = 0;
  for (const Exponent& exponent : stability.exponents) {
    if (std::abs(exponent.value - wanted) >= best) continue;
    best = std::abs(exponent.value - wanted);
    real = exponent.value.real();
    error = std::max(error, exponent.error);
  }
  return real;
}

TEST(HillSensitivity, FloquetVectorsGiveTheDerivativeOfEveryExponent) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const double speed = 0.9 + 0.15 * seed;
    const Family family = random_family(1 + seed % 3, 200 + seed);
    for (const Exponent& exponent : analyse_stability(family.base, speed).exponents) {
      const auto vectors = floquet_vectors(family.base, speed, exponent);
      if (!vectors) continue;
      EXPECT_NEAR(vectors->s.real(), exponent.value.real(), 1e-14 * std::abs(exponent.value) + 1e-15);
      const double derivative =
          exponent_nearby(*vectors, family.at(1)).real() - exponent_nearby(*vectors, family.base).real();
      double error = 1e-13;
      const auto real = [&](double p) { return nearest_real(family.at(p), speed, exponent.value, error); };
      expect_derivative(derivative, real, 1e-4, error);
      ++compared;
    }
  }
  EXPECT_GE(compared, 30);
}

TEST(HillSensitivity, WhereExponentsMeetThereIsNoDerivative) {
  // x'' + 2 x' + x = 0: both exponents are -1.
  HillSystem system;
  system.mass = MatrixXd::Ones(1, 1);
  system.damping = MatrixXd::Constant(1, 1, 2);
  system.stiffness[0] = FourierSeries(1, 0);
  system.stiffness[0].c << 1;
  Exponent exponent;
  exponent.value = -1;
  EXPECT_FALSE(floquet_vectors(system, 1, exponent));
}

TEST(HillSensitivity, RodFunctionalIsTheFieldOfTheRod) {
  const Linkage linkage = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const double speed = 150;
  for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
    const Body& link = *body_at(linkage, coefficients.links[r]);
    const FourierSeries q = steady(ritz_system(link, coefficients.rods[r], 4), speed);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(5, 0.1, 0.9) * link.length;
    const RodField field = rod_field(link, coefficients.rods[r], speed, q, x, 7);
    const double w = field.w.cwiseAbs().maxCoeff(), moment = field.bending_moment.cwiseAbs().maxCoeff();
    for (Index i = 0; i < x.size(); ++i)
      for (Index j = 0; j < 7; ++j) {
        const auto value = [&](RodQuantity quantity) {
          const RodFunctional f = rod_functional(link, coefficients.rods[r], speed, 4, q.num_harmonics(), quantity,
                                                 x(i), 2 * M_PI * static_cast<double>(j) / 7);
          return f.offset + fourier::mean_product(f.g, q);
        };
        EXPECT_NEAR(value(RodQuantity::deflection), field.w(i, j), 1e-12 * w);
        EXPECT_NEAR(value(RodQuantity::bending_moment), field.bending_moment(i, j), 1e-12 * moment);
      }
  }
}

}  // namespace
