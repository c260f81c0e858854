// `hb map` as its users meet it: documents, files, exit codes.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Map : public CommandTest {
 protected:
  Json document(const std::string& arguments, int expected_status = 0) const {
    const CommandResult result = hb("map " + arguments + " --json");
    EXPECT_EQ(result.status, expected_status) << result.err;
    return Json::parse(result.out);
  }
  void refused(const std::string& arguments, const std::string& words) const {
    const CommandResult result = hb("map " + arguments + " --out out --no-plots");
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(words), std::string::npos) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(num_entries(folder_), 0u) << arguments;
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

const std::string swing = "hill.stiffness.1.cos.0.0";

TEST_F(Map, SaysBeforehandThatItsPointsWillNotFit) {
  const std::string limit = "ulimit -v 400000;", flags = " --modes 1 --time-limit 0.2 --x rpm=300:1900:";
  const std::string large = scene("six_link") + flags + "4000 --y '*.J=30:60:4000'";
  EXPECT_NE(hb("map " + large, limit).err.find("hb map: the map needs about 1.2 GB"), std::string::npos);
  const std::string small = scene("six_link") + flags + "40 --y '*.J=30:60:40'";
  EXPECT_EQ(hb("map " + small, limit).err.find("needs about"), std::string::npos);
}

TEST_F(Map, JsonHasTheKeysOfTheContract) {
  const Json found = document(scene("six_link") + " --x rpm=300:1900:7 --y '*.J=30:60:4' --modes 1");
  EXPECT_EQ(found["x"]["path"], "rpm");
  EXPECT_EQ(found["x"]["values"].size(), 7u);
  EXPECT_EQ(found["y"]["path"], "*.J");
  EXPECT_EQ(found["y"]["values"][3], 60.0);
  ASSERT_EQ(found["growth_rate"].size(), 4u);
  ASSERT_EQ(found["verdict"].size(), 4u);
  for (std::size_t j = 0; j < 4; ++j) {
    ASSERT_EQ(found["growth_rate"][j].size(), 7u);
    for (std::size_t i = 0; i < 7; ++i) {
      const double growth = found["growth_rate"][j][i];
      EXPECT_EQ(found["verdict"][j][i], growth < 0 ? "stable" : "unstable");
      // The worst of the rods.
      double worst = -HUGE_VAL;
      for (const Json& rod : found["rods"]) worst = std::max(worst, rod["growth_rate"][j][i].get<double>());
      EXPECT_EQ(growth, worst);
    }
  }
  ASSERT_FALSE(found["boundaries"].empty());
  for (const Json& curve : found["boundaries"]) {
    EXPECT_TRUE(curve["kind"] == "+1" || curve["kind"] == "-1" || curve["kind"] == "complex");
    ASSERT_FALSE(curve["points"].empty());
    for (const Json& point : curve["points"]) EXPECT_EQ(point.size(), 2u);
  }
}

// The E of CD leaves AB what it is: its row is computed once, however many there are.
TEST_F(Map, ARodThatANumberDoesNotMeetIsComputedOnOneLine) {
  const std::string plane = scene("six_link") + " --modes 2 --x rpm=1500:2100:4 --y CD.E=15e7:25e7:";
  const Json rods = document(plane + "3")["rods"];
  const Json &AB = rods["AB"]["growth_rate"], &CD = rods["CD"]["growth_rate"];
  ASSERT_EQ(AB.size(), 3u);
  for (std::size_t j = 1; j < 3; ++j) {
    EXPECT_EQ(AB[j], AB[0]);
    EXPECT_NE(CD[j], CD[0]);
  }
  const auto places = [&](const std::string& rows) {
    const std::string out = hb("map " + plane + rows + " --rods AB --stats").err;
    const std::size_t at = out.find("exponents at ");
    EXPECT_NE(at, std::string::npos) << out;
    return at == std::string::npos ? "" : out.substr(at, out.find(" places", at) - at);
  };
  EXPECT_EQ(places("3"), places("24"));
}

