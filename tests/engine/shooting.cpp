#include "hb/engine/time/shooting.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hb/engine/time/floquet_product.hpp"
#include "hb/engine/time/marching.hpp"
#include "lib/constants.hpp"
#include "lib/rod/rod.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

FourierSeries series(std::initializer_list<std::complex<double>> coefficients) {
  FourierSeries result(1, static_cast<Eigen::Index>(coefficients.size()) - 1);
  Eigen::Index k = 0;
  for (const std::complex<double> c : coefficients) result.c(0, k++) = c;
  return result;
}

// x'' + c x' + (1.2 + 0.4 cos Omega t) x = cos Omega t
HillSystem mathieu(double c) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, c);
  system.stiffness[0] = series({1.2, 0.2});
  system.load[0] = series({0.0, 0.5});
  return system;
}

class EveryIntegrator : public testing::TestWithParam<Integrator> {};

TEST_P(EveryIntegrator, GivesThePublishedNumbersOfTheForcedMathieuEquation) {
  ShootingOptions options;
  options.integrator = GetParam();
  options.tolerance = 1e-8;
  const ShootingResult result = solve_by_shooting(time_domain_system(mathieu(0.1), 1), options);
  ASSERT_EQ(result.status, ShootingStatus::converged) << result.message;
  EXPECT_NEAR(result.orbit.q(0, 0), 4.65595993, 6e-9);
  EXPECT_NEAR(result.orbit.q1(0, 0), 2.71750522, 6e-9);
  ASSERT_EQ(result.exponents.size(), 2u);
  const std::complex<double> mu = std::exp(2 * pi * result.exponents[1].value);
  EXPECT_NEAR(mu.real(), 0.63284681, 6e-9);
  EXPECT_NEAR(std::abs(mu.imag()), 0.36468206, 6e-9);
  EXPECT_EQ(result.verdict, Verdict::stable);
}

// Multipliers negative real, inside the principal tongue; Liouville: the exponents add up to -c.
TEST_P(EveryIntegrator, CallsThePrincipalTongueUnstable) {
  for (const double Omega : {2.05, 2.15, 2.30}) {
    ShootingOptions options;
    options.integrator = GetParam();
    options.tolerance = 1e-7;
    const ShootingResult result = solve_by_shooting(time_domain_system(mathieu(0.1), Omega), options);
    ASSERT_EQ(result.exponents.size(), 2u);
    EXPECT_EQ(result.verdict, Verdict::unstable) << Omega;
    EXPECT_NEAR(std::abs(result.exponents[0].value.imag()), Omega / 2, 1e-12);
    EXPECT_NEAR(result.exponents[0].value.real() + result.exponents[1].value.real(), -0.1, 1e-7);
  }
}

// The error that a result claims covers its difference to a far tighter run; also where the turn is so short that the
// multipliers are near 1 and errors of the integration are amplified by 1e4.
TEST_P(EveryIntegrator, ItsErrorBarCoversTheTrueError) {
  for (const auto& [damping, Omega] : {std::pair{0.02, 1.7}, {0.1, 10.0}, {0.1, 100.0}}) {
    const TimeDomainSystem system = time_domain_system(mathieu(damping), Omega);
    ShootingOptions tight;
    tight.integrator = Integrator::collocation;
    tight.tolerance = 1e-13;
    const ShootingResult reference = solve_by_shooting(system, tight);
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-8, 1e-9}) {
      ShootingOptions options;
      options.integrator = GetParam();
      options.tolerance = tolerance;
      const ShootingResult result = solve_by_shooting(system, options);
      const double size = reference.orbit.q.cwiseAbs().maxCoeff();
      const double error = (result.orbit.q - reference.orbit.q).cwiseAbs().maxCoeff() / size;
      EXPECT_LE(error, result.q_error + reference.q_error) << tolerance << " at " << Omega;
      EXPECT_LE(std::abs(result.growth_rate - reference.growth_rate), result.growth_error + reference.growth_error)
          << tolerance << " at " << Omega;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shooting, EveryIntegrator,
                         testing::Values(Integrator::adams, Integrator::bdf, Integrator::collocation),
                         [](const auto& parameter) {
                           return parameter.param == Integrator::adams ? "Adams"
                                  : parameter.param == Integrator::bdf ? "Bdf"
                                                                       : "Collocation";
                         });

// x'' + 0.1 x' + 1.2 x = cos t: x = Re e^{it}/(0.2 + 0.1 i), exponents -0.05 +- i sqrt(1.2 - 0.05^2).
TEST(Shooting, CollocationKeepsThirteenDigits) {
  HillSystem oscillator = mathieu(0.1);
  oscillator.stiffness[0] = series({1.2});
  ShootingOptions options;
  options.integrator = Integrator::collocation;
  const ShootingResult result = solve_by_shooting(time_domain_system(oscillator, 1), options);
  const std::complex<double> amplitude = 1.0 / std::complex<double>(0.2, 0.1);
  const Eigen::Index N = result.orbit.q.cols();
  for (Eigen::Index j = 0; j < N; ++j) {
    const std::complex<double> x =
        amplitude * std::polar(1.0, 2 * pi * static_cast<double>(j) / static_cast<double>(N));
    EXPECT_NEAR(result.orbit.q(0, j), x.real(), 1e-13 * std::abs(amplitude));
    EXPECT_NEAR(result.orbit.q1(0, j), -x.imag(), 1e-13 * std::abs(amplitude));
  }
  EXPECT_LE(result.q_error, 5e-13);
  EXPECT_NEAR(result.growth_rate, -0.05, 1e-14);
  EXPECT_LE(result.growth_error, 1e-13);
}

