// The estimated error of cutting the Ritz series covers the true one, seen against 60 modes.
#include <gtest/gtest.h>

#include "hb/analysis/linkage_analysis.hpp"

namespace {

using hb::RodResult;

hb::SpeedResult solve(const char* scene, int num_modes, double speed) {
  hb::Settings settings;
  settings.modes = num_modes;
  settings.tolerance = 1e-12;
  settings.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  const auto model = hb::make_model(hb::read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + scene), settings);
  return hb::analyse(model, speed, settings);
}

// max |w - w_60| / max |w_60| over rod and turn, and of EJ w'' likewise.
hb::CutError true_error(const char* scene, std::size_t rod, double speed, const RodResult& cut, const RodResult& full) {
  const hb::Scene read = hb::read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + scene);
  const auto& linkage = std::get<hb::Linkage>(read.model);
  const hb::LinkageCoefficients coefficients = hb::linkage_coefficients(linkage);
  const hb::Body& link = *hb::body_at(linkage, cut.link);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(241, 0, link.length);
  const auto field = [&](const RodResult& result) {
    return hb::rod_field(link, coefficients.rods[rod], speed, result.steady->q, x, 128);
  };
  const hb::RodField all = field(full), some = field(cut);
  const auto relative = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
  };
  return {relative(some.w, all.w), relative(some.bending_moment, all.bending_moment)};
}

struct CutCase {
  const char* scene;
  double speed;  // rad per unit time
};

class ModesError : public testing::TestWithParam<CutCase> {};

TEST_P(ModesError, CoversTheTrueErrorOfTheCut) {
  const auto [scene, speed] = GetParam();
  const auto full = solve(scene, 60, speed);
  for (const int num_modes : {1, 2, 3, 5, 8, 12}) {
    const auto cut = solve(scene, num_modes, speed);
    for (std::size_t rod = 0; rod < cut.rods.size(); ++rod) {
      const hb::CutError error = true_error(scene, rod, speed, cut.rods[rod], full.rods[rod]);
      // What is left of the solver's own error and of rounding.
      const double floor = 1e-11;
      SCOPED_TRACE(cut.rods[rod].name + ", " + std::to_string(num_modes) + " modes");
      ASSERT_TRUE(cut.rods[rod].cut.has_value());
      const hb::CutError& estimate = *cut.rods[rod].cut;
      EXPECT_LE(error.deflection, estimate.deflection + floor);
      EXPECT_LE(estimate.deflection, 20 * error.deflection + floor);
      EXPECT_LE(error.bending_moment, estimate.bending_moment + 100 * floor);
      EXPECT_LE(estimate.bending_moment, 20 * error.bending_moment + 100 * floor);
    }
  }
}

// modes = "auto": with the modes that it takes, deflection and growth rate are those of 60 within what was asked.
TEST_P(ModesError, AutomaticModesAreEnoughForDeflectionAndGrowth) {
  const auto [scene, speed] = GetParam();
  const hb::Scene read = hb::read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + scene);
  const auto full = solve(scene, 60, speed);
  const auto& linkage = std::get<hb::Linkage>(read.model);
  const hb::LinkageCoefficients coefficients = hb::linkage_coefficients(linkage);
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    hb::Settings settings;
    settings.modes = hb::AutoModes{};
    settings.tolerance = tolerance;
    settings.only = {.steady = true, .stability = true, .reactions = false, .shape = false};
    const auto result = hb::analyse(hb::make_model(read, settings), speed, settings);
    for (std::size_t r = 0; r < result.rods.size(); ++r) {
      const RodResult& rod = result.rods[r];
      const hb::Stability exact = hb::analyse_stability(
          hb::ritz_system(*hb::body_at(linkage, rod.link), coefficients.rods[r], 60), speed, {.leading_only = true});
      ASSERT_TRUE(rod.growth_modes_error.has_value());
      // Rotary inertia damps every higher mode of the rocker less: its growth rate has no limit below 60 modes, and
      // the estimate says so.
      const bool settles = rod.name != "rocker" || tolerance > 1e-3;
      EXPECT_EQ(*rod.growth_modes_error <= tolerance, settles) << rod.name << ", " << rod.num_modes << " modes";
      const double scale = std::max(std::abs(exact.growth_rate), speed);
      EXPECT_LE(std::abs(rod.stability->growth_rate - exact.growth_rate),
                *rod.growth_modes_error * scale + rod.stability->growth_error + exact.growth_error)
          << rod.name << ", " << rod.num_modes << " modes for " << tolerance;
      EXPECT_LE(true_error(scene, r, speed, rod, full.rods[r]).deflection, tolerance)
          << rod.name << ", " << rod.num_modes << " modes";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ModesError,
                         testing::Values(CutCase{"six_link.toml", 31.4}, CutCase{"six_link.toml", 157.0},
                                         CutCase{"six_link.toml", 314.0}, CutCase{"six_link_4500.toml", 31.4},
                                         CutCase{"slider_crank.toml", 100.0}, CutCase{"four_bar.toml", 50.0}));

}  // namespace