// Of the rods asked for: the first line says so.
TEST_F(Map, OfSomeOfTheRodsItSaysOfWhich) {
  const std::string range =
      scene("six_link") + " --no-boundaries --only stability --x rpm=2000:2500:3 --y CD.J=40:50:2";
  EXPECT_NE(hb("map " + range).out.find(": UNSTABLE at 100 % of the points because of AB\n"), std::string::npos);
  EXPECT_NE(hb("map " + range + " --rods CD").out.find(": CD alone: stable at all points\n"), std::string::npos);
}

// Scene numbers are interpolated: near zero a stiffness is what is left of numbers ten times as large.
TEST_F(Map, RoundingOfInterpolatedNumbersIsInTheErrors) {
  std::ofstream(folder_ / "strutt.toml")
      << "[hill]\nmass = [[1]]\nstiffness = [{ harmonic = 0, cos = [[1]], scale = 1 }, { harmonic = 2, cos = [[-2]], "
         "scale = 0.1 }]\n[analysis]\nomega = 1\n";
  const Json found =
      document("strutt.toml --no-boundaries --x hill.stiffness.0.scale=-1:10:45 --y hill.stiffness.1.scale=0:5:21");
  EXPECT_EQ(found["x"]["values"][4], 0.0);
  EXPECT_EQ(found["verdict"][0][4], "undecided");  // q'' = 0
  EXPECT_LE(std::abs(found["growth_rate"][0][4].get<double>()), found["growth_error"][0][4].get<double>());
}

// A map said nothing of the theory that its verdicts are by.
TEST_F(Map, SaysWhereTheLinearTheoryHoldsAsOneSpeedDoes) {
  const std::string rod = scene("six_link") + " --modes 2 --no-boundaries ";
  const std::string rpm = "rpm=300:1200:4", second_moment = "AB.J=40:50:3";
  const Json by_x = document(rod + "--x " + rpm + " --y " + second_moment),
             by_y = document(rod + "--x " + second_moment + " --y " + rpm);
  ASSERT_EQ(by_x["theory_sample"].size(), 4u);  // the corners of a small grid
  for (const Json& place : by_x["theory_sample"]) {
    const std::string at = " --rpm " + place["x"].dump() + " --set AB.J=" + place["y"].dump();
    const Json steady = Json::parse(hb("steady " + scene("six_link") + " --modes 2 --json" + at).out);
    for (const char* name : {"AB", "CD"}) {
      const double expected = steady["rods"][name]["theory_error"];
      EXPECT_NEAR(place["theory_error"][name], expected, 1e-6 * expected) << at;
    }
    const double growth = steady["growth_theory_error"];
    EXPECT_NEAR(place["growth_theory_error"], growth, 1e-3 * growth + 1e-9) << at;
    const auto same = [&](const Json& other) { return other["x"] == place["y"] && other["y"] == place["x"]; };
    const auto turned = std::ranges::find_if(by_y["theory_sample"], same);
    ASSERT_NE(turned, by_y["theory_sample"].end());
    EXPECT_EQ((*turned)["theory_error"], place["theory_error"]);
  }
  const std::string words = hb("map " + rod + "--x " + rpm + " --y " + second_moment).out;
  EXPECT_NE(words.find("by the linear theory, whose error at 4 points, corners included, is up to "), std::string::npos)
      << words;
}

