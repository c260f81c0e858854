#include "lib/linkage/joint_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>
#include <tuple>

#include "lib/linkage/influence.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/dense_steady_state.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;
using Complex = std::complex<double>;
using nlohmann::json;

const json& reference() {
  static const json document = json::parse(std::ifstream(HB_SOURCE_DIR "/tests/reference/six_link.json"));
  return document;
}

// The reference holds extrema over this many crank angles.
constexpr Eigen::Index reference_samples = 8192;

void expect_range(const json& expected, const FourierSeries& series, Eigen::Index component, double relative,
                  const std::string& what) {
  const double low = expected[0], high = expected[1], scale = std::max(std::abs(low), std::abs(high));
  const Eigen::RowVectorXd samples = fourier::synthesise(series, reference_samples).row(component);
  EXPECT_NEAR(samples.minCoeff(), low, relative * scale) << what;
  EXPECT_NEAR(samples.maxCoeff(), high, relative * scale) << what;
}

TEST(JointForces, AgreeWithAnIndependentFormulationOfTheSixLinkMechanism) {
  for (const json& wanted : reference().at("cases")) {
    const Linkage linkage = six_link::linkage({.J = wanted["J"]});
    const double Omega = wanted["rpm"].get<double>() * std::numbers::pi / 30;
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    std::vector<LinkResponse> responses;
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const Body& body = *body_at(linkage, coefficients.links[r]);
      const json& rod = wanted["rods"][body.name];
      const HillSystem system = ritz_system(body, coefficients.rods[r], wanted["modes"].get<int>());
      const FourierSeries C = stiffness_at(system, Omega);
      for (std::size_t k = 0; k < rod["stiffness_11_fourier"].size(); ++k) {
        const json& c = rod["stiffness_11_fourier"][k];
        EXPECT_LE(std::abs(C.c(0, static_cast<Eigen::Index>(k)) - Complex(c[0], c[1])), 1e-12 * std::abs(C.c(0, 0)));
      }
      responses.push_back({coefficients.links[r], dense_steady_state(system, Omega, 40)});
      const Eigen::MatrixXd q = fourier::synthesise(responses.back().q, reference_samples);
      for (std::size_t i = 0; i < rod["max_abs_q"].size(); ++i) {
        const double peak = q.row(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff();
        EXPECT_NEAR(peak, rod["max_abs_q"][i].get<double>(), 1e-10 * peak) << body.name << " q" << i + 1;
      }
    }
    const JointForces forces = joint_forces(linkage, Omega, responses);
    for (const JointForce& joint : forces.joints) {
      if (!wanted["joints"].contains(joint.name)) continue;
      const json& ranges = wanted["joints"][joint.name];
      const std::string what = joint.name + " at rpm " + wanted["rpm"].dump();
      expect_range(ranges["x_rigid"], joint.rigid, 0, 1e-11, what + " x rigid");
      expect_range(ranges["y_rigid"], joint.rigid, 1, 1e-11, what + " y rigid");
      expect_range(ranges["x"], joint.elastic, 0, 1e-11, what + " x");
      expect_range(ranges["y"], joint.elastic, 1, 1e-11, what + " y");
    }
    expect_range(wanted["torque"]["rigid"], forces.torque_rigid, 0, 1e-11, "rigid torque");
    expect_range(wanted["torque"]["elastic"], forces.torque, 0, 1e-11, "torque");
  }
}

TEST(JointForces, ErrorOfSamplingCoversTheTrueOne) {
  const Linkage linkage = six_link::linkage({.J = 45.0});
  const JointForces truth = joint_forces(linkage, 31.4, {}, 1e-16);
  for (const double tolerance : {1e-2, 1e-3, 1e-5, 1e-8, 1e-11}) {
    const JointForces forces = joint_forces(linkage, 31.4, {}, tolerance);
    double error = 0;
    for (std::size_t j = 0; j < forces.joints.size(); ++j)
      error = std::max(
          error, (fourier::synthesise(forces.joints[j].rigid, 512) - fourier::synthesise(truth.joints[j].rigid, 512))
                     .cwiseAbs()
                     .maxCoeff());
    EXPECT_LE(error, forces.force_error) << tolerance;
    EXPECT_LE(forces.force_error, 100 * error + truth.force_error) << tolerance;
  }
}

