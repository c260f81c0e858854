#include "lib/rod/shear.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/constants.hpp"
#include "lib/rod/rod.hpp"
#include "lib/rod/rod_functional.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "tests/support/random_linkage.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Body with_shear(Body body, double coefficient, double per_E = 1 / 2.65) {
  body.elastic->shear = Shear{per_E * body.elastic->youngs_modulus, coefficient};
  return body;
}

// Connecting rod of a two-stroke engine, mm, kg, s: length 110, area 110, J 2500, steel.
Body thick_rod() {
  const Elastic steel{
      .youngs_modulus = 2.1e8, .area = 110, .second_moment = 2500, .density = 7.85e-6, .internal_damping = 1e-6};
  return six_link::elastic_body("rod", 110, 7.85e-6 * 110 * 110, steel);
}

RodCoefficients constant_load(double f0, double f1) {
  RodCoefficients rod;
  for (FourierSeries& f : rod.f) f = FourierSeries(5, 0);
  rod.f[0].c(0, 0) = f0;
  rod.f[0].c(1, 0) = f1;
  return rod;
}

// Natural frequencies at rest, bending then shear.
VectorXd frequencies(const Body& rod, Index num_modes) {
  const HillSystem system = ritz_system(rod, constant_load(0, 0), num_modes);
  const Index n = system.num_modes();
  VectorXd omega(n);
  for (Index i = 0; i < n; ++i) omega(i) = std::sqrt(system.stiffness[0].c(i + n * i, 0).real() / system.mass(i, i));
  return omega;
}

// Timoshenko's rod as four equations of first order along x,
//     w' = r + V/(k G F),  r' = M/EJ,  M' = -rho J omega^2 r - V,  V' = -mu omega^2 w,
// integrated by the classical Runge-Kutta method from both solutions with w(0) = M(0) = 0: the determinant of their
// w(l), M(l), zero at a natural frequency.
double end_determinant(const Body& rod, double omega, int steps) {
  const Elastic& e = *rod.elastic;
  const double EJ = e.youngs_modulus * e.second_moment, kGF = e.shear->coefficient * e.shear->modulus * e.area;
  const double mu = rod.mass / rod.length, rhoJ = e.density * e.second_moment, square = omega * omega;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();  // of (w, r, M, V)
  A(0, 1) = 1;
  A(0, 3) = 1 / kGF;
  A(1, 2) = 1 / EJ;
  A(2, 1) = -rhoJ * square;
  A(2, 3) = -1;
  A(3, 0) = -mu * square;
  const double h = rod.length / steps;
  const Eigen::Matrix4d hA = h * A, one = Eigen::Matrix4d::Identity();
  const Eigen::Matrix4d step = one + hA * (one + hA / 2 * (one + hA / 3 * (one + hA / 4)));
  Eigen::Matrix<double, 4, 2> z = Eigen::Matrix<double, 4, 2>::Zero();
  z(1, 0) = 1 / rod.length;
  z(3, 1) = EJ / std::pow(rod.length, 3);
  for (int k = 0; k < steps; ++k) z = (step * z).eval();
  return z(0, 0) * z(2, 1) - z(0, 1) * z(2, 0);
}

TEST(Shear, FrequenciesOfBothBranchesAreThoseOfTimoshenkosRod) {
  for (const double coefficient : {5.0 / 6, 0.45}) {
    const Body rod = with_shear(thick_rod(), coefficient);
    const VectorXd omega = frequencies(rod, 5);
    ASSERT_EQ(omega.size(), 10);
    for (Index i = 0; i < 10; ++i) {
      const double below = end_determinant(rod, omega(i) * (1 - 1e-8), 4000),
                   above = end_determinant(rod, omega(i) * (1 + 1e-8), 4000);
      EXPECT_LT(below * above, 0) << "frequency " << i << " = " << omega(i);
    }
  }
}

