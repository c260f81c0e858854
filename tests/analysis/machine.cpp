// What a machine's designer reads beside joint forces, against closed forms and direct sums.
#include <gtest/gtest.h>

#include <cmath>

#include "hb/analysis/bearing_load.hpp"
#include "hb/analysis/drive.hpp"
#include "hb/analysis/slider_motion.hpp"
#include "hb/analysis/static_deflection.hpp"
#include "hb/analysis/steady.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "lib/constants.hpp"
#include "lib/linkage/kinematics.hpp"

namespace {

using namespace hb;
using Complex = std::complex<double>;
const std::string machine_scenes = HB_SOURCE_DIR "/tests/scenes/";

SteadyResult steady_of(const char* name, double rpm) {
  Request request;
  request.rpm = rpm;
  request.modes = 3;
  return steady(read_scene(machine_scenes + name), request);
}

const FourierSeries& force_at(const SteadyResult& found, const std::string& name) {
  for (const JointForce& joint : found.forces->joints)
    if (joint.name == name) return joint.elastic;
  throw std::runtime_error(name);
}

// Two ways that share no sum: body loads, and the forces at pivots, guide and motor that the dyads' balances gave.
TEST(FrameForces, AreTheSumOverPivotsGuidesMotorAndAppliedForces) {
  const Scene scene = read_scene(machine_scenes + "slider_crank.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  const SteadyResult found = steady_of("slider_crank.toml", 2500);
  const FrameForces& frame = found.forces->frame;
  const auto& slider = std::get<Slider>(linkage.dyads[0].closing);
  double size = 0, moment_size = 0;
  for (int j = 0; j < 40; ++j) {
    const double tau = 2 * pi * j / 40;
    const std::vector<BodyMotion> motion = motion_at(linkage, tau);
    const Eigen::VectorXd pivot = fourier::evaluate(force_at(found, "crank.pivot"), tau);
    const Complex at_pivot = Complex(pivot(0), pivot(1)) * motion[1].e;
    const double normal = fourier::evaluate(force_at(found, slider.name + ".guide"), tau)(0);
    const Complex along = std::polar(1.0, slider.direction);
    const Complex at_guide = normal * Complex(0, 1) * along + fourier::evaluate(slider.force, tau)(0) * along;
    const double torque = fourier::evaluate(found.forces->torque, tau)(0);
    const Eigen::VectorXd on_frame = fourier::evaluate(frame.elastic, tau);
    const Complex arm = motion[2].z - linkage.crank.pivot;
    size = std::max(size, std::abs(at_pivot));
    EXPECT_NEAR(on_frame(0), -(at_pivot + at_guide).real(), 1e-9 * size);
    EXPECT_NEAR(on_frame(1), -(at_pivot + at_guide).imag(), 1e-9 * size);
    moment_size = std::max(moment_size, std::abs(torque));
    EXPECT_NEAR(on_frame(2), -torque - (std::conj(arm) * at_guide).imag(), 1e-9 * moment_size) << tau;
  }
}

TEST(FrameForces, OfTheSixLinkMechanismAreThoseAtItsThreePivots) {
  const Scene scene = read_scene(machine_scenes + "six_link.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  const SteadyResult found = steady_of("six_link.toml", 900);
  const FrameForces& frame = found.forces->frame;
  for (int j = 0; j < 20; ++j) {
    const double tau = 2 * pi * j / 20;
    const std::vector<BodyMotion> motion = motion_at(linkage, tau);
    Complex sum = 0;
    for (const auto& [name, body] :
         {std::pair("crank.pivot", 1), std::pair("O2BC.pivot", 1), std::pair("O3D.pivot", 3)}) {
      const Eigen::VectorXd force = fourier::evaluate(force_at(found, name), tau);
      sum += Complex(force(0), force(1)) * motion[static_cast<std::size_t>(body)].e;
    }
    const Eigen::VectorXd on_frame = fourier::evaluate(frame.elastic, tau);
    EXPECT_NEAR(std::abs(Complex(on_frame(0), on_frame(1)) + sum), 0, 1e-8 * std::abs(sum)) << tau;
  }
}

TEST(BearingLoad, IsTheLargestLengthOverTheTurn) {
  const SteadyResult found = steady_of("six_link.toml", 900);
  for (const BearingLoad& load : bearing_loads(*found.forces)) {
    const FourierSeries& force = force_at(found, load.joint);
    const Eigen::RowVectorXd length = fourier::synthesise(force, 1 << 14).colwise().norm();
    EXPECT_NEAR(load.elastic.value, length.maxCoeff(), 1e-6 * load.elastic.value) << load.joint;
    EXPECT_GE(load.elastic.value, (1 - 1e-12) * length.maxCoeff());
    EXPECT_NEAR(fourier::evaluate(force, load.elastic.crank_angle).norm(), load.elastic.value,
                1e-9 * load.elastic.value);
    EXPECT_NEAR(load.mean, length.mean(), 1e-6 * load.mean);
    EXPECT_NEAR(load.rms * load.rms, length.squaredNorm() / (1 << 14), 1e-9 * load.rms * load.rms);
  }
}

// T = a + b cos(k tau): rms^2 = a^2 + b^2/2, stored energy b/k sin(k tau).
TEST(Drive, OfOneHarmonicIsItsClosedForm) {
  const double a = 3, b = 5, speed = 20;
  const int k = 4;
  FourierSeries torque(1, k);
  torque.c(0, 0) = a;
  torque.c(0, k) = b / 2;
  const Drive drive = drive_of(torque, speed);
  EXPECT_NEAR(drive.mean, a, 1e-14);
  EXPECT_NEAR(drive.rms, std::sqrt(a * a + b * b / 2), 1e-13);
  EXPECT_NEAR(drive.mean_power, a * speed, 1e-12);
  EXPECT_NEAR(drive.largest_power, (a + b) * speed, 1e-11);
  EXPECT_NEAR(drive.smallest_power, (a - b) * speed, 1e-11);
  EXPECT_NEAR(drive.energy_fluctuation, 2 * b / k, 1e-13);
  EXPECT_NEAR(speed_fluctuation(drive, 0.5, speed), 2 * b / k / (0.5 * speed * speed), 1e-15);
}

// s = r cos tau + sqrt(l^2 - (r sin tau - h)^2) for a guide at height h.
TEST(SliderMotion, OfASliderCrankIsItsClosedForm) {
  const Scene scene = read_scene(machine_scenes + "slider_crank.toml");
  const double r = 40, l = 150, h = 5, speed = 100;
  const std::vector<SliderMotion> sliders = slider_motions(std::get<Linkage>(scene.model), speed);
  ASSERT_EQ(sliders.size(), 1u);
  EXPECT_EQ(sliders[0].name, "piston");
  for (const double tau : {0.0, 0.4, 2.0, 3.3, 5.0}) {
    const double u = r * std::sin(tau) - h, v = r * std::cos(tau), root = std::sqrt(l * l - u * u);
    EXPECT_NEAR(fourier::evaluate(sliders[0].position, tau)(0), v + root, 1e-11 * l);
    const double slope = -r * std::sin(tau) - u * v / root;
    EXPECT_NEAR(fourier::evaluate(sliders[0].velocity(), tau)(0), speed * slope, 1e-9 * speed * r);
    const double second = -v + (-(v * v) + u * r * std::sin(tau)) / root - u * u * v * v / (root * root * root);
    EXPECT_NEAR(fourier::evaluate(sliders[0].acceleration(), tau)(0), speed * speed * second, 1e-8 * speed * speed * r);
  }
}

// A rod so stiff that its own axial load does nothing: 5 mu g l^4/(384 EJ) where it lies level.
TEST(StaticDeflection, OfALevelRodIsThatOfABeamUnderItsWeight) {
  const char* text =
      "[crank]\npivot = [0, 0]\nlength = 0.1\n[[dyad]]\non = \"crank\"\nbranch = 1\ncoupler = { name = \"rod\", length "
      "= "
      "0.5, elastic = { material = \"steel\", section = { shape = \"rectangle\", width = 0.02, height = 0.02 } } }\n"
      "slider = { name = \"piston\", guide = [0, 0] }\n";
  const Scene scene = SceneSource(text, "rod.toml", ".").with({});
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const Body& rod = linkage.dyads[0].coupler;
  const std::optional<StaticDeflection> found = static_deflection(rod, coefficients.rods[0], 5);
  ASSERT_TRUE(found);
  const double EJ = rod.elastic->youngs_modulus * rod.elastic->second_moment;
  const double exact = 5 * rod.mass / rod.length * linkage.gravity * std::pow(rod.length, 4) / (384 * EJ);
  EXPECT_NEAR(found->peak.max_abs, exact, 1e-4 * exact);
  EXPECT_LE(found->error, 1e-3 * exact);
  EXPECT_NEAR(found->peak.x, rod.length / 2, 1e-3 * rod.length);
  EXPECT_NEAR(std::abs(std::sin(found->peak.crank_angle)), 0, 1e-2);
}

// Against every place of a fine grid over rod and turn.
TEST(StressCycle, IsTheWorstOfAllPlacesFibresAndAngles) {
  const char* text =
      "[crank]\npivot = [0, 0]\nlength = 0.05\n[[dyad]]\non = \"crank\"\nbranch = 1\ncoupler = { name = \"rod\", "
      "length = "
      "0.3, elastic = { material = \"steel\", damping_ratio = 0.02, section = { shape = \"rectangle\", width = 0.016, "
      "height = 0.008 } } }\nslider = { name = \"piston\", mass = 0.3, guide = [0, 0] }\n";
  const Scene scene = SceneSource(text, "rod.toml", ".").with({});
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const Body& rod = linkage.dyads[0].coupler;
  Request request;
  request.rpm = 3000;
  const SteadyResult found = steady(scene, request);
  const RodResult& result = found.rods[0];
  const StressCycle cycle = stress_cycle(rod, coefficients.rods[0], found.speed, result.steady->q, result.more_modes,
                                         result.steady->error_bound);
  constexpr Eigen::Index points = 401, N = 4096;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(points, 0, rod.length);
  const Eigen::MatrixXd M = rod_field(rod, coefficients.rods[0], found.speed, result.steady->q, x, N).bending_moment;
  double largest = 0, widest = 0, mean = 0;
  for (Eigen::Index i = 0; i < points; ++i)
    for (const int side : {1, -1}) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (Eigen::Index j = 0; j < N; ++j) {
        const double tau = 2 * pi * static_cast<double>(j) / N;
        double axial = 0, power = 1;
        for (const FourierSeries& f : coefficients.rods[0].f) {
          if (f.num_harmonics() >= 0) {
            const Eigen::VectorXd at = fourier::evaluate(f, tau);
            axial += power * (at(4) + at(3) * x(i) - at(2) * x(i) * x(i) / 2);
          }
          power *= found.speed;
        }
        const Elastic& e = *rod.elastic;
        const double sigma = axial * e.youngs_modulus * e.second_moment / e.area +
                             side * M(i, j) * e.section_height / 2 / e.second_moment;
        low = std::min(low, sigma);
        high = std::max(high, sigma);
        if (i % 8 != 0) j += 7;  // coarser in time between
      }
      largest = std::max({largest, high, -low});
      if ((high - low) / 2 > widest) {
        widest = (high - low) / 2;
        mean = (high + low) / 2;
      }
    }
  EXPECT_NEAR(cycle.max_abs, largest, 1e-4 * largest);
  EXPECT_NEAR(cycle.amplitude, widest, 1e-4 * widest);
  EXPECT_NEAR(cycle.mean, mean, 1e-2 * widest);
  EXPECT_LE(cycle.max_abs, result.stress->axial + result.stress->bending);
  EXPECT_GT(cycle.error, 0);
  EXPECT_LT(cycle.error, 0.01 * cycle.max_abs);
}

// Shigley: a bar with S_u = 690, S_e = 230 under 120 +- 80 MPa.
TEST(FatigueSafety, IsTheTextbooksLine) {
  const Strength goodman{490, 690, 230};
  ASSERT_EQ(fatigue_line(goodman), FatigueLine::goodman);
  EXPECT_NEAR(1 / fatigue_usage(goodman, 120, 80), 1 / (80.0 / 230 + 120.0 / 690), 1e-14);
  const Strength soderberg{490, 0, 230};
  ASSERT_EQ(fatigue_line(soderberg), FatigueLine::soderberg);
  EXPECT_NEAR(1 / fatigue_usage(soderberg, 120, 80), 1 / (80.0 / 230 + 120.0 / 490), 1e-14);
  EXPECT_EQ(fatigue_usage(soderberg, -120, 80), 80.0 / 230);  // a mean that presses does not count
  EXPECT_EQ(fatigue_line({490, 690, 0}), FatigueLine::none);
  EXPECT_EQ(fatigue_line({0, 0, 230}), FatigueLine::none);
  // The error is how far the factor may be off, on its far side.
  const SafetyFactor factor = safety_factor(0.5, 0.1);
  EXPECT_EQ(factor.value, 2);
  EXPECT_NEAR(factor.error, 0.5, 1e-15);
  EXPECT_TRUE(std::isinf(safety_factor(0.5, 0.5).error));
  EXPECT_TRUE(std::isinf(safety_factor(0, 0).value));
}

// At every place and fibre of a fine grid the rod is at least as safe, and somewhere no safer.
TEST(FatigueSafety, IsThatOfTheWorstPlaceWhichNeedNotHaveTheWidestCycle) {
  Scene scene = read_scene(machine_scenes + "slider_crank_units.toml");
  Body& rod = std::get<Linkage>(scene.model).dyads[0].coupler;
  rod.elastic->strength = {250e6, 0, 200e9};  // the mean alone counts
  Request request;
  request.rpm = 3000;
  request.modes = 3;
  const SteadyResult found = steady(scene, request);
  const RodResult& result = found.rods[0];
  const RodCoefficients& coefficients = found.model->coefficients.rods[0];
  const StressCycle cycle =
      stress_cycle(rod, coefficients, found.speed, result.steady->q, result.more_modes, result.steady->error_bound);
  ASSERT_TRUE(cycle.fatigue && cycle.yield);
  EXPECT_NEAR(cycle.yield->value, 250e6 / cycle.max_abs, 1e-12 * cycle.yield->value);
  const StressEnvelope envelope = stress_envelope(rod, coefficients, found.speed, result.steady->q, 401);
  double most = 0;
  for (int side = 0; side < 2; ++side)
    for (Eigen::Index i = 0; i < envelope.x.size(); ++i) {
      const double high = envelope.largest[side](i), low = envelope.smallest[side](i);
      most = std::max(most, (high - low) / 2 / 200e9 + std::max(0.0, (high + low) / 2) / 250e6);
    }
  EXPECT_NEAR(1 / cycle.fatigue->factor.value, most, 2e-3 * most);
  const double there = cycle.fatigue->amplitude / 200e9 + std::max(0.0, cycle.fatigue->mean) / 250e6;
  EXPECT_NEAR(there, most, 2e-3 * most);
  const double widest = cycle.amplitude / 200e9 + std::max(0.0, cycle.mean) / 250e6;
  EXPECT_LT(widest, 0.98 * most);
  EXPECT_GT(cycle.fatigue->factor.error, 0);
  EXPECT_LT(cycle.fatigue->factor.error, 0.1 * cycle.fatigue->factor.value);
}

// Of a motion of two turns: half of the harmonics, so that angles and stored energy are over both.
TEST(Drive, OfTwoTurnsIsThatOfOneRepeated) {
  FourierSeries one(1, 3), two(1, 6);
  one.c << 2.0, Complex(0.5, -0.2), Complex(-0.1, 0.3), Complex(0.05, 0.02);
  for (Eigen::Index k = 0; k <= 3; ++k) two.c(0, 2 * k) = one.c(0, k);
  const Drive single = drive_of(one, 7), twice = drive_of(two, 7, 2);
  EXPECT_NEAR(twice.energy_fluctuation, single.energy_fluctuation, 1e-12);
  EXPECT_NEAR(twice.rms, single.rms, 1e-14);
  EXPECT_NEAR(twice.largest_power, single.largest_power, 1e-10);
}

}  // namespace
