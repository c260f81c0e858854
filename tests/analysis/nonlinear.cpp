// The motion without linearisation asked for from C++.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hb/analysis/machine_loads.hpp"
#include "hb/hb.hpp"
#include "lib/exact/rod_tension.hpp"

namespace {

using namespace hb;

const std::string nonlinear_scenes = HB_SOURCE_DIR "/tests/scenes/";
constexpr Only motion_alone{.steady = true, .stability = false, .reactions = false, .shape = false};
constexpr Only with_stability{.steady = true, .stability = true, .reactions = false, .shape = false};

// Pulled and pushed along, thin enough to bend far.
const char* const slider_crank_text =
    "[crank]\npivot = [0, 0]\nlength = 0.05\n[[dyad]]\non = \"crank\"\nbranch = 1\ncoupler = { name = \"rod\", length "
    "= "
    "0.3, elastic = { material = \"steel\", damping_ratio = 0.01, yield = 350e6, tensile = 500e6, endurance = 200e6, "
    "section = { shape = \"rectangle\", width = 0.016, height = 0.008 } } }\nslider = { name = \"piston\", mass = 0.3, "
    "guide = [0, 0] }\n";

Request at(double rpm, int modes, const Only& only) {
  Request request;
  request.rpm = rpm;
  request.modes = modes;
  request.only = only;
  return request;
}

TEST(NonlinearFromCpp, SteadyIsTheReferencesMotion) {
  const NonlinearSteady found =
      nonlinear_steady(read_scene(nonlinear_scenes + "six_link.toml"), at(900, 2, motion_alone));
  ASSERT_EQ(found.search, MotionSearch::found);
  EXPECT_EQ(found.given.rpm, 900);
  EXPECT_NEAR(found.rods[0].max_abs[0].value, 1.3632967558, 3e-7 * 1.3632967558);
  EXPECT_NEAR(found.rods[1].max_abs[0].value, 0.9390832626, 3e-7 * 0.9390832626);
}

// Motions are solved to 1e-9.
TEST(NonlinearFromCpp, AToleranceThatIsAskedForAndNotReachedIsSaid) {
  Request request = at(900, 2, motion_alone);
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  EXPECT_TRUE(nonlinear_steady(scene, request).shortfalls.empty());
  request.tolerance = 1e-14;
  const NonlinearSteady found = nonlinear_steady(scene, request);
  ASSERT_EQ(found.shortfalls.size(), 1u);
  EXPECT_NE(found.shortfalls[0].find("exceeds the tolerance 1.0e-14"), std::string::npos) << found.shortfalls[0];
}

TEST(NonlinearFromCpp, SweepOfAFunctionIsThatOfTheText) {
  const Linkage linkage = std::get<Linkage>(read_scene(nonlinear_scenes + "six_link.toml").model);
  const SceneFamily by_function(
      {{"J", 45}},
      [linkage](const std::vector<double>& values) {
        Linkage changed = linkage;
        Body& rod = changed.dyads[0].coupler;
        rod.elastic->second_moment = values[0];
        rod.inertia = rod.mass * rod.length * rod.length / 12 + rod.elastic->density * values[0] * rod.length;
        return changed;
      },
      read_scene(nonlinear_scenes + "six_link.toml").units);
  SweepRequest request;
  request.rpm = 700;
  request.modes = 1;
  request.only = motion_alone;
  request.x = along("AB.J", 40, 50, 3);
  const NonlinearAlong text = nonlinear_sweep(SceneSource(nonlinear_scenes + "six_link.toml"), request);
  request.x.path = "J";
  const NonlinearAlong function = nonlinear_sweep(by_function, request);
  ASSERT_EQ(text.branches.branches.size(), 1u);
  ASSERT_EQ(function.branches.branches.size(), 1u);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &a = text.branches.followed[k], &b = function.branches.followed[k];
    ASSERT_TRUE(a && b) << k;
    const double p = text.branches.branches[0].points[a->point].max_abs[0][0],
                 q = function.branches.branches[0].points[b->point].max_abs[0][0];
    EXPECT_NEAR(p, q, 1e-6 * p);
  }
}

