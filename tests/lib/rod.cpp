#include "lib/rod/rod.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/constants.hpp"
#include "lib/rod/field_change.hpp"
#include "tests/support/dense_steady_state.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;
using Complex = std::complex<double>;
// A rod on a constant load: f0 = load, nothing else.
RodCoefficients constant_load(double f0, double f1) {
  RodCoefficients rod;
  for (FourierSeries& f : rod.f) f = FourierSeries(5, 0);
  rod.f[0].c(0, 0) = f0;
  rod.f[0].c(1, 0) = f1;
  return rod;
}

const Body& rod_AB() {
  static const Body body = *body_at(six_link::linkage(), 1);
  return body;
}

TEST(RodCoefficients, DecayToRoundingAndSayWhatIsLeft) {
  const LinkageCoefficients coefficients = linkage_coefficients(six_link::linkage());
  EXPECT_EQ(coefficients.links, (std::vector<int>{1, 3}));
  EXPECT_LE(coefficients.num_samples, 128);
  EXPECT_LE(coefficients.tail, 1e-14);
  for (const RodCoefficients& rod : coefficients.rods)
    for (const FourierSeries& f : rod.f) EXPECT_LE(f.num_harmonics(), 32);
}

TEST(RodCoefficients, AreThoseOfEachCrankAngle) {
  const Linkage six = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(six);
  for (double tau = 0.05; tau < 2 * pi; tau += 0.31) {
    const std::vector<BodyMotion> motion = motion_at(six, tau);
    const std::array<std::vector<BodyLoad>, 3> loads = rigid_loads(six, motion, tau);
    const std::array<MechanismForces, 3> forces = {balance(six, motion, loads[0]), balance(six, motion, loads[1]),
                                                   balance(six, motion, loads[2])};
    for (std::size_t r = 0; r < 2; ++r) {
      const Eigen::Matrix<double, 5, 3> f = rod_coefficients_at(six, motion, forces, coefficients.links[r]);
      for (int p = 0; p < 3; ++p) {
        const FourierSeries& series = coefficients.rods[r].f[static_cast<std::size_t>(p)];
        const Eigen::VectorXd here = fourier::evaluate(series, tau);
        for (int k = 0; k < 5; ++k) EXPECT_NEAR(here(k), f(k, p), 100 * eps * fourier::wiener_norm(series, k));
      }
    }
  }
}

// Slider force F cos 100 tau: aliased to nothing on 50 or 100 samples.
TEST(RodCoefficients, KeepTheHarmonicsOfAnAppliedForce) {
  Linkage linkage = six_link::linkage();
  Slider piston;
  piston.name = "piston";
  piston.mass = 0.5;
  piston.guide = {570, 40};
  piston.force = FourierSeries(1, 100);
  piston.force.c(0, 100) = 1e4;
  linkage.dyads[1].closing = piston;
  linkage.dyads[1].coupler.length = 500;
  linkage.dyads[1].branch = 1;
  ASSERT_FALSE(find_obstruction(linkage).has_value());
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  EXPECT_GE(coefficients.rods[1].f[0].num_harmonics(), 100);
  const double tau = 0.77;
  const std::vector<BodyMotion> motion = motion_at(linkage, tau);
  const auto loads = rigid_loads(linkage, motion, tau);
  const std::array<MechanismForces, 3> forces = {balance(linkage, motion, loads[0]), balance(linkage, motion, loads[1]),
                                                 balance(linkage, motion, loads[2])};
  const double f4 = rod_coefficients_at(linkage, motion, forces, 3)(4, 0);
  EXPECT_NEAR(fourier::evaluate(coefficients.rods[1].f[0], tau)(4), f4,
              1e-13 * fourier::wiener_norm(coefficients.rods[1].f[0], 4));
}

