// The estimated errors of joint forces and driving torque cover the true ones: of the modes kept, seen against the
// direct solution with twice the harmonics, and of the cut, seen against 40 modes.
#include <gtest/gtest.h>

#include "hb/analysis/linkage_analysis.hpp"

namespace {

using namespace hb;

struct Case {
  const char* scene;
  double speed;  // rad per unit time
};

Settings settings_of(int num_modes, double tolerance) {
  Settings settings;
  settings.modes = num_modes;
  settings.tolerance = tolerance;
  settings.only = {.steady = false, .stability = false, .reactions = true, .shape = false};
  return settings;
}

SceneModel model_of(const char* scene, const Settings& settings) {
  return make_model(read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + scene), settings);
}

JointForces accurate_forces(const char* scene, double speed, int num_modes, const SteadyOptions& method) {
  const SceneModel model = model_of(scene, settings_of(num_modes, 1e-14));
  std::vector<LinkResponse> responses;
  for (const RodModel& rod : model.rods) {
    SteadyOptions options = method;
    options.num_harmonics = 2 * solve_steady_state(rod.system, speed, options).num_harmonics + 16;
    responses.push_back({rod.link, solve_steady_state(rod.system, speed, options).q});
  }
  return joint_forces(*model.linkage(), speed, responses, 1e-16);
}

struct Relative {
  double force = 0, torque = 0;
};

// Largest difference on 1024 crank angles over the largest value.
Relative difference(const JointForces& forces, const JointForces& truth) {
  constexpr Eigen::Index N = 1024;
  const auto samples = [](const FourierSeries& series) { return fourier::synthesise(series, N); };
  double size = 0, error = 0;
  for (std::size_t j = 0; j < truth.joints.size(); ++j) {
    const Eigen::MatrixXd right = samples(truth.joints[j].elastic);
    size = std::max(size, right.cwiseAbs().maxCoeff());
    error = std::max(error, (samples(forces.joints[j].elastic) - right).cwiseAbs().maxCoeff());
  }
  const Eigen::MatrixXd torque = samples(truth.torque);
  return {error / size, (samples(forces.torque) - torque).cwiseAbs().maxCoeff() / torque.cwiseAbs().maxCoeff()};
}

class OfTheModesKept : public testing::TestWithParam<Case> {};
class OfTheCut : public testing::TestWithParam<Case> {};

TEST_P(OfTheModesKept, CoversTheTrueOne) {
  const auto [scene, speed] = GetParam();
  const JointForces truth = accurate_forces(scene, speed, 5, {.tolerance = 1e-14, .method = SteadyMethod::direct});
  for (const double tolerance : {1e-2, 1e-4, 1e-7, 1e-10, 1e-13}) {
    const Settings settings = settings_of(5, tolerance);
    const SpeedResult result = analyse(model_of(scene, settings), speed, settings);
    const Relative error = difference(*result.forces, truth);
    ASSERT_TRUE(result.force_errors.has_value());
    EXPECT_LE(error.force, result.force_errors->force) << tolerance;
    EXPECT_LE(error.torque, result.force_errors->torque) << tolerance;
    // No more pessimistic than the tolerance that was asked for, or than rounding.
    EXPECT_LE(result.force_errors->force, std::max(100 * tolerance, 1e-10)) << tolerance;
    EXPECT_LE(result.force_errors->torque, std::max(100 * tolerance, 1e-10)) << tolerance;
  }
}

// As sweeps have it: without an answer of more harmonics.
TEST_P(OfTheModesKept, CoversTheTrueOneFromTheErrorOfQAlone) {
  const auto [scene, speed] = GetParam();
  const JointForces truth = accurate_forces(scene, speed, 5, {.tolerance = 1e-14, .method = SteadyMethod::direct});
  for (const double tolerance : {1e-2, 1e-4, 1e-7, 1e-10, 1e-13}) {
    const Settings settings = settings_of(5, tolerance);
    const SceneModel model = model_of(scene, settings);
    std::vector<LinkResponse> responses;
    double response_error = 0;
    for (const RodModel& rod : model.rods) {
      const SteadyState state = solve_steady_state(rod.system, speed, {.tolerance = tolerance});
      responses.push_back({rod.link, state.q});
      response_error = std::max(response_error, state.error_bound);
    }
    const JointForces forces = joint_forces(*model.linkage(), speed, responses);
    const ForceErrors told =
        force_errors(*model.influence, speed, forces, largest_of(forces), response_error, responses, {}, {});
    const Relative error = difference(forces, truth);
    EXPECT_LE(error.force, told.force) << tolerance;
    EXPECT_LE(error.torque, told.torque) << tolerance;
    EXPECT_LE(told.force, std::max(1e4 * tolerance, 1e-8)) << tolerance;
  }
}

TEST_P(OfTheCut, CoversTheTrueOne) {
  const auto [scene, speed] = GetParam();
  const JointForces truth = accurate_forces(scene, speed, 40, {.tolerance = 1e-12});
  for (const int num_modes : {1, 2, 3, 5, 8}) {
    const Settings settings = settings_of(num_modes, 1e-12);
    const SpeedResult result = analyse(model_of(scene, settings), speed, settings);
    const Relative error = difference(*result.forces, truth);
    const double floor = 1e-11;  // the solver's own error
    EXPECT_LE(error.force, result.force_errors->force_cut + floor) << num_modes;
    EXPECT_LE(error.torque, result.force_errors->torque_cut + floor) << num_modes;
    EXPECT_LE(result.force_errors->force_cut, 20 * error.force + floor) << num_modes;
    EXPECT_LE(result.force_errors->torque_cut, 20 * error.torque + floor) << num_modes;
  }
}

constexpr Case compared_scenes[] = {{"six_link.toml", 31.4},
                                    {"six_link.toml", 314.0},
                                    {"six_link_4500.toml", 31.4},
                                    {"slider_crank.toml", 300.0},
                                    {"four_bar.toml", 50.0}};
INSTANTIATE_TEST_SUITE_P(Scenes, OfTheModesKept, testing::ValuesIn(compared_scenes));
INSTANTIATE_TEST_SUITE_P(EightLinks, OfTheModesKept, testing::Values(Case{"eight_link.toml", 0.005}));
INSTANTIATE_TEST_SUITE_P(Scenes, OfTheCut, testing::ValuesIn(compared_scenes));

}  // namespace