TEST(JointForces, ThoseOfTheDeflectionsAreWhatElasticOnesHaveMoreThanRigidOnes) {
  const Linkage linkage = six_link::linkage({.J = 45.0});
  const double Omega = 31.4;
  std::vector<LinkResponse> responses;
  for (const int link : elastic_links(linkage)) {
    FourierSeries q(3, 5);
    for (Eigen::Index k = 0; k <= 5; ++k)
      for (Eigen::Index i = 0; i < 3; ++i) q.c(i, k) = std::polar(k == 0 ? 0.5 : 1.0, double(k * (i + link)));
    for (Eigen::Index i = 0; i < 3; ++i) q.c(i, 0) = q.c(i, 0).real();
    responses.push_back({link, q});
  }
  const JointForces all = joint_forces(linkage, Omega, responses);
  const JointForces added = deflection_forces(InfluenceTable(linkage), Omega, responses);
  const auto samples = [](const FourierSeries& series) { return fourier::synthesise(series, 1024); };
  ASSERT_EQ(added.joints.size(), all.joints.size());
  for (std::size_t j = 0; j < all.joints.size(); ++j) {
    const Eigen::MatrixXd expected = samples(all.joints[j].elastic) - samples(all.joints[j].rigid);
    const double size = samples(all.joints[j].elastic).cwiseAbs().maxCoeff();
    EXPECT_LE((samples(added.joints[j].elastic) - expected).cwiseAbs().maxCoeff(), 1e-11 * size) << all.joints[j].name;
    EXPECT_GT(expected.cwiseAbs().maxCoeff(), 1e-3 * size);
  }
  const Eigen::MatrixXd torque = samples(all.torque) - samples(all.torque_rigid);
  EXPECT_LE((samples(added.torque) - torque).cwiseAbs().maxCoeff(), 1e-11 * samples(all.torque).cwiseAbs().maxCoeff());
}

TEST(JointForces, OfOneTableAtEverySpeedAreThoseOfTheirOwn) {
  const Linkage linkage = std::get<Linkage>(read_scene(HB_SOURCE_DIR "/tests/scenes/eight_link.toml").model);
  const InfluenceTable table(linkage);
  for (const double Omega : {3.0, 70.0, -20.0}) {
    std::vector<LinkResponse> responses;
    for (const int link : elastic_links(linkage)) {
      FourierSeries q(2, Omega > 50 ? 90 : 4);  // more angles for the second speed than for the others
      for (Eigen::Index k = 0; k <= q.num_harmonics(); ++k)
        for (Eigen::Index i = 0; i < 2; ++i)
          q.c(i, k) = k == 0 ? 0.1 : std::polar(std::exp2(-k), double(k * (i + link)));
      responses.push_back({link, q});
    }
    const JointForces shared = joint_forces(table, Omega, responses), own = joint_forces(linkage, Omega, responses);
    for (std::size_t j = 0; j < own.joints.size(); ++j) {
      EXPECT_EQ(shared.joints[j].elastic.c, own.joints[j].elastic.c) << own.joints[j].name;
      EXPECT_EQ(shared.joints[j].rigid.c, own.joints[j].rigid.c) << own.joints[j].name;
    }
    EXPECT_EQ(shared.torque.c, own.torque.c);
    EXPECT_EQ(shared.torque_rigid.c, own.torque_rigid.c);
    EXPECT_EQ(shared.frame.elastic.c, own.frame.elastic.c);
    EXPECT_EQ(shared.frame.rigid.c, own.frame.rigid.c);
    EXPECT_EQ(shared.force_error, own.force_error);
    EXPECT_EQ(shared.torque_error, own.torque_error);
  }
}