TEST(Ritz, PowersOfTheSpeedThatAreZeroAreLeftEmpty) {
  const Linkage undamped = six_link::linkage({.internal_damping = 0, .external_damping = 0});
  const LinkageCoefficients coefficients = linkage_coefficients(undamped);
  const HillSystem system = ritz_system(*body_at(undamped, 1), coefficients.rods[0], 3);
  EXPECT_EQ(system.stiffness[1].c.size(), 0);
  EXPECT_EQ(system.load[1].c.size(), 0);
  EXPECT_TRUE(system.damping.isZero(0));
  validate(system);
}

// w = 5 p l^4 / 384 EJ, M = p l^2 / 8 at the middle, whatever the number of modes kept, here with p = -EJ f0.
TEST(RodShape, ConstantLoadGivesTheBeamFormulaWithAnyNumberOfModes) {
  const Body& rod = rod_AB();
  const double l = rod.length, EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment, f0 = 3e-9;
  for (const Eigen::Index I : {1, 2, 5, 12, 60}) {
    FourierSeries q(I, 2);
    for (Eigen::Index i = 1; i <= I; i += 2)
      q.c(i - 1, 0) = -4 / (pi * static_cast<double>(i)) * f0 / std::pow(static_cast<double>(i) * pi / l, 4);
    const RodShape shape = rod_shape(rod, constant_load(f0, 0), 30, q);
    EXPECT_NEAR(shape.deflection.max_abs, 5 * f0 * std::pow(l, 4) / 384, 100 * eps * f0 * std::pow(l, 4) / 77) << I;
    EXPECT_NEAR(shape.bending_moment.max_abs, EJ * f0 * l * l / 8, 100 * eps * EJ * f0 * l * l) << I;
    EXPECT_NEAR(shape.deflection.x, l / 2, 1e-6 * l);
  }
}

// p = -f1 x: w'' = f1 (x l^2 - x^3)/6, largest at l/sqrt 3: f1 l^3 / (9 sqrt 3).
TEST(RodShape, LinearLoadHasItsLargestMomentOffTheMiddle) {
  const Body& rod = rod_AB();
  const double l = rod.length, EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment, f1 = 3e-11;
  FourierSeries q(4, 0);
  for (Eigen::Index i = 1; i <= 4; ++i)
    q.c(i - 1, 0) = (i % 2 == 0 ? 1 : -1) * 2 * l / (pi * static_cast<double>(i)) * f1 /
                    std::pow(static_cast<double>(i) * pi / l, 4);
  const RodShape shape = rod_shape(rod, constant_load(0, f1), 30, q);
  const double wanted = EJ * f1 * l * l * l / (9 * std::sqrt(3.0));
  EXPECT_NEAR(shape.bending_moment.max_abs, wanted, 1e-13 * wanted);
  EXPECT_NEAR(shape.bending_moment.x, l / std::sqrt(3.0), 1e-6 * l);
}