// The range lies between the folds: nothing leads from the lower sheet to the upper one.
TEST(NonlinearFromCpp, ABranchIsFollowedFromAMotionThatIsGiven) {
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  SweepRequest request;
  request.modes = 1;
  request.only = motion_alone;
  request.x = along("rpm", 1488, 1495.5, 2);
  const auto largest = [](const NonlinearAlong& found) {
    double peak = 0;
    for (const NonlinearBranch& branch : found.branches.branches)
      for (const NonlinearPoint& point : branch.points) peak = std::max(peak, point.max_abs[0][0]);
    return peak;
  };
  EXPECT_LT(largest(nonlinear_sweep(scene, request)), 11);
  // Above the fold, and near enough to its neighbour for Newton's method.
  const NonlinearSteady above = nonlinear_steady(scene, at(1496, 1, motion_alone));
  ASSERT_EQ(above.search, MotionSearch::found);
  const NonlinearAlong found = nonlinear_sweep(scene, request, {.starts = {{1494, 1, above.motion.q}}});
  EXPECT_NEAR(largest(found), 15.89, 0.05);
  EXPECT_EQ(found.branches.branches.size(), 3u);  // the lower one; the upper one in both directions
}

// modes = "auto" was refused with the nonlinear theory.
TEST(NonlinearFromCpp, AutomaticModesAreAsManyAsTheErrorOfTheCutTakes) {
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  Request request = at(600, 1, motion_alone);
  request.modes = AutoModes{};
  request.tolerance = 1e-6;
  const NonlinearSteady found = nonlinear_steady(scene, request);
  ASSERT_EQ(found.search, MotionSearch::found);
  EXPECT_TRUE(found.shortfalls.empty());
  ASSERT_TRUE(found.cut_tolerance);
  EXPECT_EQ(*found.cut_tolerance, 1e-6);
  for (const NonlinearRod& rod : found.rods) {
    ASSERT_TRUE(rod.cut);
    EXPECT_LE(rod.cut->deflection, 1e-6);
    EXPECT_GE(rod.max_abs.size(), 2u);
  }
  const auto modes = static_cast<int>(found.rods[0].max_abs.size());
  const NonlinearSteady more = nonlinear_steady(scene, at(600, modes + 4, motion_alone));
  EXPECT_NEAR(found.rods[0].max_abs[0].value, more.rods[0].max_abs[0].value, 2e-6 * more.rods[0].max_abs[0].value);
}

TEST(NonlinearFromCpp, EverythingIsKnownOfThePointsOfASweepThatWereAskedFor) {
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  SweepRequest request;
  request.modes = 1;
  request.only = motion_alone;
  request.x = along("rpm", 1480, 1500, 2);
  const NonlinearAlong along = nonlinear_sweep(scene, request);
  ASSERT_TRUE(along.branches.followed.back());
  const BranchPlace place = *along.branches.followed.back();
  const NonlinearPoint& point = along.branches.branches[place.branch].points[place.point];
  const Settings settings = settings_of(at(1500, 1, {}), scene);
  const SceneModel model = make_model(scene, settings, false);
  const NonlinearResult all =
      nonlinear_answer(model, *point.motion, point.stability, along.branches.tolerance, settings);
  ASSERT_EQ(all.search, MotionSearch::found);
  EXPECT_NEAR(all.rods[0].max_abs[0].value, 15.867511, 1e-5 * 15.87);
  EXPECT_TRUE(all.forces && all.rods[0].shape && all.rods[0].stress);
  EXPECT_FALSE(all.stability);  // which the sweep was not asked for
}

// At low speed the axial force is that of the rigid mechanism.
TEST(NonlinearFromCpp, StressIsThatOfTheLinearTheoryAtLowSpeed) {
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  Request request = at(300, 2, {});
  const NonlinearSteady nonlinear = nonlinear_steady(scene, request);
  const SteadyResult linear = steady(scene, request);
  for (std::size_t r = 0; r < 2; ++r) {
    const RodStress &a = *nonlinear.rods[r].stress, &b = *linear.rods[r].stress;
    const double force = std::max(b.tension, b.compression);
    EXPECT_NEAR(a.tension, b.tension, 0.01 * force);
    EXPECT_NEAR(a.compression, b.compression, 0.01 * force);
    EXPECT_NEAR(a.bending, b.bending, 1e-3 * b.bending);
    EXPECT_NEAR(a.strain, b.strain, 0.01 * b.strain);
  }
}