// Gravity, damping, inertia and the applied force against the balance of all loads at once.
TEST(JointForces, RigidOnesAreThoseOfTheWholeBalanceAtEveryAngle) {
  const Linkage linkage = std::get<Linkage>(read_scene(HB_SOURCE_DIR "/tests/scenes/eight_link.toml").model);
  ASSERT_TRUE(std::ranges::any_of(linkage.dyads, [](const Dyad& dyad) {
    const auto* slider = std::get_if<Slider>(&dyad.closing);
    return slider != nullptr && slider->force.c.size() > 0;
  }));
  const double Omega = 40;
  const Eigen::RowVectorXd torque = fourier::synthesise(joint_forces(linkage, Omega, {}).torque_rigid, 512);
  for (Eigen::Index j = 0; j < 512; j += 37) {
    const double tau = 2 * std::numbers::pi * double(j) / 512;
    const std::vector<BodyMotion> motion = motion_at(linkage, tau);
    const auto powers = rigid_loads(linkage, motion, tau);
    std::vector<BodyLoad> loads(motion.size());
    for (std::size_t b = 0; b < loads.size(); ++b)
      for (std::size_t p = 0; p < 3; ++p) {
        loads[b].force += std::pow(Omega, double(p)) * powers[p][b].force;
        loads[b].moment += std::pow(Omega, double(p)) * powers[p][b].moment;
      }
    EXPECT_NEAR(torque(j), balance(linkage, motion, loads).torque, 1e-10 * torque.cwiseAbs().maxCoeff());
  }
}

// Threads ask in any order.
TEST(JointForces, InfluenceCoefficientsDoNotDependOnWhichAnglesAreAskedForFirst) {
  const Linkage linkage = std::get<Linkage>(read_scene(HB_SOURCE_DIR "/tests/scenes/eight_link.toml").model);
  const InfluenceTable grown(linkage), made(linkage);
  ASSERT_EQ(grown.at(64)->num_samples(), 64);
  ASSERT_EQ(grown.at(256)->num_samples(), 256);
  const auto some = grown.at(128), all = made.at(256);
  EXPECT_EQ(some->num_samples(), 256);
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(some->rigid[p], all->rigid[p]);
  ASSERT_EQ(some->applied.size(), 1u);
  EXPECT_EQ(some->applied[0].unit, all->applied[0].unit);
  ASSERT_EQ(some->rods.size(), elastic_links(linkage).size());
  for (std::size_t r = 0; r < all->rods.size(); ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(some->rods[r].unit[c], all->rods[r].unit[c]);
      EXPECT_GT(all->rods[r].unit[c].cwiseAbs().maxCoeff(), 0);
    }
    for (std::size_t j = 0; j < 256; ++j) {
      const RodMotion &a = some->rods[r].motion[j], &b = all->rods[r].motion[j];
      EXPECT_EQ(std::tie(a.phi1, a.phi2, a.sine, a.along1, a.along2),
                std::tie(b.phi1, b.phi2, b.sine, b.along1, b.along2));
    }
  }
}

TEST(JointForces, ThreadsMayAskForInfluenceCoefficientsAtOnce) {
  const Linkage linkage = six_link::linkage({.J = 45.0});
  const std::shared_ptr<const Influence> alone = InfluenceTable(linkage).at(512);
  const InfluenceTable shared(linkage);
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t)
    threads.emplace_back([&, t] {
      for (const Eigen::Index N : {64, 512, 128, 256}) {
        const std::shared_ptr<const Influence> found = shared.at(t % 2 == 0 ? N : 32768 / N);
        const Eigen::Index step = 512 / found->num_samples();
        for (Eigen::Index j = 0; j < found->num_samples(); ++j)
          wrong[t] += found->rigid[2].col(j) != alone->rigid[2].col(j * step);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

// Beside responses of 1e14 times their size rigid forces counted as rounding, and were 0.
TEST(JointForces, RigidOnesAreTheSameBesideAnyResponse) {
  const Linkage linkage = six_link::linkage({.J = 45.0});
  const double Omega = 31.4;
  const JointForces alone = joint_forces(linkage, Omega, {});
  std::vector<LinkResponse> huge;
  for (const int link : elastic_links(linkage)) {
    FourierSeries q(1, 1);
    q.c(0, 1) = 1e18;
    huge.push_back({link, q});
  }
  const JointForces beside = joint_forces(linkage, Omega, huge);
  for (std::size_t j = 0; j < alone.joints.size(); ++j) {
    const Eigen::MatrixXd expected = fourier::synthesise(alone.joints[j].rigid, 512),
                          found = fourier::synthesise(beside.joints[j].rigid, 512);
    EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff()) << alone.joints[j].name;
  }
}

}  // namespace