// The sizes that shear has for the rod of a two-stroke engine and for a slender one.
TEST(Shear, LowersTheFrequenciesOfThickRods) {
  const auto lowered = [](const Body& rod, double coefficient, Index mode) {
    return 1 - frequencies(with_shear(rod, coefficient), 5)(mode - 1) / frequencies(rod, 5)(mode - 1);
  };
  const Body AB = *body_at(six_link::linkage(), 1);
  EXPECT_NEAR(lowered(thick_rod(), 5.0 / 6, 1), 0.027, 5e-4);
  EXPECT_NEAR(lowered(thick_rod(), 0.45, 1), 0.049, 5e-4);
  EXPECT_NEAR(lowered(thick_rod(), 5.0 / 6, 5), 0.26, 5e-3);
  EXPECT_NEAR(lowered(thick_rod(), 0.45, 5), 0.385, 5e-3);
  EXPECT_NEAR(lowered(AB, 5.0 / 6, 1), 0.0010, 5e-5);
  EXPECT_NEAR(lowered(AB, 5.0 / 6, 5), 0.0245, 5e-4);
}

// Steady state and exponents of the six-link mechanism as the shear modulus grows without bound.
TEST(Shear, TheLimitOfAnInfiniteShearModulusIsTheRodRigidInShear) {
  const Linkage linkage = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const double speed = 1500 * 2 * pi / 60;
  for (std::size_t r = 0; r < 2; ++r) {
    const Body& link = *body_at(linkage, coefficients.links[r]);
    for (const double per_E : {1e7, 1e9, 1e10, 1e12, 1e30}) {
      SCOPED_TRACE(per_E);
      const Body stiff = with_shear(link, 5.0 / 6, per_E);
      const HillSystem rigid = ritz_system(link, coefficients.rods[r], 3),
                       sheared = ritz_system(stiff, coefficients.rods[r], 3);
      const SteadyOptions options{.tolerance = 1e-13};
      const SteadyState a = solve_steady_state(rigid, speed, options), b = solve_steady_state(sheared, speed, options);
      const FourierSeries q = ritz_coordinates(b.q, 3);
      const Index H = std::max(q.num_harmonics(), a.q.num_harmonics());
      const double size = a.q.c.cwiseAbs().maxCoeff();
      // What is left of shear, and rounding.
      const double allowed = 0.01 / per_E + 2e-13;
      EXPECT_LE((fourier::resized(q, H).c - fourier::resized(a.q, H).c).cwiseAbs().maxCoeff(), allowed * size);
      const RodShape shape = rod_shape(link, coefficients.rods[r], speed, a.q),
                     sheared_shape = rod_shape(stiff, coefficients.rods[r], speed, q);
      EXPECT_NEAR(sheared_shape.deflection.max_abs, shape.deflection.max_abs, 10 * allowed * shape.deflection.max_abs);
      EXPECT_NEAR(sheared_shape.bending_moment.max_abs, shape.bending_moment.max_abs,
                  10 * allowed * shape.bending_moment.max_abs);
      const Stability with = analyse_stability(sheared, speed), without = analyse_stability(rigid, speed);
      EXPECT_EQ(with.verdict, without.verdict);
      EXPECT_NEAR(with.growth_rate, without.growth_rate, with.growth_error + without.growth_error + 0.02 / per_E);
      EXPECT_LE(with.growth_error, 1e-8 * speed);
    }
  }
}

TEST(Shear, WithoutItTheSystemIsFoundAgain) {
  const Linkage linkage = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const Body& link = *body_at(linkage, 1);
  const Body sheared = with_shear(link, 5.0 / 6);
  const HillSystem plain = ritz_system(link, coefficients.rods[0], 4),
                   back = rigid_in_shear(sheared, ritz_system(sheared, coefficients.rods[0], 4), 4);
  EXPECT_LE((back.mass - plain.mass).norm(), 1e-15 * plain.mass.norm());
  EXPECT_LE((back.damping - plain.damping).norm(), 1e-15 * plain.damping.norm());
  for (std::size_t p = 0; p < 3; ++p) {
    ASSERT_EQ(back.stiffness[p].c.cols(), plain.stiffness[p].c.cols());
    if (plain.stiffness[p].c.size() == 0) continue;
    EXPECT_LE((back.stiffness[p].c - plain.stiffness[p].c).norm(), 1e-15 * plain.stiffness[p].c.norm());
    EXPECT_EQ(back.load[p].c, plain.load[p].c);
  }
}

