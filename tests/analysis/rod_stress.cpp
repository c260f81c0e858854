// Axial force and stress of a rod, and its nearest resonance, against closed forms.
#include "hb/analysis/rod_stress.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hb/analysis/disturbance.hpp"
#include "hb/analysis/nearest_resonance.hpp"
#include "hb/analysis/steady.hpp"

namespace {

using namespace hb;
const std::string stressed_scenes = HB_SOURCE_DIR "/tests/scenes/";

// A four-bar whose coupler has a section.
Scene with_section() {
  const char* text =
      "gravity = 0\n[crank]\npivot = [0, 0]\nlength = 0.1\n[[dyad]]\non = \"crank\"\nbranch = 1\n"
      "coupler = { name = \"AB\", length = 0.3, mass = 0.4, elastic = { E = 2.1e11, section = { shape = \"rectangle\", "
      "width = 0.01, height = 0.02 } } }\n"
      "rocker = { name = \"R\", pivot = [0.3, 0], length = 0.12 }\n";
  return SceneSource(text, "with_section.toml", ".").with({});
}

TEST(RodStress, EulersLoadAndSectionAreThoseOfTheRod) {
  const Scene scene = with_section();
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const Body& rod = *body_at(linkage, coefficients.links[0]);
  const double EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment;
  const double M = 50;
  const RodStress at_rest = rod_stress(rod, coefficients.rods[0], coefficients.tail, 1e-9, M, 0.5);
  EXPECT_NEAR(at_rest.buckling_load, std::pow(std::numbers::pi / 0.3, 2) * EJ, 1e-9 * at_rest.buckling_load);
  EXPECT_TRUE(at_rest.height_known);
  EXPECT_NEAR(at_rest.bending, 6 * M / (0.01 * 0.02 * 0.02), 1e-9 * at_rest.bending);
  ASSERT_TRUE(at_rest.bending_error);
  EXPECT_NEAR(*at_rest.bending_error, at_rest.bending / 100, 1e-9 * at_rest.bending);
  EXPECT_LT(at_rest.axial, 1e-6 * at_rest.bending);
}

// N at joint 1 is the axial force that the rigid balance gives there; along the rod it changes by the mass behind it.
TEST(RodStress, TheAxialForceIsThatOfTheRigidBalanceAtBothEnds) {
  Request request;
  request.rpm = 600;
  request.modes = 2;
  const SteadyResult found = steady(read_scene(stressed_scenes + "six_link.toml"), request);
  for (const RodResult& rod : found.rods) {
    double push = 0, pull = 0;
    for (const JointForce& joint : found.forces->joints) {
      if (joint.name != rod.name + ".0" && joint.name != rod.name + ".1") continue;
      // LINK.1 acts on the link, LINK.0 is what the link passes on: both are N along the rod, tension positive.
      const Range range = fourier::range(joint.rigid, 0);
      push = std::max(push, -range.min.value);
      pull = std::max(pull, range.max.value);
    }
    ASSERT_TRUE(rod.stress);
    EXPECT_GT(rod.stress->force_error, 0);
    EXPECT_LT(rod.stress->force_error, 1e-8 * push);
    EXPECT_NEAR(rod.stress->compression, push, rod.stress->force_error) << rod.name;
    EXPECT_NEAR(rod.stress->tension, pull, rod.stress->force_error) << rod.name;
  }
}

// Forced oscillator with constant coefficients: resonances at omega_0/n, load applied slowly gives h/c.
TEST(NearestResonance, OfAnOscillatorIsTheNearestFractionOfItsFrequency) {
  HillSystem system;
  const double m = 2, c = 50, h = 3;
  system.mass = Eigen::MatrixXd::Constant(1, 1, m);
  system.damping = Eigen::MatrixXd::Constant(1, 1, 0.1);
  system.stiffness[0] = FourierSeries(1, 0);
  system.stiffness[0].c(0, 0) = c;
  system.load[0] = FourierSeries(1, 1);
  system.load[0].c(0, 1) = h / 2;
  const double omega = std::sqrt(c / m);
  for (const auto& [speed, order] : {std::pair(1.3, 4), std::pair(4.9, 1), std::pair(2.4, 2), std::pair(20.0, 1)}) {
    const std::optional<NearestResonance> nearest = nearest_resonance(system, speed);
    ASSERT_TRUE(nearest);
    EXPECT_EQ(nearest->order, order) << speed;
    EXPECT_NEAR(nearest->speed, omega / order, 1e-12 * omega);
    EXPECT_NEAR(nearest->frequency, omega, 1e-12 * omega);
    EXPECT_NEAR(*quasi_static_response(system, 1, speed), h / c, 1e-12);
  }
  system.stiffness[0].c(0, 0) = -c;
  EXPECT_FALSE(nearest_resonance(system, 1.3));
  system.load[0] = FourierSeries();
  EXPECT_FALSE(quasi_static_response(system, system.num_modes(), 1.3));
}

// Constant coefficients: one line, at the damped frequency.
TEST(DisturbanceLines, OfAnOscillatorAreItsOwnFrequency) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Constant(1, 1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, 0.2);
  system.stiffness[0] = FourierSeries(1, 0);
  system.stiffness[0].c(0, 0) = 4;
  const double speed = 0.7;
  const std::vector<DisturbanceLine> lines =
      disturbance_lines(system, speed, analyse_stability(system, speed).exponents.front());
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].frequency, std::sqrt(4 - 0.01), 1e-9);
}