// At low speed they are those of the linear theory, which takes other sums: body loads, the rigid axial force.
TEST(NonlinearFromCpp, CycleAndShakingForceAreThoseOfTheLinearTheoryAtLowSpeed) {
  const Scene scene = SceneSource(slider_crank_text, "rod.toml", ".").with({});
  const Request request = at(600, 3, {});
  const NonlinearSteady bent = nonlinear_steady(scene, request);
  const SteadyResult straight = steady(scene, request);
  const RodResult& rod = straight.rods[0];
  const Body& link = std::get<Linkage>(scene.model).dyads[0].coupler;
  const StressCycle cycle = stress_cycle(link, straight.model->coefficients.rods[0], straight.speed, rod.steady->q,
                                         rod.more_modes, rod.steady->error_bound);
  ASSERT_TRUE(bent.rods[0].cycle);
  const StressCycle& found = *bent.rods[0].cycle;
  EXPECT_NEAR(found.max_abs, cycle.max_abs, 1e-3 * cycle.max_abs);
  EXPECT_NEAR(found.amplitude, cycle.amplitude, 1e-3 * cycle.amplitude);
  EXPECT_NEAR(found.fatigue->factor.value, cycle.fatigue->factor.value, 1e-3 * cycle.fatigue->factor.value);
  EXPECT_GT(found.error, 0);
  EXPECT_LT(found.error, 0.01 * found.max_abs);
  const MachineLoads loads = *machine_loads(*straight.model, straight);
  for (double tau = 0; tau < 6; tau += 0.7) {
    const Eigen::VectorXd a = fourier::evaluate(bent.forces->frame.elastic, tau),
                          b = fourier::evaluate(loads.frame.elastic, tau),
                          rigid = fourier::evaluate(loads.frame.rigid, tau);
    EXPECT_NEAR((a - b).head<2>().norm(), 0, 1e-4 * loads.shaking_force.value) << tau;
    EXPECT_NEAR(a(2), b(2), 1e-3 * 2) << tau;
    EXPECT_GT((a - rigid).norm(), (a - b).norm());  // the comparison sees the bent rod
  }
}

// What accelerates the masses has no mean over a period: only the weight has.
TEST(NonlinearFromCpp, TheMeanShakingForceOfAStronglyBentMotionIsTheWeight) {
  const Scene scene = SceneSource(slider_crank_text, "rod.toml", ".").with({});
  const NonlinearSteady found = nonlinear_steady(scene, at(6000, 3, {}));
  ASSERT_EQ(found.search, MotionSearch::found);
  const auto& linkage = std::get<Linkage>(scene.model);
  const Body& rod = linkage.dyads[0].coupler;
  const double weight =
      9.80665 * (rod.mass + std::get<Slider>(linkage.dyads[0].closing).mass + linkage.crank.body.mass);
  ASSERT_TRUE(found.forces);
  const FrameForces& frame = found.forces->frame;
  const double size = fourier::max_abs(frame.elastic, 0).value;
  EXPECT_GT(fourier::max_abs(frame.elastic, 1).value, 1.5 * fourier::max_abs(frame.rigid, 1).value);
  EXPECT_NEAR(frame.elastic.c(0, 0).real(), 0, 1e-6 * size);
  EXPECT_NEAR(frame.elastic.c(1, 0).real(), -weight, 1e-6 * size);
}