// The tail's definition term by term: i > I, (1 + i n Omega alpha_c)(i pi/l)^4 q_in = (h - sum_k c_ik q_k)_in, with the
// c_ik of a larger Ritz system; the sum's own remainder beyond i = L falls like 1/L^5 in w
// and 1/L^3 in w''.
TEST(RodShape, TailIsTheSumOfTheQuasiStaticModes) {
  const Linkage six = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(six);
  const double Omega = 1500 * pi / 30;
  constexpr Eigen::Index L = 60, N = 128;
  for (const Eigen::Index I : {1, 3, 5}) {
    const Body& rod = *body_at(six, 1);
    const double l = rod.length, EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment;
    const FourierSeries q = dense_steady_state(ritz_system(rod, coefficients.rods[0], I), Omega, 24);
    const HillSystem large = ritz_system(rod, coefficients.rods[0], L);
    const Eigen::MatrixXd C = fourier::synthesise(stiffness_at(large, Omega), N);
    const Eigen::MatrixXd q_samples = fourier::synthesise(q, N);
    Eigen::MatrixXd load = fourier::synthesise(load_at(large, Omega), N);
    for (Eigen::Index j = 0; j < N; ++j) load.col(j) -= C.col(j).reshaped(L, L).leftCols(I) * q_samples.col(j);
    FourierSeries modes = fourier::analyse(load);
    for (Eigen::Index n = 0; n <= modes.num_harmonics(); ++n)
      for (Eigen::Index i = 0; i < L; ++i)
        modes.c(i, n) /= std::pow(static_cast<double>(i + 1) * pi / l, 4) *
                         Complex(1, static_cast<double>(n) * Omega * rod.elastic->internal_damping);
    modes.c.topRows(I) = fourier::resized(q, modes.num_harmonics()).c;

    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(21, 0, l);
    Eigen::MatrixXd w(21, L), moment(21, L);
    for (Eigen::Index i = 0; i < L; ++i) {
      const double kappa = static_cast<double>(i + 1) * pi / l;
      w.col(i) = (kappa * x).array().sin();
      moment.col(i) = -EJ * kappa * kappa * w.col(i);
    }
    const Eigen::MatrixXd time = fourier::synthesise(modes, N);
    const RodField field = rod_field(rod, coefficients.rods[0], Omega, q, x, N);
    const auto difference = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
      return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
    };
    const auto error_w = [&](Eigen::Index n) { return difference(w.leftCols(n) * time.topRows(n), field.w); };
    const auto error_moment = [&](Eigen::Index n) {
      return difference(moment.leftCols(n) * time.topRows(n), field.bending_moment);
    };
    EXPECT_LE(error_w(L), 3e-9) << I;
    EXPECT_LE(error_w(L), 0.02 * error_w(L / 3)) << I;
    EXPECT_LE(error_moment(L), 2e-5) << I;
    EXPECT_LE(error_moment(L), 0.12 * error_moment(L / 3)) << I;
    EXPECT_GE(error_moment(I), 50 * error_moment(L)) << I;
  }
}

TEST(RodShape, ShapeSatisfiesThePinnedEnds) {
  const LinkageCoefficients coefficients = linkage_coefficients(six_link::linkage());
  const Body& rod = rod_AB();
  const FourierSeries q = dense_steady_state(ritz_system(rod, coefficients.rods[0], 3), 100, 20);
  const RodField field =
      rod_field(rod, coefficients.rods[0], 100, q, Eigen::Vector3d(0, rod.length / 2, rod.length), 9);
  for (const Eigen::Index end : {0, 2}) {
    EXPECT_LE(field.w.row(end).cwiseAbs().maxCoeff(), 1e-13 * field.w.cwiseAbs().maxCoeff());
    EXPECT_LE(field.bending_moment.row(end).cwiseAbs().maxCoeff(), 1e-12 * field.bending_moment.cwiseAbs().maxCoeff());
  }
}

TEST(RodShape, FieldsAtFewAnglesAreThoseOfMany) {
  const LinkageCoefficients coefficients = linkage_coefficients(six_link::linkage());
  const Body& rod = rod_AB();
  const FourierSeries q = dense_steady_state(ritz_system(rod, coefficients.rods[0], 3), 100, 20);
  const Eigen::Vector2d x(rod.length / 3, rod.length / 2);
  constexpr Eigen::Index many = 2 * 2 * 3 * 5 * 7;
  const RodField all = rod_field(rod, coefficients.rods[0], 100, q, x, many);
  for (const Eigen::Index few : {1, 2, 3, 4, 5, 6, 7, 10, 14, 42, 84}) {
    const RodField field = rod_field(rod, coefficients.rods[0], 100, q, x, few);
    const auto same = Eigen::seqN(0, few, many / few);
    EXPECT_LE((field.w - all.w(Eigen::all, same)).cwiseAbs().maxCoeff(), 1e-14 * all.w.cwiseAbs().maxCoeff()) << few;
    EXPECT_LE((field.bending_moment - all.bending_moment(Eigen::all, same)).cwiseAbs().maxCoeff(),
              1e-13 * all.bending_moment.cwiseAbs().maxCoeff())
        << few;
  }
}

