// `--theory nonlinear` as its users meet it: branches, folds, jumps, the cross-check, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;

class Nonlinear : public CommandTest {
 protected:
  Json document(const std::string& arguments, int status = 0) const {
    const CommandResult result = hb(arguments + " --theory nonlinear --json");
    EXPECT_EQ(result.status, status) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
  void expect_refused(const std::string& arguments, const std::string& words) const {
    const CommandResult result = hb(arguments + " --out answer");
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "answer"));
  }
};

// Independent values of the same equations: action of the whole mechanism, its gradient by automatic differentiation.
TEST_F(Nonlinear, SweepPassesTheFoldsAndArrivesAtTheReferencesMotion) {
  const Json found = document("sweep " + scene("six_link") + " --rpm 1440:1500:20 --modes 1 --only steady,stability");
  ASSERT_EQ(found["folds"].size(), 2u);
  EXPECT_NEAR(found["folds"][0], 1496, 0.5);
  EXPECT_NEAR(found["folds"][1], 1486, 0.5);
  for (const Json& fold : found["fold_details"]) EXPECT_LE(fold["error"], 1e-8 * 1500);
  EXPECT_TRUE(found["bifurcations"].empty());

  const Json& branch = found["branches"][0];
  const std::size_t points = branch["rpm"].size();
  ASSERT_GT(points, 20u);
  for (const char* key : {"omega", "growth_rate", "verdict", "error_bound"})
    ASSERT_EQ(branch[key].size(), points) << key;
  const Json& peaks = branch["rods"]["AB"]["max_abs"];
  ASSERT_EQ(peaks.size(), points);
  EXPECT_EQ(branch["rpm"].back(), 1500.0);
  EXPECT_NEAR(peaks.back()[0], 15.867511, 1e-5 * 15.867511);
  EXPECT_NEAR(branch["rods"]["CD"]["max_abs"].back()[0], 5.885010, 1e-5 * 15.867511);

  // Unstable between the folds and nowhere else, but for the points that are too near to tell.
  std::size_t unstable = 0;
  for (std::size_t k = 0; k < points; ++k) {
    const double rpm = branch["rpm"][k], peak = peaks[k][0];
    const bool between = peak > 11.2 && peak < 15.2;
    if (branch["verdict"][k] == "unstable") {
      ++unstable;
      EXPECT_TRUE(peak > 10.9 && peak < 15.4) << rpm << " " << peak;
    } else {
      EXPECT_FALSE(between) << rpm << " " << peak;
    }
  }
  EXPECT_GT(unstable, 3u);
}

TEST_F(Nonlinear, SweepSaysTheJumpsAndTheVerdictAtEachSpeed) {
  const Json found = document("sweep " + scene("six_link") + " --rpm 1470:1500:10 --modes 1 --only steady,stability");
  ASSERT_EQ(found["jumps"].size(), 2u);
  EXPECT_EQ(found["jumps"][0]["direction"], "downward");
  EXPECT_EQ(found["jumps"][0]["rpm"], found["folds"][1]);
  EXPECT_EQ(found["jumps"][1]["direction"], "upward");
  EXPECT_EQ(found["jumps"][1]["rpm"], found["folds"][0]);
  // From the lower sheet to the upper one and back.
  ASSERT_EQ(found["jumps"][1]["to"].size(), 1u);
  EXPECT_NEAR(found["jumps"][1]["to"][0]["AB"]["max_abs"][0], 15.9, 0.1);
  EXPECT_LT(found["jumps"][0]["to"][0]["AB"]["max_abs"][0], 9);

  EXPECT_EQ(found["verdict"], Json({"stable", "stable", "stable", "stable"}));
  EXPECT_EQ(found["system"]["verdict"], found["verdict"]);
  // At 1490 rpm the first passage is on the lower sheet.
  const std::size_t place = found["system"]["point"][2];
  EXPECT_EQ(found["branches"][0]["rpm"][place], 1490.0);
  EXPECT_LT(found["branches"][0]["rods"]["AB"]["max_abs"][place][0], 10);
  // What the linear sweep says stays beside it.
  EXPECT_EQ(found["linear_verdict"].size(), 4u);
  EXPECT_EQ(found["rods"]["AB"]["max_abs"].size(), 4u);
  EXPECT_TRUE(found["rods"]["AB"].contains("theory_error"));
}