// The published six-link numbers, every mode; peaks of 128 samples lie below the true peaks by less than their
// spacing's curvature allows, so the Fourier coefficients of the samples are compared instead.
TEST(Shooting, GivesTheReferenceOfTheSixLinkMechanismFromTheKinematics) {
  std::ifstream file(std::string(HB_SOURCE_DIR) + "/tests/reference/six_link.json");
  const nlohmann::json reference = nlohmann::json::parse(file);
  int compared = 0;
  for (const nlohmann::json& entry : reference["cases"]) {
    const double J = entry["J"], rpm = entry["rpm"];
    const int modes = entry["modes"];
    if (modes > 5) continue;
    const Linkage linkage = six_link::linkage({.J = J});
    const double Omega = 2 * pi * rpm / 60;
    for (const int link : elastic_links(linkage)) {
      const std::string name = body_name(linkage, link);
      if (!entry["rods"].contains(name)) continue;
      SCOPED_TRACE(name + " J=" + std::to_string(J) + " rpm=" + std::to_string(rpm));
      ShootingOptions options;
      options.integrator = Integrator::collocation;
      const ShootingResult result = solve_by_shooting(time_domain_rod(linkage, link, modes, Omega), options);
      ASSERT_FALSE(result.orbit.q.size() == 0) << result.message;
      const FourierSeries q = fourier::analyse(result.orbit.q);
      const nlohmann::json& rod = entry["rods"][name];
      double size = 0;
      for (const double peak : rod["max_abs_q"]) size = std::max(size, peak);
      for (int i = 0; i < modes; ++i)
        for (std::size_t k = 0; k < rod["fourier"][static_cast<std::size_t>(i)].size(); ++k) {
          const nlohmann::json& c = rod["fourier"][static_cast<std::size_t>(i)][k];
          const std::complex<double> expected(c[0], c[1]);
          EXPECT_LE(std::abs(q.c(i, static_cast<Eigen::Index>(k)) - expected), 1e-9 * size) << i << " " << k;
        }
      if (rod.contains("exponents") && !rod["exponents"].empty()) {
        EXPECT_NEAR(result.growth_rate, static_cast<double>(rod["exponents"][0][0]),
                    1e-8 * std::max(1.0, std::abs(result.growth_rate)));
      }
      ++compared;
    }
  }
  EXPECT_GE(compared, 8);
}

TEST(Shooting, CvodeGivesTheSixLinkMechanismAtTheSpeedOfTheFigures) {
  const Linkage linkage = six_link::linkage();
  const double Omega = 2 * pi * 1500 / 60;
  ShootingOptions tight;
  tight.integrator = Integrator::collocation;
  const ShootingResult reference = solve_by_shooting(time_domain_rod(linkage, 1, 2, Omega), tight);
  ShootingOptions options;
  options.tolerance = 1e-6;
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf}) {
    options.integrator = integrator;
    const ShootingResult result = solve_by_shooting(time_domain_rod(linkage, 1, 2, Omega), options);
    EXPECT_EQ(result.status, ShootingStatus::converged) << result.message;
    EXPECT_LE((result.orbit.q - reference.orbit.q).cwiseAbs().maxCoeff(),
              result.q_error * reference.orbit.q.cwiseAbs().maxCoeff());
    EXPECT_NEAR(result.growth_rate, reference.growth_rate, result.growth_error + reference.growth_error);
  }
}

TEST(Shooting, ResonanceWithoutDampingIsSingular) {
  HillSystem oscillator = mathieu(0);
  oscillator.stiffness[0] = series({4.0});
  const ShootingResult result = solve_by_shooting(time_domain_system(oscillator, 2));
  EXPECT_EQ(result.status, ShootingStatus::singular);
  EXPECT_FALSE(result.message.empty());
}

TEST(Shooting, WorkBeyondTheTimeLimitIsRefusedBeforeItIsBegun) {
  HillSystem stiff = mathieu(1e-3);
  stiff.stiffness[0] = series({1e16, 0.2});  // 1e8 oscillations a turn
  for (const Integrator integrator :
       {Integrator::automatic, Integrator::adams, Integrator::bdf, Integrator::collocation}) {
    ShootingOptions options;
    options.integrator = integrator;
    options.time_limit = 5;
    const ShootingResult result = solve_by_shooting(time_domain_system(stiff, 1), options);
    EXPECT_EQ(result.status, ShootingStatus::too_expensive) << result.message;
    EXPECT_GT(result.predicted_seconds, 5);
    EXPECT_EQ(result.orbit.q.size(), 0);
  }
}