TEST_F(Map, WarnsBeyondTheLinearTheoryInWordsAndPicture) {
  const std::string fast = scene("six_link") + " --modes 2 --no-boundaries --x rpm=300:3000:4 --y AB.J=40:50:3 ";
  const CommandResult result = hb("map " + fast + "--out out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("WARNING: AB: beyond the linear theory at 2 of 4 points looked at ("), std::string::npos)
      << result.out;
  EXPECT_NE(read(folder_ / "out/map.svg").find("beyond it at 2 of 4 points looked at"), std::string::npos);
  EXPECT_NE(read(folder_ / "out/map_theory.csv").find("rpm,AB.J,theory error AB,theory error CD,"), std::string::npos)
      << read(folder_ / "out/map_theory.csv");
  const Json found = document(fast);
  EXPECT_EQ(found["warnings"].size(), 2u) << found["warnings"];
  const Json none = document(fast + "--only stability");
  EXPECT_FALSE(none.contains("theory_sample"));
  EXPECT_EQ(none["warnings"][0], "AB: theory not judged: q was not computed");
  EXPECT_NE(hb("map " + fast + "--only stability").out.find("theory not judged"), std::string::npos);
  const Json hill = document(scene("mathieu") + " --x omega=1:3:4 --y " + swing + "=0.1:1:4");
  EXPECT_FALSE(hill.contains("theory_sample") || hill.contains("warnings"));
}

// At every place what `hb steady` says there, whichever axis is the speed.
TEST_F(Map, StressesOfItsPlacesAreThoseOfOneSpeed) {
  const std::string rod =
      scene("slider_crank_units") + " --modes 3 --set rod.yield=\"250 MPa\" --set rod.endurance=\"100 MPa\" ";
  const std::string rpm = "rpm=1000:3000:3", mass = "piston.mass=0.3:0.5:2";
  const Json by_x = document(rod + "--no-boundaries --stress --x " + rpm + " --y " + mass),
             by_y = document(rod + "--no-boundaries --stress --x " + mass + " --y " + rpm);
  const CommandResult steady = hb("steady " + rod + "--rpm 2000 --set piston.mass=0.5 --json");
  const Json one = Json::parse(steady.out)["rods"]["rod"];
  for (const char* key : {"max_abs", "mean", "amplitude", "yield_safety", "fatigue_safety"}) {
    const double expected = one["stress"][key];
    EXPECT_NEAR(by_x["rods"]["rod"]["stress"][key][1][1], expected, 1e-6 * std::abs(expected)) << key;
    EXPECT_NEAR(by_y["rods"]["rod"]["stress"][key][1][1], expected, 1e-6 * std::abs(expected)) << key;
  }
  EXPECT_NEAR(by_x["rods"]["rod"]["deflection"][1][1], one["deflection"]["max_abs"],
              1e-8 * one["deflection"]["max_abs"].get<double>());
  EXPECT_FALSE(document(rod + "--no-boundaries --x " + rpm + " --y " + mass)["rods"]["rod"].contains("stress"));
}

TEST_F(Map, DrawsStressAndSafety) {
  const CommandResult result = hb("map " + scene("slider_crank_units") +
                                  " --modes 2 --set rod.yield=\"250 MPa\" --stress --x rpm=1000:3000:4 --y "
                                  "piston.mass=0.3:0.5:3 --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("smallest safety against yielding"), std::string::npos) << result.out;
  EXPECT_NE(read(folder_ / "out/map_stress_rod.svg").find("largest stress [MPa]"), std::string::npos);
  EXPECT_NE(read(folder_ / "out/map_yield_safety_rod.svg").find("safety against yielding"), std::string::npos);
  EXPECT_NE(read(folder_ / "out/map_stress.csv").find("rod stress [MPa]"), std::string::npos);
}

TEST_F(Map, AStressOfARodWithoutASectionNamesTheKeyToAdd) {
  refused(scene("slider_crank") + " --stress --x rpm=1000:3000:3 --y piston.mass=0.3:0.5:2",
          "stress: found no section of rod, allowed: rod.section");
  refused(scene("mathieu") + " --stress --x omega=1:3:4 --y " + swing + "=0.1:1:4", "[hill]");
}

TEST_F(Map, WithoutBoundariesItHasTheSameGridAndNoCurves) {
  for (const std::string& grid :
       {std::string("9 --y *.J=30:60:5 --modes 1"), std::string("250 --y *.J=30:60:200 --modes 1")}) {
    const std::string asked = scene("six_link") + " --rods AB --x rpm=1800:3000:" + grid;
    const Json full = document(asked), alone = document(asked + " --no-boundaries");
    EXPECT_TRUE(full.contains("boundaries"));
    EXPECT_FALSE(alone.contains("boundaries"));
    EXPECT_FALSE(alone["rods"]["AB"].contains("boundaries"));
    EXPECT_EQ(alone["verdict"], full["verdict"]);
    EXPECT_EQ(document(asked + " --no-boundaries --only verdict")["verdict"], full["verdict"]);
  }
  refused(scene("mathieu") + " --x omega=1:3:4 --y " + swing + "=0.1:1:4 --no-boundaries --boundary-tol 1e-6",
          "--no-boundaries");
}

TEST_F(Map, BoundaryPointsAreAsGoodAsAsked) {
  const std::string asked = scene("mathieu") + " --x omega=1.5:2.6:9 --y " + swing + "=0.3:0.6:4";
  const Json fine = document(asked), coarse = document(asked + " --boundary-tol 1e-5");
  EXPECT_EQ(coarse["boundary_tolerance"], 1e-5);
  EXPECT_EQ(coarse["boundary_points_not_reached"], 0);
  EXPECT_EQ(coarse["verdict"], fine["verdict"]);
  ASSERT_EQ(coarse["boundaries"].size(), fine["boundaries"].size());
  // Each point lies within its error of a curve known better: the distance along the edge that both cross.
  std::size_t compared = 0;
  for (const Json& curve : coarse["boundaries"])
    for (const Json& p : curve["points"])
      for (const Json& other : fine["boundaries"])
        for (const Json& q : other["points"])
          if (p[1] == q[1] && std::abs(p[0].get<double>() - q[0].get<double>()) < 0.01) {
            EXPECT_NEAR(p[0], q[0], curve["error"].get<double>() + other["error"].get<double>());
            ++compared;
          }
  EXPECT_GT(compared, 4u);
  refused(asked + " --boundary-tol 0.5", "--boundary-tol");
  // Finer than its points come out: how many stay behind is counted, and the command says so.
  const CommandResult finest = hb("map " + scene("two_oscillators") +
                                  " --x omega=2.5:3.5:6 --y hill.damping.0.0=0.05:0.1:3 --json --boundary-tol 1e-14");
  EXPECT_EQ(finest.status, 3);
  const Json map = Json::parse(finest.out);
  std::size_t behind = 0;
  for (const Json& curve : map["boundaries"])
    if (curve["error"] > 1e-13 * 0.05) ++behind;  // of the least damping
  EXPECT_GT(behind, 0u);
  EXPECT_GT(map["boundary_points_not_reached"], 0);
}

TEST_F(Map, StatsSayWhatWasComputedAndWhatWasNot) {
  const std::string asked = scene("two_oscillators") + " --x omega=2.5:3.5:4 --y hill.damping.0.0=0.05:0.1:3";
  const Json whole = document(asked + " --stats"), alone = document(asked + " --stats --no-boundaries");
  ASSERT_EQ(whole["stats"].size(), 1u);
  EXPECT_GT(whole["stats"][0]["seconds"], 0);
  EXPECT_EQ(whole["accuracy"]["boundaries"], whole["boundary_tolerance"]);
  ASSERT_EQ(alone["stats"].size(), 2u);
  EXPECT_EQ(alone["stats"][1]["skipped"], "not asked for");
  EXPECT_FALSE(document(asked).contains("stats"));
}

TEST_F(Map, GrowthRatesAreThoseOfTheSteadyCommand) {
  const Json map = document(scene("six_link") + " --x rpm=300:1900:3 --y AB.J=30:60:3 --rods AB --modes 1");
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      const CommandResult steady =
          hb("steady " + scene("six_link") + " --rods AB --modes 1 --json --only stability --rpm " +
             map["x"]["values"][i].dump() + " --set AB.J=" + map["y"]["values"][j].dump());
      const Json rod = Json::parse(steady.out)["rods"]["AB"];
      const double expected = rod["growth_rate"];
      EXPECT_NEAR(map["growth_rate"][j][i], expected,
                  1e-8 * std::abs(expected) + 2 * rod["exponent_error"].get<double>());
      EXPECT_EQ(map["verdict"][j][i], rod["verdict"]);
    }
  }
}

// At low speeds the discriminant takes more values than it was given: growth rates between places were off by four
// fifths of themselves.
TEST_F(Map, GrowthRatesOfOneUnknownAreKnownAtEveryPointOfALargeMap) {
  const Json found = document(
      scene("mathieu") + " --only stability --no-boundaries --x omega=0.2:4:300 --y hill.stiffness.1.scale=0:5:200");
  for (const auto& [i, j] : {std::pair{38, 93}, std::pair{2, 150}, std::pair{170, 40}, std::pair{299, 199}}) {
    const double x = found["x"]["values"][i], y = found["y"]["values"][j];
    const CommandResult single =
        hb(fmt::format("steady {} --only stability --json --omega {:.17g} --set hill.stiffness.1.scale={:.17g}",
                       scene("mathieu"), x, y));
    const Json rod = Json::parse(single.out)["rods"]["system"];
    ASSERT_TRUE(found["growth_error"][j][i].is_number()) << x << " " << y;
    EXPECT_NEAR(found["growth_rate"][j][i], rod["growth_rate"].get<double>(),
                found["growth_error"][j][i].get<double>() + rod["exponent_error"].get<double>());
  }
  for (const Json& row : found["growth_error"])
    for (const Json& error : row) EXPECT_TRUE(error.is_number());
}

TEST_F(Map, GrowthOfTheSteadyCommandChangesSignAcrossBoundaryPointsOfALength) {
  // A length changes the geometry: its systems are interpolated along y.
  const Json map = document(scene("six_link") + " --x rpm=1500:2500:5 --y crank.length=50:60:3 --rods AB --modes 1");
  ASSERT_FALSE(map["boundaries"].empty());
  int compared = 0;
  const std::string rod = map["boundaries"][0]["rod"];
  const Json& points = map["boundaries"][0]["points"];
  for (std::size_t k = 0; k < points.size() && compared < 3; k += points.size() / 3 + 1, ++compared) {
    double growth[2];
    for (const int side : {0, 1}) {
      const double rpm = points[k][0].get<double>() * (1 + (side ? 1e-8 : -1e-8));
      const CommandResult steady =
          hb("steady " + scene("six_link") + " --rods AB --modes 1 --json --only stability --rpm " + Json(rpm).dump() +
             " --set crank.length=" + points[k][1].dump());
      growth[side] = Json::parse(steady.out)["rods"][rod]["growth_rate"];
    }
    EXPECT_LT(growth[0] * growth[1], 0) << points[k].dump();
  }
  EXPECT_GT(compared, 0);
}

TEST_F(Map, SameBitsWhateverTheNumberOfThreads) {
  const std::string arguments = "map " + scene("two_oscillators") + " --x omega=2.5:3.5:8 --y " +
                                "hill.damping.0.0=0.05:0.1:4" + " --json --threads ";
  const CommandResult one = hb(arguments + "1"), two = hb(arguments + "2");
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(one.out, two.out);
}

// More rows than one thread writes at a time, the last of them alone.
TEST_F(Map, LargeGridsAreTheSameTextWhateverTheNumberOfThreads) {
  const std::string arguments =
      "map " + scene("mathieu") + " --x omega=0.5:3:200 --y hill.stiffness.1.cos.0.0=0.05:1:3000 --json --threads ";
  const CommandResult one = hb(arguments + "1");
  ASSERT_EQ(one.status, 0) << one.err;
  for (const char* threads : {"2", "3"}) EXPECT_TRUE(one.out == hb(arguments + threads).out) << threads;
  const Json map = Json::parse(one.out);
  for (const Json& grid : {map["growth_rate"], map["verdict"], map["rods"]["system"]["growth_rate"]}) {
    EXPECT_EQ(grid.size(), 3000);
    for (const Json& row : grid) ASSERT_EQ(row.size(), 200);
  }
}

TEST_F(Map, GoesOnWhereItWasStoppedAndRefusesAChangedScene) {
  const std::string arguments =
      "map " + scene("two_oscillators") + " --x omega=2.5:3.5:30 --y hill.damping.0.0=0.05:0.1:20 --no-plots --out ";
  const int status = hb(arguments + "whole").status;
  ASSERT_EQ(stopped_by("INT", arguments + "parts", "parts.part"), 130);
  EXPECT_FALSE(fs::exists(folder_ / "parts"));
  const CommandResult changed = hb(arguments + "parts --set hill.damping.1.1=0.2 --resume");
  EXPECT_EQ(changed.status, 2);
  EXPECT_NE(changed.err.find("--resume"), std::string::npos) << changed.err;
  const CommandResult resumed = hb(arguments + "parts --resume");
  ASSERT_EQ(resumed.status, status) << resumed.err;
  EXPECT_EQ(read(folder_ / "whole/map.json"), read(folder_ / "parts/map.json"));
  EXPECT_FALSE(fs::exists(folder_ / "parts.part"));
}

TEST_F(Map, AreaWhereTheLinkageDoesNotCloseIsMarkedAndCounted) {
  // A crank longer than the rod does not turn through.
  const Json found = document(scene("slider_crank") + " --x rpm=300:600:3 --y 'crank.length=20:200:8' --modes 1");
  std::size_t missing = 0, present = 0;
  for (std::size_t j = 0; j < 8; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(found["growth_rate"][j][i].is_null(), found["verdict"][j][i].is_null());
      ++(found["verdict"][j][i].is_null() ? missing : present);
    }
  }
  EXPECT_GT(missing, 0u);
  EXPECT_GT(present, 0u);
  EXPECT_EQ(found["counts"]["missing"], missing);
  ASSERT_FALSE(found["missing"].empty());
  std::size_t counted = 0;
  for (const Json& reason : found["missing"]) {
    counted += reason["count"].get<std::size_t>();
    EXPECT_FALSE(reason["reason"].get<std::string>().empty());
  }
  EXPECT_EQ(counted, missing);
}