// References into the document were kept while it grew: without stability the folds went to freed memory.
TEST_F(Nonlinear, FoldsAreTheSameWhereverTheBranchBegins) {
  const std::string what = " --modes 1 --only steady";
  const Json one = document("sweep " + scene("six_link") + " --rpm 1460:1500:40" + what),
             other = document("sweep " + scene("six_link") + " --rpm 1475:1510:35" + what);
  ASSERT_EQ(one["folds"].size(), 2u);
  ASSERT_EQ(other["folds"].size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(one["folds"][k], other["folds"][k], 2e-8 * 1500);
  EXPECT_FALSE(one.contains("verdict"));
}

TEST_F(Nonlinear, SweepAlongASceneNumberIsTheSteadyMotionOfEachScene) {
  const std::string common = scene("six_link") + " --modes 1 --only steady";
  const Json found = document("sweep " + common + " --rpm 1000 --x AB.J=40:50:5");
  const Json& branch = found["branches"][0];
  for (const double J : {40, 45, 50}) {
    const Json steady = document("steady " + common + " --rpm 1000 --set AB.J=" + std::to_string(J));
    bool passed = false;
    for (std::size_t k = 0; k < branch["x"].size(); ++k) {
      if (branch["x"][k] != J) continue;
      passed = true;
      for (const char* rod : {"AB", "CD"}) {
        const double expected = steady["rods"][rod]["q"]["max_abs"][0];
        EXPECT_NEAR(branch["rods"][rod]["max_abs"][k][0], expected, 1e-7 * expected) << rod << " " << J;
      }
    }
    EXPECT_TRUE(passed) << J;
  }
}

TEST_F(Nonlinear, StressesOfABranchAreThoseOfItsMotions) {
  const std::string common = scene("six_link") + " --modes 2 --only steady,shape";
  const Json found = document("sweep " + common + " --rpm 900:1000:100");
  const Json& branch = found["branches"][0];
  const Json steady = document("steady " + common + " --rpm 1000");
  std::size_t at = 0, between = 0;
  for (std::size_t k = 0; k < branch["rpm"].size(); ++k) {
    if (branch["rpm"][k] == 1000.0) at = k;
    if (!branch["asked"][k]) between = k;
  }
  for (const char* rod : {"AB", "CD"}) {
    const Json &along = branch["rods"][rod], &one = steady["rods"][rod];
    const auto near = [](const Json& value, const Json& expected) {
      EXPECT_NEAR(value.get<double>(), expected.get<double>(), 1e-6 * expected.get<double>());
    };
    near(along["deflection"][at], one["deflection"]["max_abs"]);
    near(along["stress"]["axial"][at], one["stress"]["axial"]);
    near(along["stress"]["bending"][at], one["stress"]["bending"]);
    if (between > 0) {
      EXPECT_TRUE(along["stress"]["bending"][between].is_null());
    }
    EXPECT_FALSE(along["stress"].contains("mean"));  // no section is given
  }
}

TEST_F(Nonlinear, SweepWritesItsBranchesAndDrawsThem) {
  const CommandResult result =
      hb("sweep " + scene("six_link") +
         " --rpm 600:700:50 --modes 1 --only steady,stability --theory nonlinear --out answer");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("Motion without linearisation"), std::string::npos);
  const std::string table = read(folder_ / "answer/branches_AB.csv");
  EXPECT_NE(table.find("max |q_1|"), std::string::npos);
  EXPECT_NE(read(folder_ / "answer/bifurcations.csv").find("jump"), std::string::npos);
  EXPECT_TRUE(Json::parse(read(folder_ / "answer/sweep.json")).contains("branches"));
  EXPECT_NE(read(folder_ / "answer/branches_AB.svg").find("dashed unstable"), std::string::npos);
}

// The table said "every 3th point".
TEST_F(Nonlinear, TheTableSaysWhichOfItsPointsItShows) {
  const std::string words = hb("sweep " + scene("six_link") +
                               " --rpm 1440:1520:10 --modes 1 --only steady,stability --theory nonlinear --no-search")
                                .out;
  EXPECT_NE(words.find("(every 3rd point and the last; "), std::string::npos) << words;
}

TEST_F(Nonlinear, CheckByIntegrationInTimeAgrees) {
  const Json found = document("check " + scene("six_link") + " --rpm 1500 --modes 1");
  EXPECT_EQ(found["agrees"], true);
  for (const char* rod : {"AB", "CD"}) {
    EXPECT_EQ(found["rods"][rod]["agrees"], true) << rod;
    EXPECT_LE(found["rods"][rod]["q_difference"], 1e-6);
    EXPECT_LE(found["rods"][rod]["q_difference"], found["rods"][rod]["q_allowed"]);
  }
  EXPECT_LE(found["system"]["exponent_difference"], 1e-2);
  EXPECT_EQ(found["system"]["shooting"]["verdict"], "stable");
  EXPECT_GT(found["seconds"]["harmonic_balance"], 0);
}