// Against every place of a fine grid, from the axial force at the exact model's own points.
TEST(NonlinearFromCpp, TheCycleOfABentRodIsTheWorstOfAllPlacesFibresAndAngles) {
  const Scene scene = SceneSource(slider_crank_text, "rod.toml", ".").with({});
  constexpr int modes = 6;
  const NonlinearSteady found = nonlinear_steady(scene, at(6000, modes, {}));
  ASSERT_EQ(found.search, MotionSearch::found);
  const auto& linkage = std::get<Linkage>(scene.model);
  const Body& rod = linkage.dyads[0].coupler;
  const ExactModel exact(linkage, {{found.rods[0].link, modes}}, 200);
  constexpr Eigen::Index N = 1024;
  const std::vector<FourierSeries> q = {found.rods[0].q};
  const RitzSamples motion = ritz_samples(q, found.speed, N);
  const RodTension tension = rod_tensions(exact, found.speed, CrankAngles(linkage, N), motion)[0];
  double largest = 0, widest = 0;
  for (Eigen::Index i = 0; i < tension.x.size(); ++i)
    for (const int side : {1, -1}) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (Eigen::Index j = 0; j < N; ++j) {
        double slope = 0, curvature = 0;
        for (Eigen::Index k = 0; k < modes; ++k) {
          const double wave = static_cast<double>(k + 1) * 3.14159265358979323846 / rod.length;
          slope += wave * std::cos(wave * tension.x(i)) * motion.q(k, j);
          curvature -= wave * wave * std::sin(wave * tension.x(i)) * motion.q(k, j);
        }
        const double bending = rod.elastic->youngs_modulus * curvature / std::sqrt(1 - slope * slope);
        const double sigma = tension.N(i, j) / rod.elastic->area + side * bending * rod.elastic->section_height / 2;
        low = std::min(low, sigma);
        high = std::max(high, sigma);
      }
      largest = std::max({largest, high, -low});
      widest = std::max(widest, (high - low) / 2);
    }
  const StressCycle& cycle = *found.rods[0].cycle;
  // The grid leaves out the modes beyond, of which the cycle has the static part.
  EXPECT_NEAR(cycle.max_abs, largest, 2e-3 * largest);
  EXPECT_NEAR(cycle.amplitude, widest, 2e-3 * widest);
  EXPECT_LT(cycle.max_abs, found.rods[0].stress->axial + found.rods[0].stress->bending);
}

TEST(NonlinearFromCpp, TellsHowFarTheFirstBranchHasCome) {
  std::size_t told = 0, passed = 0;
  const NonlinearSweepOptions options{.advanced = [&](std::size_t values) { ++told, passed += values; }};
  SweepRequest request;
  request.modes = 1;
  request.only = with_stability;
  request.x = along("rpm", 300, 500, 21);
  const NonlinearAlong found = nonlinear_sweep(read_scene(nonlinear_scenes + "six_link.toml"), request, options);
  ASSERT_TRUE(found.branches.followed.back());
  EXPECT_GT(told, 3u);
  EXPECT_GE(passed, 15u);  // those behind the last step but one
  EXPECT_LE(passed, 20u);
}

TEST(NonlinearFromCpp, StopEndsWithWhatIsThere) {
  int asked = 0;
  const NonlinearSweepOptions options{.stop = [&] { return ++asked > 200; }};
  SweepRequest request;
  request.modes = 2;
  request.only = with_stability;
  request.x = along("rpm", 300, 1500, 13);
  const NonlinearAlong found = nonlinear_sweep(read_scene(nonlinear_scenes + "six_link.toml"), request, options);
  EXPECT_TRUE(found.branches.stopped);
  EXPECT_FALSE(found.branches.shortfalls.empty());
  ASSERT_EQ(found.branches.branches.size(), 1u);
  EXPECT_EQ(found.branches.branches[0].end, BranchEnd::stopped);
  EXPECT_FALSE(found.branches.followed.back());
}

// Asked during the linear part already, which comes first.
TEST(NonlinearFromCpp, StopInTheLinearPartLeavesTheBranchesOut) {
  int asked = 0;
  const NonlinearSweepOptions options{.stop = [&] { return ++asked > 2; }};
  SweepRequest request;
  request.modes = 2;
  request.only = with_stability;
  request.x = along("rpm", 300, 1500, 121);
  const NonlinearAlong found = nonlinear_sweep(read_scene(nonlinear_scenes + "six_link.toml"), request, options);
  EXPECT_TRUE(found.branches.stopped);
  EXPECT_TRUE(found.branches.branches.empty());
  EXPECT_FALSE(found.branches.shortfalls.empty());
  EXPECT_LT(asked, 200);  // of 121 speeds and thousands of points of a branch
}

TEST(NonlinearFromCpp, CheckThatTakesTooLongSaysWhichLimitEndedIt) {
  CheckRequest request;
  request.rpm = 600;
  request.modes = 3;
  request.case_limit = 1e-3;
  const NonlinearChecks checks = nonlinear_check(read_scene(nonlinear_scenes + "six_link.toml"), request);
  ASSERT_EQ(checks.speeds.size(), 1u);
  EXPECT_FALSE(checks.reached());
  EXPECT_NE(checks.speeds[0].not_compared.find("limit of 0.001 s"), std::string::npos) << checks.speeds[0].not_compared;
  EXPECT_NE(checks.speeds[0].not_compared.find("6 modes"), std::string::npos) << checks.speeds[0].not_compared;
}