// Deflection and rotation as unknowns, integrals by quadrature, one global system for the forces: the same equations in
// other coordinates.
TEST(Shear, TheFourierPathAgreesWithQuadratureOnRandomLinkages) {
  for (const RandomLinkage& random : random_linkages(20, 71)) {
    SCOPED_TRACE(random.kind);
    Linkage linkage = random.linkage;
    for (Dyad& dyad : linkage.dyads) {
      if (dyad.coupler.elastic) dyad.coupler = with_shear(dyad.coupler, 0.7);
      if (auto* rocker = std::get_if<Rocker>(&dyad.closing); rocker && rocker->body.elastic)
        rocker->body = with_shear(rocker->body, 0.7);
    }
    constexpr Index I = 3;
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const Body& link = *body_at(linkage, coefficients.links[r]);
      const HillSystem hill = ritz_system(link, coefficients.rods[r], I);
      const TimeDomainSystem direct = time_domain_rod(linkage, coefficients.links[r], I, random.speed),
                             series = time_domain_system(hill, random.speed);
      const RestModes modes = rest_modes(link, I);
      MatrixXd T(2 * I, 2 * I);  // (a, b) to (q, p)
      T << MatrixXd::Identity(I, I), MatrixXd::Identity(I, I), MatrixXd(modes.rotation[0].matrix().asDiagonal()),
          MatrixXd(modes.rotation[1].matrix().asDiagonal());
      const auto close = [&](const MatrixXd& mine, const MatrixXd& other) {
        // Relative to the size of what is added up on the way, entry by entry.
        const MatrixXd size = T.cwiseAbs().transpose() * other.cwiseAbs() * T.cwiseAbs();
        const MatrixXd difference = mine - T.transpose() * other * T;
        for (Index k = 0; k < difference.size(); ++k)
          EXPECT_LE(std::abs(difference(k)), 1e-11 * size.maxCoeff() + 1e-11 * size(k));
        for (Index i = 0; i < I; ++i)
          for (Index k = 0; k < I; ++k)
            EXPECT_LE(std::abs(difference(i, k)), 1e-11 * size.topLeftCorner(I, I).maxCoeff()) << i << " " << k;
      };
      close(hill.mass, direct.mass);
      close(hill.damping, direct.damping);
      MatrixXd C(2 * I, 2 * I), C0(2 * I, 2 * I);
      VectorXd h(2 * I), h0(2 * I);
      for (const double tau : {0.2, 1.9, 4.4}) {
        series.evaluate(tau, C, h);
        direct.evaluate(tau, C0, h0);
        close(C, C0);
        EXPECT_LE((h - T.transpose() * h0).norm(), 1e-11 * h.norm() + 1e-300);
      }
    }
  }
}

// Uniform load: w(l/2) = p (5 l^4/384 + l^2/(8 S)) per EJ, moment p l^2/8 whatever the shear modulus.
TEST(Shear, StaticDeflectionAndMomentAreTheClosedFormsWithAnyNumberOfModes) {
  const double f0 = 1e-9;
  const Body rod = with_shear(thick_rod(), 5.0 / 6);
  const double l = rod.length, EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment;
  const double middle = f0 * (5 * std::pow(l, 4) / 384 + l * l / 8 * shear_flexibility(rod));
  for (const Index I : {1, 2, 5}) {
    const SteadyState state = solve_steady_state(ritz_system(rod, constant_load(f0, 0), I), 10, {.tolerance = 1e-13});
    const FourierSeries q = ritz_coordinates(state.q, I);
    const RodShape shape = rod_shape(rod, constant_load(f0, 0), 10, q);
    EXPECT_NEAR(shape.deflection.max_abs, middle, 1e-12 * middle);
    EXPECT_NEAR(shape.deflection.x, l / 2, 1e-5 * l);
    EXPECT_NEAR(shape.bending_moment.max_abs, EJ * f0 * l * l / 8, 1e-12 * EJ * f0 * l * l);
    // p (x l^3 - 2 l x^3 + x^4)/24 + p x (l - x)/(2 S), and the moment.
    const VectorXd x = VectorXd::LinSpaced(9, 0, l);
    const RodField field = rod_field(rod, constant_load(f0, 0), 10, q, x, 2);
    for (Index j = 0; j < 9; ++j) {
      const double bending = x(j) * (l * l * l - 2 * l * x(j) * x(j) + x(j) * x(j) * x(j)) / 24,
                   shear = x(j) * (l - x(j)) / 2 * shear_flexibility(rod);
      EXPECT_NEAR(field.w(j, 1), -f0 * (bending + shear), 1e-12 * middle);
      EXPECT_NEAR(field.bending_moment(j, 0), EJ * f0 * x(j) * (l - x(j)) / 2, 1e-12 * EJ * f0 * l * l);
    }
  }
}