TEST_F(Map, DampingRangeGivesBoundariesAtBothEnds) {
  const Json found =
      document(scene("mathieu") + " --x omega=1.5:3:16 --y " + swing + "=0.1:0.6:6 --band damping=0.5:2");
  ASSERT_EQ(found["damping_range"].size(), 2u);
  EXPECT_EQ(found["damping_range"][0]["factor"], 0.5);
  const auto tip = [](const Json& curves) {
    double lowest = HUGE_VAL;
    for (const Json& curve : curves) {
      for (const Json& p : curve["points"]) lowest = std::min(lowest, p[1].get<double>());
    }
    return lowest;
  };
  // Least swing that is unstable: 2 c sqrt(1.2) for damping c, to first order.
  EXPECT_NEAR(tip(found["boundaries"]), 0.2 * std::sqrt(1.2), 0.01);
  EXPECT_NEAR(tip(found["damping_range"][0]["boundaries"]), 0.1 * std::sqrt(1.2), 0.01);
  EXPECT_NEAR(tip(found["damping_range"][1]["boundaries"]), 0.4 * std::sqrt(1.2), 0.03);
}

// Those of the scene with that E, whose curves begin and end at the same places.
TEST_F(Map, BandOfYoungsModulusGivesBoundariesAtBothEnds) {
  const std::string plane = scene("six_link") + " --modes 1 --x rpm=1400:3400:11 --y *.J=30:60:3";
  const Json found = document(plane + " --band E=0.9:1.1");
  EXPECT_FALSE(found.contains("damping_range"));
  ASSERT_EQ(found["band"].size(), 2u);
  const auto extent = [](const Json& curves, std::size_t axis) {
    std::pair<double, double> range{HUGE_VAL, -HUGE_VAL};
    for (const Json& curve : curves)
      for (const Json& p : curve["points"]) {
        range.first = std::min(range.first, p[axis].get<double>());
        range.second = std::max(range.second, p[axis].get<double>());
      }
    return range;
  };
  const auto scene_extent = extent(found["boundaries"], 0);
  for (const std::size_t end : {0u, 1u}) {
    const Json& band = found["band"][end];
    const double factor = end == 0 ? 0.9 : 1.1;
    EXPECT_EQ(band["parameter"], "E");
    EXPECT_EQ(band["factor"], factor);
    const std::string E = std::to_string(factor * 21e7);
    const Json other = document(plane + " --set AB.E=" + E + " --set CD.E=" + E);
    for (const std::size_t axis : {0u, 1u}) {
      const auto expected = extent(other["boundaries"], axis), got = extent(band["boundaries"], axis);
      EXPECT_NEAR(got.first, expected.first, 2e-3 * expected.first);
      EXPECT_NEAR(got.second, expected.second, 2e-3 * expected.second);
    }
    // The band on the right does not leave the map.
    EXPECT_NEAR(extent(band["boundaries"], 0).second / scene_extent.second, std::sqrt(factor), 0.01);
  }
}

