// Analyses called from C++: of a scene read from a file, and of scenes that a function builds.
#include <gtest/gtest.h>

#include <optional>

#include "hb/hb.hpp"

namespace {

using namespace hb;

const std::string scenes = HB_SOURCE_DIR "/tests/scenes/";

// A function that gives what the text of the scene gives.
SceneFamily four_bar_by_function() {
  const Linkage linkage = std::get<Linkage>(read_scene(scenes + "four_bar.toml").model);
  return {{{"J", 0}},
          [linkage](const std::vector<double>& values) {
            Linkage changed = linkage;
            Body& rod = changed.dyads[0].coupler;
            rod.elastic->second_moment = values[0];
            rod.inertia = rod.mass * rod.length * rod.length / 12 + rod.elastic->density * values[0] * rod.length;
            return changed;
          },
          read_scene(scenes + "four_bar.toml").units};
}

// The elastic coupler of the four-bar and its J.
std::pair<std::string, double> coupler_of_four_bar() {
  const Scene scene = read_scene(scenes + "four_bar.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  const Body& body = *body_at(linkage, elastic_links(linkage).front());
  return {body.name, body.elastic->second_moment};
}

TEST(FromCpp, ASweepHasTheNumbersOfEachSpeedAlone) {
  const Scene scene = read_scene(scenes + "four_bar.toml");
  SweepRequest request;
  request.modes = 3;
  request.x = along("rpm", 300, 900, 3);
  request.only = {.steady = true, .stability = true, .reactions = false, .shape = false};
  const Sweep found = sweep(scene, request);
  ASSERT_EQ(found.points.size(), 3u);
  for (const SweepPoint& point : found.points) {
    Request one;
    one.modes = 3;
    one.rpm = point.x;
    one.only = request.only;
    const SteadyResult alone = steady(scene, one);
    EXPECT_EQ(point.rods[0].max_abs[0], alone.rods[0].max_abs[0].value);
    EXPECT_EQ(point.rods[0].stability->stability.growth_rate, alone.rods[0].stability->growth_rate);
  }
}

// Sweeps computed exponents to 1e-9 whatever was asked.
TEST(FromCpp, OneToleranceMeansTheSameForASweepAsForOneSpeed) {
  const Scene scene = read_scene(scenes + "four_bar.toml");
  for (const double tolerance : {1e-4, 1e-12}) {
    SweepRequest request;
    request.modes = 3;
    request.tolerance = tolerance;
    request.x = along("rpm", 1200, 2400, 2);
    request.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
    for (const SweepPoint& point : sweep(scene, request).points) {
      Request one;
      one.modes = 3;
      one.tolerance = tolerance;
      one.rpm = point.x;
      one.only = request.only;
      const SteadyResult alone = steady(scene, one);
      EXPECT_EQ(point.rods[0].stability->stability.growth_rate, alone.rods[0].stability->growth_rate) << tolerance;
      EXPECT_EQ(point.rods[0].stability->stability.growth_error, alone.rods[0].stability->growth_error) << tolerance;
    }
  }
}

// Maps took five modes where "auto" was asked.
TEST(FromCpp, AMapWithAutomaticModesTakesAsManyAsTheGrowthRateNeeds) {
  const Scene scene = read_scene(scenes + "four_bar.toml");
  MapRequest request;
  request.modes = AutoModes{};
  request.x = along("rpm", 300, 600, 2);
  const auto [name, J] = coupler_of_four_bar();
  request.y = along(name + ".J", J, 1.1 * J, 2);
  request.tolerance = 0.05;
  const Map found = map(SceneSource(scenes + "four_bar.toml"), request);
  Request one;
  one.modes = AutoModes{};
  one.tolerance = 0.05;
  one.rpm = 450;
  one.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
  EXPECT_EQ(found.num_modes, steady(scene, one).rods[0].num_modes);
}

TEST(FromCpp, AFunctionGivesTheSameSweepAsTheText) {
  const auto [name, J] = coupler_of_four_bar();
  SweepRequest request;
  request.modes = 2;
  request.rpm = 600;
  request.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  request.x = along(name + ".J", J, 2 * J, 3);
  const Sweep by_text = sweep(SceneSource(scenes + "four_bar.toml"), request);
  request.x.path = "J";
  const Sweep by_function = sweep(four_bar_by_function(), request);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(by_text.points[k].rods[0].max_abs, by_function.points[k].rods[0].max_abs);
}

TEST(FromCpp, AFunctionGivesTheSameMapAsTheText) {
  const auto [name, J] = coupler_of_four_bar();
  MapRequest request;
  request.modes = 2;
  request.x = along("rpm", 300, 500, 3);
  request.y = along(name + ".J", J, 2 * J, 2);
  const Map by_text = map(SceneSource(scenes + "four_bar.toml"), request);
  request.y.path = "J";
  const Map by_function = map(four_bar_by_function(), request);
  ASSERT_EQ(by_text.worst().size(), 6u);
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(by_text.worst()[p].verdict, by_function.worst()[p].verdict);
    EXPECT_EQ(by_text.worst()[p].growth_rate, by_function.worst()[p].growth_rate);
  }
}

TEST(FromCpp, TheTwoPathsAgreeOnALinkageBuiltInCode) {
  const Scene given = read_scene(scenes + "four_bar.toml");
  const Scene scene = scene_of(std::get<Linkage>(given.model), given.units);
  CheckRequest request;
  request.modes = 2;
  request.rpms = {300, 600};
  const Check found = check(scene, request);
  ASSERT_EQ(found.speeds.size(), 2u);
  EXPECT_TRUE(found.agrees());
}

// q'' + d q' + (1.2 + 0.4 cos tau) q = cos tau, whose tongue is known to the sweep of tests/scenes/mathieu.toml.
TEST(FromCpp, AHillSystemBuiltInCodeIsAnsweredByEveryAnalysis) {
  const SceneFamily family({{"d", 0.1}}, [](const std::vector<double>& values) {
    HillSystem system;
    system.mass = Eigen::MatrixXd::Identity(1, 1);
    system.damping = Eigen::MatrixXd::Constant(1, 1, values[0]);
    system.stiffness[0] = FourierSeries(1, 1);
    system.stiffness[0].c << 1.2, 0.2;
    system.load[0] = FourierSeries(1, 1);
    system.load[0].c << 0, 0.5;
    return system;
  });
  const Scene scene = family.scene();
  Request one;
  one.omega = 1;
  const SteadyResult alone = steady(scene, one);
  EXPECT_EQ(alone.rods[0].stability->verdict, Verdict::stable);
  SweepRequest range;
  range.x = along("omega", 1.5, 2.6, 12);
  const Sweep found = sweep(family, range);
  ASSERT_EQ(found.rods[0].bands.size(), 1u);
  EXPECT_NEAR(found.rods[0].bands[0].from, 2.0325246720, 1e-9);
  EXPECT_NEAR(found.rods[0].bands[0].to, 2.3373680000, 1e-9);
  MapRequest plane;
  plane.x = range.x;
  plane.y = along("d", 0.1, 0.5, 2);
  const Map over = map(family, plane);
  EXPECT_EQ(over.worst()[6].verdict, Verdict::unstable);
  EXPECT_EQ(over.worst()[12 + 6].verdict, Verdict::stable);
  CheckRequest twice;
  twice.omega = 1;
  EXPECT_TRUE(check(scene, twice).agrees());
  BenchRequest timed;
  timed.omega = 1;
  timed.case_limit = 0.1;
  const Bench rows = bench(scene, timed);
  ASSERT_EQ(rows.rods.size(), 1u);
  EXPECT_TRUE(rows.complete());
}

TEST(FromCpp, ARefusalNamesFieldFoundAndAllowed) {
  Request request;
  request.rpm = 300;
  request.rods = {"XY"};
  try {
    (void)steady(read_scene(scenes + "six_link.toml"), request);
    FAIL() << "not refused";
  } catch (const RequestError& error) {
    EXPECT_EQ(error.field, "rods");
    EXPECT_EQ(error.found, "\"XY\"");
    EXPECT_EQ(error.allowed, "AB, CD");
    EXPECT_STREQ(error.what(), "rods: found \"XY\", allowed: AB, CD");
  }
}

TEST(FromCpp, AnUnknownNumberOfAFunctionIsRefused) {
  EXPECT_THROW((void)four_bar_by_function().scene({{"length", 1}}), SceneError);
}

// The model of the last place was kept by the address of the object that asked: another object at the same address got
// the first one's model.
TEST(SweepScene, ASecondOneAtTheSameAddressHasModelsOfItsOwn) {
  const SceneSource source(scenes + "six_link.toml");
  Settings settings;
  settings.modes = 1;
  std::optional<SweepScene> scene;
  const auto gravity_of = [&](const char* gravity) {
    scene.emplace(source, std::vector<Override>{{"gravity", gravity}}, settings,
                  Axis{Axis::Kind::parameter, "AB.J", {40, 50}}, 30, 300);
    return scene->at(45).model->linkage()->gravity;
  };
  EXPECT_EQ(gravity_of("100.0"), 100);
  EXPECT_EQ(gravity_of("200.0"), 200);
}

}  // namespace