class ShearAtSpeed : public testing::Test {
 protected:
  static constexpr Index I = 3;
  const double speed = 1200 * 2 * pi / 60;
  Linkage linkage = six_link::linkage({.external_damping = 1e-4});
  LinkageCoefficients coefficients = linkage_coefficients(linkage);
  // So soft that shear matters.
  Body link = with_shear(*body_at(linkage, 1), 5.0 / 6, 1e-3);
  FourierSeries unknowns =
      solve_steady_state(ritz_system(link, coefficients.rods[0], I), speed, {.tolerance = 1e-13}).q;
  FourierSeries q = ritz_coordinates(unknowns, I);
};

TEST_F(ShearAtSpeed, RotationsFollowFromTheDeflection) {
  const RestModes modes = rest_modes(link, I);
  const FourierSeries p = rotation_coordinates(link, speed, q);
  const double size = q.c.cwiseAbs().maxCoeff();
  for (Index n = 0; n <= q.num_harmonics(); ++n)
    for (Index i = 0; i < I; ++i) {
      const std::complex<double> own =
          modes.rotation[0](i) * unknowns.c(i, n) + modes.rotation[1](i) * unknowns.c(I + i, n);
      EXPECT_LE(std::abs(p.c(i, n) - own), 1e-10 * size) << i << " " << n;
    }
  EXPECT_GT((p.c - q.c).cwiseAbs().maxCoeff(), 0.01 * size);
}

TEST_F(ShearAtSpeed, FunctionalsAreTheValuesOfTheField) {
  const VectorXd x = VectorXd::LinSpaced(5, 0, link.length);
  constexpr Index num_angles = 7;
  const RodField field = rod_field(link, coefficients.rods[0], speed, q, x, num_angles);
  for (const RodQuantity quantity : {RodQuantity::deflection, RodQuantity::bending_moment}) {
    const MatrixXd& values = quantity == RodQuantity::deflection ? field.w : field.bending_moment;
    for (Index j = 1; j < 4; ++j)
      for (Index k = 0; k < num_angles; ++k) {
        const RodFunctional f = rod_functional(link, coefficients.rods[0], speed, I, q.num_harmonics(), quantity, x(j),
                                               2 * pi * static_cast<double>(k) / num_angles);
        double value = f.offset;
        for (Index i = 0; i < I; ++i)
          for (Index n = 0; n <= q.num_harmonics(); ++n)
            value += (n > 0 ? 2 : 1) * (std::conj(f.g.c(i, n)) * q.c(i, n)).real();
        EXPECT_NEAR(value, values(j, k), 1e-11 * values.cwiseAbs().maxCoeff()) << j << " " << k;
      }
  }
}

TEST_F(ShearAtSpeed, PeaksAreTheLargestOfTheField) {
  const RodShape shape = rod_shape(link, coefficients.rods[0], speed, q);
  const VectorXd x = VectorXd::LinSpaced(401, 0, link.length);
  const RodField field = rod_field(link, coefficients.rods[0], speed, q, x, 1024);
  const double w = field.w.cwiseAbs().maxCoeff(), M = field.bending_moment.cwiseAbs().maxCoeff();
  EXPECT_GE(shape.deflection.max_abs, w * (1 - 1e-12));
  EXPECT_NEAR(shape.deflection.max_abs, w, 1e-4 * w);
  EXPECT_GE(shape.bending_moment.max_abs, M * (1 - 1e-12));
  EXPECT_NEAR(shape.bending_moment.max_abs, M, 1e-4 * M);
}

}  // namespace
}  // namespace hb
