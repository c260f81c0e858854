// A thick rod with shear through everything that is computed of a scene.
#include "lib/rod/shear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/bench_rod.hpp"
#include "hb/analysis/cross_check.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "hb/analysis/tune/tune_quantities.hpp"
#include "lib/rod/time_domain_rod.hpp"

namespace hb {
namespace {

constexpr double speed = 6000 * std::numbers::pi / 30;

// The connecting rod of a two-stroke engine, SI units.
Scene engine(const std::string& shear, const std::string& damping = "damping_internal = 1e-6") {
  return parse_scene(R"(gravity = 0
[crank]
pivot = [0, 0]
length = 0.027
[[dyad]]
on = "crank"
coupler = { name = "rod", length = 0.11, mass = 0.095, elastic = { E = 210e9, area = 110e-6, J = 2500e-12, )" +
                         damping + shear + R"( } }
slider = { name = "piston", mass = 0.17, guide = [0, 0.01], direction = 0 }
branch = 1
[analysis]
modes = 3
rpm = 6000
)",
                     "engine.toml");
}

const char* const steel_shear = ", shear = { G = 79.3e9, k = 0.85 }";

struct Answer {
  SceneModel model;
  Settings settings;
  SpeedResult result;
};

Answer answer(const Scene& scene, double at = speed, double tolerance = 1e-11) {
  Settings settings;
  settings.modes = 3;
  settings.tolerance = tolerance;
  settings.only = {true, true, true, true};
  SceneModel model = make_model(scene, settings);
  SpeedResult result = analyse(model, at, settings);
  return {std::move(model), settings, std::move(result)};
}

TEST(ShearOfAScene, WrongKeysAndValuesAreRefusedWithLineAndKey) {
  const struct {
    const char *shear, *key, *words;
  } cases[] = {{"{ G = 0, k = 0.85 }", "shear.G", "0"},
               {"{ G = -79.3e9, k = 0.85 }", "shear.G", "-79300000000"},
               {"{ G = 79.3e9, k = 0 }", "shear.k", "0"},
               {"{ G = 79.3e9, k = -1 }", "shear.k", "-1"},
               {"{ G = nan, k = 0.85 }", "shear.G", "nan"},
               {"{ G = 79.3e9 }", "shear", "k"},
               {"{ k = 0.85 }", "shear", "G"},
               {"{ G = 79.3e9, k = 0.85, kappa = 1 }", "shear", "kappa"},
               {"{ G = \"79.3 kg\", k = 0.85 }", "shear.G", "79.3 kg"},
               {"79.3e9", "shear", "table"}};
  for (const auto& c : cases) {
    try {
      (void)engine(std::string(", shear = ") + c.shear);
      ADD_FAILURE() << c.shear << " was accepted";
    } catch (const SceneError& error) {
      const std::string said = error.what();
      EXPECT_EQ(said.rfind("engine.toml:7", 0), 0u) << said;
      EXPECT_NE(said.find(c.key), std::string::npos) << c.shear << ": " << said;
      EXPECT_NE(said.find(c.words), std::string::npos) << c.shear << ": " << said;
    }
  }
}

TEST(ShearOfAScene, ChangesEveryAnswerByAFewPercentAndKeepsItsShape) {
  const Answer with = answer(engine(steel_shear)), without = answer(engine(""));
  const RodResult &a = with.result.rods[0], &b = without.result.rods[0];
  EXPECT_EQ(a.num_modes, 3);
  EXPECT_EQ(a.steady->q.num_components(), 3);
  EXPECT_EQ(a.max_abs.size(), 3u);
  EXPECT_EQ(a.num_exponents, 12);
  EXPECT_EQ(b.num_exponents, 6);
  EXPECT_TRUE(with.result.shortfalls.empty());
  EXPECT_LE(a.steady->error_bound, 1e-11);
  // Quasi-static: the deflection grows by E/(k G) pi^2 J/(F l^2) = 5.8 %, the moment of a rod on two pins does not.
  EXPECT_NEAR(a.shape->deflection.max_abs / b.shape->deflection.max_abs, 1.058, 0.004);
  EXPECT_NEAR(a.shape->bending_moment.max_abs / b.shape->bending_moment.max_abs, 1, 0.004);
  EXPECT_EQ(a.stability->verdict, Verdict::stable);
  EXPECT_LE(a.cut->deflection, 1e-3);
}

// More modes only add to the deflection what was estimated.
TEST(ShearOfAScene, TheErrorOfTheCutCoversTheChangeToManyModes) {
  const Answer few = answer(engine(steel_shear));
  Settings settings = few.settings;
  settings.modes = 15;
  settings.only = {true, false, false, true};
  const SpeedResult many = analyse(make_model(engine(steel_shear), settings), speed, settings);
  const double w = many.rods[0].shape->deflection.max_abs;
  EXPECT_LE(std::abs(few.result.rods[0].shape->deflection.max_abs - w),
            few.result.rods[0].cut->deflection * w + 1e-11 * w);
}

// Time integration of deflection and rotation against harmonic balance of the modes at rest.
TEST(ShearOfAScene, IsConfirmedByTimeIntegration) {
  for (const char* damping : {"damping_internal = 2e-5, damping_y = 0.3", "damping_internal = 1e-6"}) {
    Answer a = answer(engine(steel_shear, damping), speed, 1e-9);
    const SpeedCheck check = cross_check(a.model, speed, a.settings, {});
    ASSERT_EQ(check.rods.size(), 1u);
    EXPECT_TRUE(check.rods[0].compared()) << check.rods[0].not_compared;
    EXPECT_TRUE(check.agrees());
    ASSERT_TRUE(check.rods[0].exponents);
    EXPECT_LE(check.rods[0].q.difference, 1e-8);
    ASSERT_TRUE(check.joints);
  }
}

TEST(ShearOfAScene, ErrorBoundsOfTheDeflectionHold) {
  const Answer fine = answer(engine(steel_shear), speed, 1e-13);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const Answer rough = answer(engine(steel_shear), speed, tolerance);
    const FourierSeries &q = rough.result.rods[0].steady->q, &exact = fine.result.rods[0].steady->q;
    const Eigen::Index H = std::max(q.num_harmonics(), exact.num_harmonics());
    const FourierSeries difference(fourier::resized(q, H).c - fourier::resized(exact, H).c);
    double error = 0, size = 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      error = std::max(error, fourier::max_abs(difference, i).value);
      size = std::max(size, fourier::max_abs(exact, i).value);
    }
    EXPECT_LE(error / size, rough.result.rods[0].steady->error_bound + 2e-13);
    EXPECT_LE(rough.result.rods[0].steady->error_bound, tolerance);
  }
}