// Modes for 1e-10 of the deflection took the integration longer than its limit.
TEST_F(Nonlinear, CheckWithAutomaticModesComesToAnEnd) {
  const Json found = document("check " + scene("six_link") + " --rpm 300 --modes auto");
  EXPECT_EQ(found["agrees"], true);
  for (const char* rod : {"AB", "CD"}) {
    EXPECT_EQ(found["rods"][rod]["agrees"], true) << rod;
    EXPECT_LE(found["rods"][rod]["q_allowed"], 1e-7);
  }
}

// Beyond the doubling near 1576 rpm.
TEST_F(Nonlinear, MotionsOfTwoTurnsAreThoseOfTheIntegration) {
  const Json found = document("check " + scene("six_link") + " --rpm 1585 --modes 1 --period 2 --tol 1e-6");
  EXPECT_EQ(found["agrees"], true) << found;
  EXPECT_LE(found["rods"]["AB"]["q_difference"], 1e-6);
  EXPECT_EQ(found["system"]["shooting"]["verdict"], "stable");
  const Json steady =
      document("steady " + scene("six_link") + " --rpm 1585 --modes 1 --period 2 --only steady --tol 1e-7");
  // Harmonics of half the crank's speed.
  const Json& fourier = steady["rods"]["AB"]["q"]["fourier"][0];
  EXPECT_GT(std::hypot(double(fourier[1][0]), double(fourier[1][1])), 1e-3);
}

TEST_F(Nonlinear, SweepFollowsTheDoubledBranch) {
  const Json found =
      document("sweep " + scene("six_link") + " --rpm 1560:1590:10 --modes 1 --period 2 --only steady,stability");
  // The doubled motion doubles again.
  ASSERT_EQ(found["bifurcations"].size(), 2u);
  for (const std::size_t k : {0, 1}) {
    EXPECT_EQ(found["bifurcations"][k]["kind"], "-1");
    EXPECT_EQ(found["bifurcations"][k]["branch"], k);
  }
  ASSERT_EQ(found["branches"].size(), 2u);
  const Json& doubled = found["branches"][1];
  EXPECT_EQ(doubled["period"], 2);
  EXPECT_NEAR(doubled["rpm"][0], found["bifurcations"][0]["rpm"], 1e-3);
  EXPECT_EQ(doubled["rpm"].back(), 1590.0);
  EXPECT_EQ(found["branches"][0]["verdict"].back(), "unstable");
}

// The range begins beyond the fold below, so that neither of its ends leads there.
TEST_F(Nonlinear, SweepStartsFromAMotionThatSteadyWrote) {
  ASSERT_EQ(hb("steady " + scene("six_link") +
               " --rpm 1490 --modes 1 --only steady --theory nonlinear --out lower --no-plots")
                .status,
            0);
  const std::string range = " --rpm 1488:1492:2 --modes 1 --only steady";
  const Json without = document("sweep " + scene("six_link") + range),
             with = document("sweep " + scene("six_link") + range + " --start lower/steady.json");
  EXPECT_EQ(with["branches"].size(), without["branches"].size());  // the branch from below passes it already
  expect_refused("sweep " + scene("six_link") + range + " --start lower/steady.json", "with the linear theory");
  expect_refused(
      "sweep " + scene("six_link") + " --rpm 600:700:50 --modes 1 --theory nonlinear --start lower/steady.json",
      "600 to 700");
  expect_refused(
      "sweep " + scene("six_link") + " --rpm 1488:1492:2 --modes 2 --theory nonlinear --start lower/steady.json",
      "2 asked for");
}

TEST_F(Nonlinear, TimeLimitEndsWithWhatIsThere) {
  const Json found = document("sweep " + scene("six_link") + " --rpm 900:2400:50 --modes 3 --time-limit 2", 3);
  EXPECT_EQ(found["stopped"], true);
  EXPECT_EQ(found["status"], "tolerance not reached");
  EXPECT_NE(found["notes"].dump().find("--time-limit 2"), std::string::npos) << found["notes"];
  const Json steady = document("steady " + scene("six_link") + " --rpm 1500 --modes 4 --time-limit 0.001", 3);
  EXPECT_EQ(steady["found"], false);
}