TEST(Marching, FromRestSettlesOnThePeriodicSolution) {
  const TimeDomainSystem system = time_domain_system(mathieu(0.1), 1);
  const MarchingResult result = march_from_rest(system, {.tolerance = 1e-8, .growth_rate = -0.05});
  ASSERT_EQ(result.status, ShootingStatus::converged) << result.message;
  EXPECT_NEAR(result.orbit.q(0, 0), 4.65595993, 5 * result.q_error);
  EXPECT_GT(result.turns, 20);
  EXPECT_NEAR(result.orbit.q1(0, 0), 2.71750522, 5 * result.q_error);
}

// Many turns to one oscillation: the state changes little in a turn though it is far from periodic, and now and then
// hardly at all.
TEST(Marching, ItsErrorBarCoversTheTrueErrorOfASlowTransient) {
  const TimeDomainSystem system = time_domain_system(mathieu(0.1), 10);
  ShootingOptions tight;
  tight.integrator = Integrator::collocation;
  const ShootingResult reference = solve_by_shooting(system, tight);
  const double size = reference.orbit.q.cwiseAbs().maxCoeff();
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf})
    for (const double growth_rate : {-0.05, 0.0})  // known, not known
      for (const double tolerance : {1e-3, 1e-5, 1e-6}) {
        const MarchingResult result =
            march_from_rest(system, {.tolerance = tolerance, .integrator = integrator, .growth_rate = growth_rate});
        ASSERT_EQ(result.status, ShootingStatus::converged) << result.message;
        EXPECT_LE((result.orbit.q - reference.orbit.q).cwiseAbs().maxCoeff(), result.q_error * size)
            << tolerance << " growth rate " << growth_rate;
      }
}

// CVODE's own errors keep the state from repeating to the tolerance: it settles all the same, and its error bar says
// so.
TEST(Marching, SettlesWhereTheIntegratorIsLooserThanTheToleranceAsked) {
  const TimeDomainSystem system = time_domain_system(mathieu(0.1), 1);
  const MarchingResult result = march_from_rest(
      system, {.tolerance = 1e-9, .integrator_tolerance = 1e-5, .time_limit = 10, .growth_rate = -0.05});
  ASSERT_EQ(result.status, ShootingStatus::converged) << result.message;
  EXPECT_NEAR(result.orbit.q(0, 0), 4.65595993, 4.7 * result.q_error);
  EXPECT_GT(result.q_error, 1e-9);
}

TEST(Marching, OfAnUnstableMotionSaysThatItNeverSettles) {
  const TimeDomainSystem system = time_domain_system(mathieu(0.1), 2.15);
  EXPECT_EQ(march_from_rest(system, {.growth_rate = 0.04}).status, ShootingStatus::not_reached);
  const MarchingResult unknown = march_from_rest(system, {.tolerance = 1e-6});
  EXPECT_EQ(unknown.status, ShootingStatus::not_reached);
  EXPECT_NE(unknown.message.find("grows"), std::string::npos) << unknown.message;
}

TEST(FloquetProduct, KeepsMultipliersFarBelowUnderflowAndFarAboveOverflow) {
  // Rotation by 0.3 with decay e^-20 per segment beside growth e^15, turned by a fixed orthogonal matrix.
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.3).toRotationMatrix();
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(3, 3);
  map.topLeftCorner(2, 2) = std::exp(-20.0) * turn;
  map(2, 2) = std::exp(-5.0);
  const Eigen::MatrixXd basis = (Eigen::MatrixXd(3, 3) << 1, 2, 0, 0, 1, 1, 1, 0, 3).finished();
  const SegmentMap segment{basis * map * basis.inverse(), Eigen::VectorXd::Zero(3)};
  const LogMultipliers result = log_multipliers(std::vector<SegmentMap>(100, segment), 1e-12);
  ASSERT_EQ(result.values.size(), 3u);
  EXPECT_NEAR(result.values[0].value.real(), -500, 1e-9);
  EXPECT_NEAR(result.values[1].value.real(), -2000, 1e-5);  // e^-15 below the leading one: rounding of the map counts
  EXPECT_NEAR(std::abs(result.values[1].value.imag()), std::abs(std::remainder(30.0, 2 * pi)), 1e-5);
}

TEST(FloquetProduct, CyclicSolveIsStableForGrowthAndDecayTogether) {
  Eigen::MatrixXd map = Eigen::Vector2d(std::exp(-10.0), std::exp(10.0)).asDiagonal();
  const SegmentMap segment{map, Eigen::Vector2d(1, -1)};
  const CyclicSolution solution = solve_cyclic(std::vector<SegmentMap>(60, segment));
  // Fixed point of every segment: y = 1/(1 - e^-10), -1/(1 - e^10).
  for (const Eigen::VectorXd& y : solution.states) {
    EXPECT_NEAR(y(0), 1 / -std::expm1(-10.0), 1e-14);
    EXPECT_NEAR(y(1), -1 / -std::expm1(10.0), 1e-14);
  }
}

}  // namespace
}  // namespace hb