// That of the rod without shear grows with the deflection's square.
TEST(ShearOfAScene, TheoryErrorIsThatWithoutShearButForTheLargerDeflection) {
  const Answer with = answer(engine(steel_shear)), without = answer(engine(""));
  ASSERT_TRUE(with.result.theory && with.result.theory->rods[0].q && without.result.theory->rods[0].q);
  const double ratio = *with.result.theory->rods[0].q / *without.result.theory->rods[0].q;
  EXPECT_GT(ratio, 0.9);
  EXPECT_LT(ratio, 1.3);
  const Answer nearly = answer(engine(", shear = { G = 79.3e20, k = 0.85 }"));
  EXPECT_NEAR(*nearly.result.theory->rods[0].q, *without.result.theory->rods[0].q,
              1e-6 * *without.result.theory->rods[0].q);
}

TEST(ShearOfAScene, TheNonlinearTheoryRefusesIt) {
  Answer a = answer(engine(steel_shear));
  try {
    (void)nonlinear_steady(a.model, speed, a.settings);
    FAIL() << "not refused";
  } catch (const RequestError& error) {
    EXPECT_EQ(error.field, "theory");
    EXPECT_NE(error.found.find("shear of rod"), std::string::npos);
  }
}

TEST(ShearOfAScene, SweepFollowsTheModesOfTheDeflection) {
  Settings settings;
  settings.modes = 2;
  settings.only = {true, true, false, true};
  Axis axis;
  for (double rpm = 3000; rpm <= 9000; rpm += 500) axis.values.push_back(rpm);
  const SweepScene scene(SceneFamily(engine(steel_shear)), settings, axis, 0, 0);
  Work work;
  const SweepResult result = run_sweep(scene, work);
  ASSERT_EQ(result.rods.size(), 1u);
  EXPECT_EQ(result.rods[0].num_modes, 2);
  EXPECT_EQ(result.rods[0].num_unknowns, 4);
  const auto followed = tracks(result, 0, all_points(result));
  const Body& rod = *body_at(*scene.first().linkage(), 1);
  const RestModes modes = rest_modes(rod, 2);
  for (const auto& states : followed) {
    ASSERT_EQ(states.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const double omega = std::sqrt(modes.stiffness[0](k) / modes.mass[0](k));
      EXPECT_NEAR(states[i].frequency, omega, 0.1 * omega);
    }
  }
}

TEST(ShearOfAScene, BenchMeasuresErrorsOfTheDeflection) {
  Answer a = answer(engine(steel_shear, "damping_internal = 2e-5"));
  const TimeDomainSystem system = time_domain_rod(*a.model.linkage(), 1, 3, speed);
  const RodBench bench = bench_rod(a.model.rods[0], system, {SteadyMethod::automatic, 0.2, [] {}});
  double least = 1;
  for (const BenchRow& row : bench.rows)
    if (row.harmonic_balance) least = std::min(least, row.error);
  EXPECT_LE(least, 1e-9);
}

}  // namespace
}  // namespace hb