TEST_F(Map, WritesGridCurvesAndPictures) {
  const CommandResult result =
      hb("map " + scene("mathieu") + " --x omega=1.5:3:16 --y " + swing + "=0.1:0.6:6 --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name :
       {"map.json", "map_grid.csv", "map_boundaries.csv", "map_resonance.csv", "map.svg", "map.png"}) {
    EXPECT_GT(fs::file_size(folder_ / "out" / name), 100u) << name;
  }
  std::istringstream grid(read(folder_ / "out" / "map_grid.csv"));
  std::string line;
  std::size_t rows = 0;
  while (std::getline(grid, line)) rows += !line.empty() && line[0] != '#' && line[0] != 'o';
  EXPECT_EQ(rows, 96u);
}

// Longer than the pieces that documents are written in.
TEST_F(Map, ALargeDocumentIsTheSameInTheFolder) {
  const std::string plane = scene("mathieu") + " --x omega=0.6:3:x320 --y " + swing + "=0:1:x200";
  const Json printed = document(plane);
  EXPECT_EQ(hb("map " + plane + " --out out --no-plots").status, 0);
  const std::string text = read(folder_ / "out" / "map.json");
  EXPECT_GT(text.size(), std::size_t{1} << 22);
  Json written = Json::parse(text);
  EXPECT_EQ(written.erase("provenance"), 1u);
  EXPECT_EQ(written, printed);
  ASSERT_EQ(printed["growth_error"].size(), 200u);
  std::size_t interpolated = 0;
  for (std::size_t j = 0; j < 200; ++j)
    for (std::size_t i = 0; i < 320; ++i) {
      if (printed["interpolated"][j][i] == 1) ++interpolated;
      ASSERT_TRUE(printed["growth_error"][j][i].is_number());
      ASSERT_LE(printed["growth_error"][j][i], 1e-7);
    }
  EXPECT_GT(interpolated, 60000u);
  const std::string rows = read(folder_ / "out" / "map_grid.csv");
  EXPECT_EQ(std::ranges::count_if(lines_of(rows), [](const std::string& line) { return line[0] != '#'; }), 64001);
}