TEST_F(Nonlinear, TimeLimitInTheLinearPartGivesTheSpeedsThatAreThere) {
  const Json found =
      document("sweep " + scene("six_link") + " --rpm 300:1500:0.1 --modes 5 --no-search --time-limit 1", 3);
  EXPECT_EQ(found["stopped"], true);
  EXPECT_TRUE(found["branches"].empty());
  const Json& growth = found["rods"]["AB"]["growth_rate"];
  const auto answered = std::count_if(growth.begin(), growth.end(), [](const Json& value) { return !value.is_null(); });
  EXPECT_GT(answered, 0);
  EXPECT_LT(answered, static_cast<std::ptrdiff_t>(growth.size()));
  EXPECT_NE(found["notes"].dump().find("--time-limit 1"), std::string::npos) << found["notes"];
}

// Beyond its fold the branch of a lightly damped four-bar grows until the coupler stands across its chord.
TEST_F(Nonlinear, ARodThatFoldsOnABranchIsSaidWithCrankAngleAndSpeed) {
  std::ofstream(folder_ / "light.toml") << R"(
gravity = 0
[units]
length = "mm"
angle = "deg"
[crank]
pivot = [0, 0]
length = 40
[[dyad]]
on = "crank"
coupler = { name = "coupler", length = 160, mass = 0.04, elastic = { E = 21e7, area = 10, J = 8, damping_internal = 3e-4 } }
rocker = { name = "rocker", pivot = [200, 0], length = 100, mass = 0.1, com = [50, 0], inertia_pivot = 400 }
branch = 1
)";
  const Json found =
      document("sweep light.toml --modes 1 --rpm 2000:9000:7000 --only steady --no-search --tol 1e-4", 3);
  const std::string notes = found["notes"].dump();
  EXPECT_NE(notes.find("branch 1 ends at rpm = 3049."), std::string::npos) << notes;
  EXPECT_NE(notes.find("coupler is bent to a slope of 1 at crank angle 279."), std::string::npos) << notes;
  // Largest q_1 where the slope pi q_1/l is 1.
  const Json& branch = found["branches"][0]["rods"]["coupler"]["max_abs"];
  EXPECT_NEAR(double(branch.back()[0]), 160 / std::numbers::pi, 0.1);
}

TEST_F(Nonlinear, BenchComparesWithIntegration) {
  const Json found = document("bench " + scene("slider_crank") + " --rpm 1500 --modes 1");
  const Json& system = found["rods"]["system"];
  EXPECT_LE(system["reference_error"], 1e-8);
  double best = 1;
  for (const Json& row : system["rows"])
    if (std::string(row["method"]).starts_with("harmonic balance")) best = std::min<double>(best, row["error"]);
  EXPECT_LE(best, 1e-7);
}

TEST_F(Nonlinear, WhatTheTheoryCannotDoIsRefusedInWords) {
  expect_refused(
      "map " + scene("mathieu") + " --x omega=1:2:4 --y hill.stiffness.1.cos.0.0=0.1:0.5:4 --theory nonlinear",
      "allowed: linear");
  expect_refused("tune " + scene("six_link") + " --minimise mass --vary AB.J=40:50 --rpm 300 --theory nonlinear",
                 "allowed: linear");
  expect_refused("sweep " + scene("mathieu") + " --omega 1:2:0.5 --theory nonlinear", "the system is linear");
  expect_refused("check " + scene("mathieu") + " --omega 1 --theory nonlinear", "the system is linear");
  std::ofstream(folder_ / "thick.toml") << R"(
[crank]
pivot = [0, 0]
length = 0.1
[[dyad]]
on = "crank"
coupler = { name = "rod", length = 0.5, mass = 1, elastic = { E = 2e11, area = 1e-3, J = 1e-8, shear = { G = 8e10, k = 0.83 } } }
slider = { name = "piston", mass = 0.5, guide = [0, 0], direction = 0 }
branch = 1
)";
  expect_refused("steady thick.toml --rpm 300 --theory nonlinear", "shear of rod");
  expect_refused("sweep thick.toml --rpm 300:400:50 --theory nonlinear", "shear of rod");
  expect_refused("steady " + scene("six_link") + " --rpm 300 --theory quadratic", "allowed: linear, nonlinear");
  expect_refused("sweep " + scene("six_link") + " --rpm 300:400:50 --period 2", "allowed: with --theory nonlinear");
  expect_refused("sweep " + scene("six_link") + " --rpm 300:400:50 --theory nonlinear --period 3",
                 "--period: found 3, allowed: 1, 2, 4, 8");
  expect_refused("check " + scene("six_link") + " --rpm 300 --theory nonlinear --march", "--march");
}

}  // namespace