// Inside the first tongue of Mathieu's equation a disturbance is, for a small variation, cos of half the speed.
TEST(DisturbanceLines, InTheFirstTongueOfMathieuLieAtHalfTheSpeed) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Constant(1, 1, 1);
  system.damping = Eigen::MatrixXd::Zero(1, 1);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c(0, 0) = 1;
  system.stiffness[0].c(0, 1) = 0.05;
  const Stability stability = analyse_stability(system, 2);
  ASSERT_EQ(stability.verdict, Verdict::unstable);
  const std::vector<DisturbanceLine> lines = disturbance_lines(system, 2, stability.exponents.front(), 1e-3);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_NEAR(lines[0].frequency, 1, 1e-9);
  EXPECT_NEAR(lines[1].frequency, 3, 1e-9);
  EXPECT_NEAR(lines[1].share, 0.1 / 2 / (9 - 1), 1e-3);
}

// Solved by another way where C is not symmetric, or negative: with 1 + cos(tau)/2 times a matrix the motion is its
// inverse times the load over that factor.
TEST(NearestResonance, QuasiStaticResponseOfAnyMatrixIsItsInverseTimesTheLoad) {
  const Eigen::Vector2d h(3, -1);
  for (const auto& [off, sign] : {std::pair(1.0, 1.0), std::pair(-2.0, 1.0), std::pair(1.0, -1.0)}) {
    SCOPED_TRACE(off * sign);
    Eigen::Matrix2d K;
    K << 5, off, 1, 4;
    K *= sign;
    HillSystem system;
    system.mass = Eigen::Matrix2d::Identity();
    system.damping = Eigen::Matrix2d::Zero();
    system.stiffness[0] = FourierSeries(4, 1);
    system.stiffness[0].c.col(0) = K.reshaped();
    system.stiffness[0].c.col(1) = 0.25 * K.reshaped();
    system.load[0] = FourierSeries(2, 0);
    system.load[0].c.col(0) = h;
    const double most = (K.inverse() * h).cwiseAbs().maxCoeff() / 0.5;  // at tau = pi
    ASSERT_TRUE(quasi_static_response(system, 2, 1));
    EXPECT_NEAR(*quasi_static_response(system, 2, 1), most, 1e-13 * most);
  }
}

// C changes its sign over the turn: there is no load applied slowly.
TEST(NearestResonance, AStiffnessThatVanishesHasNoQuasiStaticResponse) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Constant(1, 1, 1);
  system.damping = Eigen::MatrixXd::Zero(1, 1);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c(0, 0) = 1;
  system.stiffness[0].c(0, 1) = 1;
  system.load[0] = FourierSeries(1, 0);
  system.load[0].c(0, 0) = 1;
  EXPECT_FALSE(quasi_static_response(system, system.num_modes(), 1));
}

}  // namespace