TEST_F(Map, AFullDiskIsAnErrorThatLeavesNoPartOfAResultAndLosesNoWork) {
  const std::string arguments =
      "map " + scene("mathieu") + " --x omega=1:3:61 --y " + swing + "=0:0.4:41 --out out --no-plots";
  // A limit on the size of files acts on a write like a full disk; kilobytes.
  for (const char* limit : {"ulimit -f 1;", "ulimit -f 40;"}) {
    const CommandResult result = hb(arguments + " --restart", limit);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_NE(result.err.find("cannot be written"), std::string::npos) << result.err;
    for (const char* file : {"map_grid.csv", "map_boundaries.csv"}) EXPECT_FALSE(fs::exists(folder_ / "out" / file));
  }
  // What was finished is still there.
  EXPECT_EQ(hb(arguments).status, 2);
  EXPECT_EQ(hb(arguments + " --resume").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "map_grid.csv"));
}

TEST_F(Map, AFolderThatCannotBeIsRefusedBeforeTheWork) {
  std::ofstream(folder_ / "file") << "not a folder";
  const CommandResult result =
      hb("map " + scene("mathieu") + " --x omega=1:3:3 --y " + swing + "=0:0.4:3 --out file/out --no-plots");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("file/out"), std::string::npos) << result.err;
  EXPECT_EQ(num_entries(folder_), 1u);
}

