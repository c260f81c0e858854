// The accuracy contract, over all scenes: asked tolerance, claimed error, true error. Claimed is never below true, and
// true is above asked only where the status says so.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/dense_harmonic_balance.hpp"

namespace hb {
namespace {

struct Case {
  std::string name;
  HillSystem system;
  double speed;
};

std::vector<Case> cases(int num_modes) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(HB_SOURCE_DIR "/tests/scenes"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  for (const auto& entry : std::filesystem::directory_iterator(HB_SOURCE_DIR "/results"))
    if (std::filesystem::exists(entry.path() / "scene.toml")) files.push_back(entry.path() / "scene.toml");
  std::sort(files.begin(), files.end());
  std::vector<Case> result;
  for (const auto& file : files) {
    const Scene scene = read_scene(file);
    const std::string name = file.parent_path().filename().string() + "/" + file.stem().string();
    double speed = scene.analysis.omega ? scene.analysis.omega->from : 1;
    if (scene.analysis.rpm) speed = speed_from_rpm(scene.analysis.rpm->from, scene.units);
    if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
      result.push_back({name, *hill, speed});
      continue;
    }
    const auto& linkage = std::get<Linkage>(scene.model);
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const Body& rod = *body_at(linkage, coefficients.links[r]);
      result.push_back({name + " " + rod.name, ritz_system(rod, coefficients.rods[r], num_modes), speed});
    }
  }
  return result;
}

TEST(ToleranceContract, ClaimedSteadyErrorIsNeverBelowTheTrueOneNorTrueAboveAsked) {
  double closest = 0;
  int compared = 0;
  std::printf("%-36s %8s %10s %10s %4s\n", "scene", "asked", "claimed", "true", "H");
  for (const Case& c : cases(3)) {
    const SteadyState finest = solve_steady_state(c.system, c.speed, {.tolerance = 1e-13});
    if (finest.q.c.size() == 0 || finest.q.c.isZero(0)) continue;
    const Eigen::Index H = finest.num_harmonics + 24;
    ASSERT_LE((2 * H + 1) * c.system.num_modes(), 2400) << c.name;
    const reference::Response exact = reference::dense_harmonic_balance(c.system, c.speed, H);
    for (int digits = 2; digits <= 13; ++digits) {
      const double asked = std::pow(10, -digits);
      const SteadyState state = solve_steady_state(c.system, c.speed, {.tolerance = asked});
      const double error = reference::true_error(state.q, exact);
      std::printf("%-36s %8.0e %10.2e %10.2e %4d\n", c.name.c_str(), asked, state.error_bound, error,
                  state.num_harmonics);
      EXPECT_LE(error, state.error_bound) << c.name << " asked " << asked;
      if (state.status == SteadyStatus::converged) {
        EXPECT_LE(state.error_bound, asked) << c.name;
      }
      closest = std::max(closest, error / state.error_bound);
      ++compared;
    }
  }
  std::printf("%d answers, largest true/claimed %.2g\n", compared, closest);
  EXPECT_GE(compared, 150);
}

TEST(ToleranceContract, ClaimedGrowthErrorIsNeverBelowTheTrueOneNorTrueAboveAsked) {
  double closest = 0;
  int compared = 0;
  std::printf("%-36s %8s %10s %10s\n", "scene", "asked", "claimed", "true");
  for (const Case& c : cases(3)) {
    // The independent method, as tight as it goes.
    const Stability exact =
        analyse_stability(c.system, c.speed, {.tolerance = 1e-13, .method = StabilityMethod::propagation});
    for (int digits = 2; digits <= 12; digits += 2)
      for (const bool leading_only : {false, true}) {
        const double asked = std::pow(10, -digits);
        const Stability state =
            analyse_stability(c.system, c.speed, {.tolerance = asked, .leading_only = leading_only});
        const double scale = std::max(std::abs(exact.growth_rate), c.speed);
        const double error = std::abs(state.growth_rate - exact.growth_rate);
        std::printf("%-36s %8.0e %10.2e %10.2e%s\n", c.name.c_str(), asked, state.growth_error / scale, error / scale,
                    leading_only ? "  leading only" : "");
        EXPECT_LE(error, state.growth_error + exact.growth_error) << c.name << " asked " << asked;
        if (state.converged) {
          EXPECT_LE(error, asked * scale + exact.growth_error) << c.name;
        }
        if (exact.growth_error < 0.1 * state.growth_error) closest = std::max(closest, error / state.growth_error);
        ++compared;
      }
  }
  std::printf("%d answers, largest true/claimed %.2g\n", compared, closest);
  EXPECT_GE(compared, 150);
}

}  // namespace
}  // namespace hb