TEST(RodShape, ChangeIsTheLargestDifferenceOfTwoFields) {
  const LinkageCoefficients coefficients = linkage_coefficients(six_link::linkage());
  const Body& rod = rod_AB();
  const auto response = [&](Eigen::Index modes, Eigen::Index harmonics) {
    return dense_steady_state(ritz_system(rod, coefficients.rods[0], modes), 100, harmonics);
  };
  const FourierSeries q = response(3, 20), finer = response(9, 24);
  constexpr Eigen::Index places = 36, angles = 960;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(places + 1, 0, rod.length);
  const RodField some = rod_field(rod, coefficients.rods[0], 100, q, x, angles),
                 all = rod_field(rod, coefficients.rods[0], 100, finer, x, angles);
  const auto change = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
  };
  const FieldChange found = field_change(rod, coefficients.rods[0], 100, q, finer);
  const double w = change(some.w, all.w), moment = change(some.bending_moment, all.bending_moment);
  constexpr double told = 0.03;  // by the harmonics that tell, at four angles each
  EXPECT_NEAR(found.deflection, w, told * w);
  EXPECT_NEAR(found.bending_moment, moment, told * moment);
  EXPECT_EQ(field_change(rod, coefficients.rods[0], 100, q, q).deflection, 0);
  FourierSeries wrong = finer;
  wrong.c(0, 1) = hb::nan;
  EXPECT_TRUE(std::isnan(field_change(rod, coefficients.rods[0], 100, q, wrong).deflection));
}

TEST(RodShape, PeaksAreTrueMaximaOfTheField) {
  const Linkage six = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(six);
  for (const double rpm : {300.0, 1500.0})
    for (std::size_t r = 0; r < 2; ++r) {
      const double Omega = rpm * pi / 30;
      const Body& rod = *body_at(six, coefficients.links[r]);
      const FourierSeries q = dense_steady_state(ritz_system(rod, coefficients.rods[r], 3), Omega, 26);
      const RodShape shape = rod_shape(rod, coefficients.rods[r], Omega, q);
      const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(501, 0, rod.length);
      const RodField field = rod_field(rod, coefficients.rods[r], Omega, q, x, 2000);
      const double w = field.w.cwiseAbs().maxCoeff(), moment = field.bending_moment.cwiseAbs().maxCoeff();
      // A grid misses the top by curvature times half a step squared, over two.
      EXPECT_GE(shape.deflection.max_abs, w * (1 - 10 * eps));
      EXPECT_LE(shape.deflection.max_abs, w * (1 + 1e-3));
      EXPECT_GE(shape.bending_moment.max_abs, moment * (1 - 10 * eps));
      EXPECT_LE(shape.bending_moment.max_abs, moment * (1 + 1e-3));
      const RodPeak alone = largest_deflection(rod, coefficients.rods[r], Omega, q);
      EXPECT_EQ(alone.max_abs, shape.deflection.max_abs);
      EXPECT_EQ(alone.x, shape.deflection.x);
      EXPECT_EQ(alone.crank_angle, shape.deflection.crank_angle);
    }
}

TEST(RodShape, FewModesWithTailGiveTheShapeOfMany) {
  const Linkage six = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(six);
  const double Omega = 300 * pi / 30;
  for (std::size_t r = 0; r < 2; ++r) {
    const Body& rod = *body_at(six, coefficients.links[r]);
    const auto shape = [&](Eigen::Index I) {
      const FourierSeries q = dense_steady_state(ritz_system(rod, coefficients.rods[r], I), Omega, 18);
      return rod_shape(rod, coefficients.rods[r], Omega, q);
    };
    const RodShape few = shape(3), more = shape(5), many = shape(14);
    const auto error = [](const RodPeak& a, const RodPeak& b) { return std::abs(a.max_abs / b.max_abs - 1); };
    EXPECT_LE(error(few.deflection, many.deflection), 1e-6);
    EXPECT_LE(error(more.deflection, many.deflection), 1e-7);
    EXPECT_LE(error(few.bending_moment, many.bending_moment), 3e-5);
    EXPECT_LE(error(more.bending_moment, many.bending_moment), 5e-6);
  }
}

}  // namespace