TEST_F(Map, RefusesWrongRangesAndParameters) {
  const std::string good = " --x omega=1.5:3:16 --y " + swing + "=0.1:0.6:6";
  refused(scene("mathieu"), "--x");
  refused(scene("mathieu") + " --x omega=1.5:3:16", "--y");
  refused(scene("mathieu") + " --x omega= --y " + swing + "=0:1:3", "--x");
  refused(scene("mathieu") + " --x omega=3:1:16 --y " + swing + "=0:1:3", "backwards");
  refused(scene("mathieu") + " --x omega=3:3:16 --y " + swing + "=0:1:3", "single point");
  refused(scene("mathieu") + " --x omega=1:3:1 --y " + swing + "=0:1:3", "2 or more");
  refused(scene("mathieu") + " --x omega=1:3:0 --y " + swing + "=0:1:3", "2 or more");
  refused(scene("mathieu") + " --x omega=1:nan:5 --y " + swing + "=0:1:3", "finite");
  refused(scene("mathieu") + " --x omega=1:inf:5 --y " + swing + "=0:1:3", "finite");
  refused(scene("mathieu") + " --x omega=1:3:2000000 --y " + swing + "=0:1:3", "at most");
  refused(scene("mathieu") + " --x omega=1:3:5000 --y " + swing + "=0:1:5000", "at most");
  refused(scene("mathieu") + " --x omega=-1:3:5 --y " + swing + "=0:1:3", "positive");
  refused(scene("mathieu") + " --x omega=1:3:5 --y omega=1:2:5", "two different");
  refused(scene("mathieu") + " --x omega=1:3:5 --y rpm=1:2:5", "two different");
  refused(scene("mathieu") + good + " --omega 2", "one of the two");
  refused(scene("mathieu") + good + " --set " + swing + "=1", "one of the two");
  refused(scene("mathieu") + good + " --damping-range 2:1", "LOW < HIGH");
  refused(scene("mathieu") + good + " --damping-range x", "LOW:HIGH");
  refused(scene("mathieu") + good + " --band E=0.9:1.1", "damping=A:B");
  refused(scene("six_link") + " --x rpm=300:600:5 --y AB.J=1:10:3 --band E=0.9:1.1 --band mass=0.9:1.1",
          "allowed: one");
  refused(scene("mathieu") + good + " --band damping=0.5:2 --damping-range 0.5:2", "one of the two");
  refused(scene("mathieu") + good + " --colour blue", "growth, turn, tenfold");
  refused(scene("six_link") + " --x rpm=300:600:5 --y AB.K=1:2:3", "AB.");
  refused(scene("six_link") + " --x rpm=300:600:5 --y AB.J=-5:10:3", "AB.J");
  refused(scene("six_link") + " --x '*.J=30:60:5' --y AB.J=30:60:3", "two different");
  refused(scene("six_link") + " --x rpm=300:600:5 --y AB.J=30:60:3 --rods XY", "XY");
}

}  // namespace