TEST(NonlinearFromCpp, CheckAgreesOverSeveralSpeeds) {
  CheckRequest request;
  request.rpms = {600, 1200};
  request.modes = 1;
  const NonlinearChecks found = nonlinear_check(read_scene(nonlinear_scenes + "six_link.toml"), request);
  ASSERT_EQ(found.speeds.size(), 2u);
  EXPECT_TRUE(found.agrees());
  for (const NonlinearCheck& check : found.speeds) {
    ASSERT_EQ(check.rods.size(), 2u);
    EXPECT_LE(check.rods[0].q.difference, 1e-7);
    ASSERT_TRUE(check.exponents);
  }
}

// A rod of 1 mm^4 folds far below 1500 rpm.
TEST(NonlinearFromCpp, WhereNoMotionIsFoundItSaysHowFarItCame) {
  Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  std::get<Linkage>(scene.model).dyads[0].coupler.elastic->second_moment = 1;
  const NonlinearSteady found = nonlinear_steady(scene, at(3000, 1, motion_alone));
  ASSERT_EQ(found.search, MotionSearch::none);
  EXPECT_FALSE(found.shortfalls.empty());
  ASSERT_TRUE(found.last_speed);
  EXPECT_GT(*found.last_speed, 0);
  EXPECT_LT(*found.last_speed, 3000 * 3.1416 / 30);
  EXPECT_GT(found.last_max_abs[0][0], 0);
  EXPECT_NE(found.why.find("rpm"), std::string::npos) << found.why;
}

// A crank and rocker, metres, whose rod sags under its own weight.
Scene sagging(double youngs_modulus, double pivot) {
  return parse_scene(fmt::format(R"(
gravity = 9.81
[crank]
pivot = [0, 0]
length = 0.1
[[dyad]]
on = "crank"
coupler = {{ name = "rod", length = 0.3, mass = 0.1, elastic = {{ E = {}, area = 20e-6, J = 30e-12, damping_internal = 1e-4 }} }}
rocker = {{ name = "rocker", pivot = [{}, 0], length = 0.2, mass = 0.5, com = [0.1, 0], inertia_pivot = 0.01 }}
branch = -1
)",
                                 youngs_modulus, pivot),
                     "sagging.toml");
}

TEST(NonlinearFromCpp, AFoldedRodIsNamedWithItsCrankAngleAndSpeed) {
  const NonlinearSteady found = nonlinear_steady(sagging(1e8, 0.38), at(30, 1, motion_alone));
  EXPECT_EQ(found.search, MotionSearch::none);
  const std::string said = fmt::format("{}", fmt::join(found.shortfalls, "; "));
  EXPECT_NE(said.find("at 30 rpm the linear answer's rod is bent to a slope of 3.7"), std::string::npos) << said;
  EXPECT_NE(said.find("at crank angle"), std::string::npos) << said;
}

// Pivots 5 mm nearer than the straight links reach.
TEST(NonlinearFromCpp, ADeadCentreOfTheBentMechanismIsNamedWithItsCrankAngleAndSpeed) {
  const NonlinearSteady found = nonlinear_steady(sagging(2e9, 0.395), at(30, 1, motion_alone));
  EXPECT_EQ(found.search, MotionSearch::none);
  const std::string said = fmt::format("{}", fmt::join(found.shortfalls, "; "));
  EXPECT_NE(said.find("at 30 rpm"), std::string::npos) << said;
  EXPECT_NE(said.find("rod and rocker does not close with its links bent, at crank angle"), std::string::npos) << said;
}

TEST(NonlinearFromCpp, RequestsThatCannotBeMetAreRefused) {
  const Scene scene = read_scene(nonlinear_scenes + "six_link.toml");
  EXPECT_THROW((void)nonlinear_steady(read_scene(nonlinear_scenes + "mathieu.toml"), Request{.omega = 1}),
               RequestError);
  EXPECT_THROW((void)nonlinear_steady(scene, at(300, 1, motion_alone), {.turns = 3}), RequestError);
  CheckRequest march;
  march.rpm = 300;
  march.march = true;
  EXPECT_THROW((void)nonlinear_check(scene, march), RequestError);
}

}  // namespace
