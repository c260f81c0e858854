// `hb sweep` as its users meet it: the built command, its documents, files and exit codes.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "hb/engine/exponents/stability.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Sweep : public CommandTest {
 protected:
  Json document(const std::string& arguments) const {
    const CommandResult result = hb("sweep " + arguments + " --json");
    // 3: the error bound of a growth rate, inside tongues of strongly damped rods, may exceed what was asked.
    EXPECT_TRUE(result.status == 0 || result.status == 3) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
};

TEST_F(Sweep, LocatesTheTongueOfTheMathieuScene) {
  const Json found = document(scene("mathieu") + " --omega 1.5:2.6:0.003");
  const Json& bands = found["unstable_bands"]["system"];
  ASSERT_EQ(bands.size(), 1u) << bands;
  EXPECT_NEAR(bands[0][0], 2.0325246720, 1e-10 * 2);
  EXPECT_NEAR(bands[0][1], 2.3373680000, 1e-10 * 2.4);
}

// Numbers of a range may have units, as those of a scene: the same bits as the plain numbers they stand for.
TEST_F(Sweep, NumbersOfARangeMayHaveUnits) {
  const std::string scene_file = scene("six_link"), less = " --modes 1 --no-search";
  const auto equal = [&](const std::string& with_units, const std::string& plain) {
    const Json found = document(scene_file + less + with_units);
    ASSERT_TRUE(found.is_object());
    EXPECT_EQ(found, document(scene_file + less + plain));
  };
  equal(" --rpm 1500 --x AB.length=250mm:0.26m:'5 mm'", " --rpm 1500 --x AB.length=250:260:5");
  equal(" --rpm 5Hz:10Hz:x3", " --rpm 300:600:x3");
  equal(" --rpm 1500 --x '*.E=\"190 GPa\":\"210 GPa\":\"10 GPa\"'", " --rpm 1500 --x *.E=19e7:21e7:1e7");
  equal(" --rpm 1500 --x gravity=0:9.81m/s^2:x3", " --rpm 1500 --x gravity=0:9810:x3");
}

// What a tolerance means for each solver was shown nowhere.
TEST_F(Sweep, StatsShowWhatTheToleranceMeansForEachSolverTheSameInEveryCommand) {
  const std::string crank = scene("slider_crank") + " --modes 1 --tol 1e-7 --stats ";
  const Json wanted = {
      {"response", 1e-7},   {"exponents", 1e-6},      {"compared_modes", 1e-9}, {"boundary_exponents", 1e-9},
      {"boundaries", 1e-8}, {"peak_responses", 1e-9}, {"peaks", 5e-8},          {"time_integration", 1e-7}};
  const auto shown = [](const Json& document) {
    Json rounded;
    for (const auto& [solver, tolerance] : document["accuracy"].items())
      rounded[solver] = std::stod(fmt::format("{:.3e}", tolerance.get<double>()));
    return rounded;
  };
  EXPECT_EQ(shown(document(crank + "--rpm 300:400:100 --only stability")), wanted);
  for (const std::string command : {"steady", "check"}) {
    const CommandResult found = hb(command + " " + crank + "--rpm 300 --json");
    EXPECT_EQ(shown(Json::parse(found.out, nullptr, false)), wanted) << command << found.err;
    const CommandResult text = hb(command + " " + crank + "--rpm 300 --no-plots");
    EXPECT_NE((text.out + text.err).find("boundary exponents 1.0e-09"), std::string::npos) << text.out << text.err;
  }
  const CommandResult map = hb("map " + crank + "--x rpm=300:400:2 --y rod.J=800:900:2 --boundary-tol 1e-5");
  EXPECT_NE(map.err.find("tolerance 1.0e-07 means: response 1.0e-07"), std::string::npos) << map.err;
  EXPECT_NE(map.err.find("boundaries 1.0e-05"), std::string::npos) << map.err;
}

TEST_F(Sweep, WhatWasNotAskedForIsNeitherComputedNorClaimed) {
  const std::string range = scene("six_link") + " --rpm 2000:2600:100 --rods AB --stats";
  const Json full = document(range);
  const auto skipped = [](const Json& found, const std::string& stage) {
    for (const Json& entry : found["stats"])
      if (entry["stage"] == stage) return entry.contains("skipped");
    return false;
  };
  EXPECT_FALSE(skipped(full, "narrow bands and peaks"));
  const Json points = document(range + " --no-search");
  EXPECT_EQ(points["rods"], full["rods"]);
  const Json growth = document(range + " --only growth"), verdict = document(range + " --only verdict");
  for (const Json* found : {&points, &growth, &verdict}) {
    EXPECT_TRUE(skipped(*found, "narrow bands and peaks"));
    EXPECT_FALSE(found->contains("unstable_bands"));
    if (found == &points) {
      EXPECT_FALSE(found->contains("critical_rpm"));
    }
    EXPECT_FALSE(found->contains("refined"));
    EXPECT_EQ((*found)["verdict"], full["verdict"]);
  }
  for (std::size_t k = 0; k < full["rpm"].size(); ++k) {
    const double here = growth["rods"]["AB"]["growth_rate"][k], all = full["rods"]["AB"]["growth_rate"][k];
    EXPECT_NEAR(
        here, all,
        growth["rods"]["AB"]["growth_error"][k].get<double>() + full["rods"]["AB"]["growth_error"][k].get<double>());
  }
}

// The band of the second mode's principal line was listed or not depending on where the range began.
TEST_F(Sweep, BandsDoNotDependOnTheRangeAndAllElseIsExcluded) {
  write("two.toml", R"(
[hill]
mass = [[1.0, 0.0], [0.0, 1.0]]
damping = [[0.0006907509677922141, 0.0], [0.0, 0.0007469844861333518]]
[[hill.stiffness]]
harmonic = 0
cos = [[1.8579582395656333, 0.0], [0.0, 5.429150249451666]]
[[hill.stiffness]]
harmonic = 1
cos = [[-0.0639570349496675, -0.4279480856181529], [-0.4279480856181529, 0.9857699107816944]]
sin = [[0.014458361655203575, 0.0], [0.0, -0.007156608197201]]
[analysis]
omega = 1.0
)");
  for (const char* range : {".35:8:.1", "1:3:.2"}) {
    const Json found = document((folder_ / "two.toml").string() + " --omega " + range);
    bool listed = false;
    for (const Json& band : found["unstable_bands"]["system"])
      listed = listed ||
               (std::abs(band[0].get<double>() - 2.30398) < 1e-4 && std::abs(band[1].get<double>() - 2.33373) < 1e-4);
    EXPECT_TRUE(listed) << range << " " << found["unstable_bands"];
    EXPECT_EQ(found["not_excluded"]["system"], Json::array()) << range;
  }
}

TEST_F(Sweep, JsonHasTheKeysOfTheContractOverTheGridAskedFor) {
  const Json found = document(scene("six_link") + " --rpm 300:1500:150");
  const std::size_t points = 9;
  ASSERT_EQ(found["rpm"].size(), points);
  ASSERT_EQ(found["omega"].size(), points);
  EXPECT_EQ(found["rpm"][0], 300.0);
  EXPECT_EQ(found["rpm"][8], 1500.0);
  EXPECT_NEAR(found["omega"][0], 10 * std::numbers::pi, 1e-13);
  ASSERT_EQ(found["rods"].size(), 2u);
  for (const Json& rod : found["rods"]) {
    for (const char* key : {"max_abs", "growth_rate", "exponents", "verdict", "error_bound", "deflection"})
      ASSERT_EQ(rod[key].size(), points) << key;
    for (std::size_t k = 0; k < points; ++k) {
      EXPECT_EQ(rod["max_abs"][k].size(), 5u);
      EXPECT_EQ(rod["exponents"][k][0].size(), 2u);
      EXPECT_EQ(rod["exponents"][k][0][0], rod["growth_rate"][k]);
      EXPECT_LE(rod["error_bound"][k], 1e-10);
      EXPECT_EQ(rod["verdict"][k], "stable");
    }
  }
  EXPECT_TRUE(found["critical_rpm"].is_array());
  EXPECT_TRUE(found["unstable_bands"]["AB"].empty());
  EXPECT_EQ(found["joints"]["AB.1"]["x_rigid"]["max"].size(), points);
  EXPECT_EQ(found["torque"]["rigid"]["min"].size(), points);
}

TEST_F(Sweep, EachPointIsWhatHbSteadySays) {
  const Json found = document(scene("six_link") + " --rpm 300:3000:2700");
  const CommandResult result = hb("steady " + scene("six_link") + " --rpm 3000 --json");
  const Json steady = Json::parse(result.out);
  for (const char* name : {"AB", "CD"}) {
    const Json &rod = found["rods"][name], &other = steady["rods"][name];
    EXPECT_EQ(rod["max_abs"][1], other["q"]["max_abs"]);
    EXPECT_EQ(rod["growth_rate"][1], other["growth_rate"]);
    EXPECT_EQ(rod["exponents"][1], other["exponents"]);
    EXPECT_EQ(rod["deflection"][1], other["deflection"]["max_abs"]);
    EXPECT_EQ(rod["bending_moment"][1], other["bending_moment"]["max_abs"]);
  }
  EXPECT_EQ(found["joints"]["AB.0"]["y"]["max"][1], steady["joints"]["AB.0"]["y"]["max"]);
  EXPECT_EQ(found["torque"]["max"][1], steady["torque"]["max"]);
}

TEST_F(Sweep, GivesTheSameBitsWhateverTheNumberOfThreads) {
  const std::string arguments = scene("six_link") + " --rpm 900:1800:100 --modes 2";
  const Json one = document(arguments + " --threads 1"), two = document(arguments + " --threads 2");
  EXPECT_EQ(one, two);
}

TEST_F(Sweep, BandsOfTheSixLinkMechanismAgreeWithBisection) {
  const Json found = document(scene("six_link") + " --rpm 1600:3000:100 --only stability");
  const hb::Scene six_link = hb::read_scene(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  const hb::Linkage& linkage = std::get<hb::Linkage>(six_link.model);
  const hb::LinkageCoefficients coefficients = hb::linkage_coefficients(linkage);
  int ends = 0;
  for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
    const hb::Body& link = *hb::body_at(linkage, coefficients.links[r]);
    const hb::HillSystem system = hb::ritz_system(link, coefficients.rods[r], 5);
    const auto unstable = [&](double rpm) {
      return hb::analyse_stability(system, hb::speed_from_rpm(rpm, six_link.units)).growth_rate > 0;
    };
    for (const Json& band : found["unstable_bands"][link.name]) {
      for (const double end : {band[0].get<double>(), band[1].get<double>()}) {
        if (end == 1600 || end == 3000) continue;
        double low = end * (1 - 1e-6), high = end * (1 + 1.3e-6);
        const bool above = unstable(high);
        ASSERT_NE(unstable(low), above) << link.name << " " << end;
        for (int step = 0; step < 18; ++step) {
          const double middle = 0.5 * (low + high);
          (unstable(middle) == above ? high : low) = middle;
        }
        EXPECT_NEAR(end, 0.5 * (low + high), 1e-10 * end);
        ++ends;
      }
    }
  }
  EXPECT_GE(ends, 6);
}

TEST_F(Sweep, CriticalSpeedOfADampedOscillatorIsTheClosedForm) {
  write("oscillator.toml",
        "[hill]\nmass = [[1.0]]\ndamping = [[0.02]]\nstiffness = [{ harmonic = 0, cos = [[1.0]] }]\n"
        "load = [{ harmonic = 1, cos = [1.0] }, { harmonic = 2, sin = [1e-3] }]\n");
  const Json found = document("oscillator.toml --omega 0.3:1.7:0.05");
  // Order 2 at half the speed; both at W^2 = 1 - b^2/2 as far as the other harmonic is not in the way.
  ASSERT_GE(found["critical"].size(), 1u);
  const double expected = std::sqrt(1 - 0.02 * 0.02 / 2);
  const Json& main = found["critical"].back();
  EXPECT_EQ(main["order"], 1);
  EXPECT_EQ(main["mode"], 1);
  EXPECT_NEAR(main["omega"], expected, 2e-6);

  write("single.toml",
        "[hill]\nmass = [[1.0]]\ndamping = [[0.02]]\nstiffness = [{ harmonic = 0, cos = [[1.0]] }]\n"
        "load = [{ harmonic = 3, cos = [1.0] }]\n");
  const Json third = document("single.toml --omega 0.1:1.7:0.1");
  ASSERT_EQ(third["critical_x"].size(), 1u);
  EXPECT_NEAR(third["critical_x"][0], expected / 3, 1e-10);
  EXPECT_NEAR(third["critical_rpm"][0], expected / 3 * 30 / std::numbers::pi, 1e-9);
  EXPECT_EQ(third["critical"][0]["order"], 3);
}

// On a point of the sweep or between two.
TEST_F(Sweep, ResonanceWithoutDampingIsFoundWhereverThePointsLie) {
  write("undamped.toml",
        "[hill]\nmass = [[1.0]]\nstiffness = [{ harmonic = 0, cos = [[1.0]] }]\nload = [{ harmonic = 1, cos = [1.0] "
        "}]\n");
  for (const auto& [range, status] : {std::pair("0.7:1.5:0.1", 3), {"0.5:1.5:0.01", 3}, {"0.55:1.53:0.1", 0}}) {
    const CommandResult result = hb(std::string("sweep undamped.toml --json --omega ") + range);
    EXPECT_EQ(result.status, status) << range;
    const Json critical = Json::parse(result.out)["critical"];
    ASSERT_EQ(critical.size(), 1u) << range;
    EXPECT_NEAR(critical[0]["omega"], 1, 1e-10) << range;
    EXPECT_TRUE(critical[0]["max_abs"].is_null()) << range;
  }
  const std::string text = hb("sweep undamped.toml --omega 0.7:1.5:0.1").out;
  EXPECT_EQ(text.find(" nan"), std::string::npos) << text;
  EXPECT_NE(text.find("unbounded"), std::string::npos) << text;
}

// In the first or the last interval, wide or narrow; and between points that climb on beyond.
TEST_F(Sweep, PeaksAreFoundWhereThePointsHaveNoMaximum) {
  const auto critical = [&](const std::string& arguments) {
    const Json swept = document(arguments);
    std::vector<double> found;
    for (const Json& peak : swept["critical"]) found.push_back(peak["rpm"]);
    return found;
  };
  const std::string six = scene("six_link") + " --only steady,stability --rods CD --rpm ";
  const std::vector<double> last = critical(six + "1060:1100:20"), first = critical(six + "1090:1150:20");
  ASSERT_EQ(last.size(), 1u);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_NEAR(last[0], 1095.60471, 1e-4);
  EXPECT_NEAR(first[0], 1095.60471, 1e-4);

  // A top on a shoulder, not far enough from the next point for another step: that point tells that it is one.
  const std::string four = scene("four_bar") + " --only steady,stability --rpm ";
  const std::vector<double> coarse = critical(four + "420:600:20"), fine = critical(four + "420:600:2");
  ASSERT_EQ(coarse.size(), 3u);
  ASSERT_EQ(fine.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(coarse[k], fine[k], 1e-6);

  // A resonance foretold at 900 rpm itself, where the response only climbs to the pole behind it.
  const std::vector<double> behind = critical(scene("eight_link") + " --only steady,stability --rpm 600:1500:300");
  EXPECT_EQ(std::ranges::count(behind, 900.0), 0);
  EXPECT_TRUE(std::ranges::any_of(behind, [](double rpm) { return std::abs(rpm - 1009.5692047205) < 1e-6; }));

  write("band.toml",
        "[hill]\nmass = [[1.0]]\nstiffness = [{ harmonic = 0, cos = [[8.85]] }, { harmonic = 1, cos = [[0.0146]] }]\n"
        "load = [{ harmonic = 1, cos = [0.5] }]\n");
  const Json undamped = document("band.toml --omega 0.5:3:0.1");
  ASSERT_GE(undamped["critical"].size(), 2u);
  EXPECT_NEAR(undamped["critical"].back()["omega"], std::sqrt(8.85), 1e-3);
  EXPECT_TRUE(undamped["critical"].back()["max_abs"].is_null());
}

TEST_F(Sweep, AnyNumberOfTheSceneMayBeSwept) {
  const Json found = document(scene("six_link") + " --rpm 1500 --x AB.J=40:60:5 --only steady,stability");
  ASSERT_EQ(found["x"]["values"].size(), 5u);
  EXPECT_EQ(found["x"]["path"], "AB.J");
  EXPECT_EQ(found["rpm"], Json::parse("[1500.0,1500.0,1500.0,1500.0,1500.0]"));
  const Json at_45 = Json::parse(hb("steady " + scene("six_link") + " --rpm 1500 --json --only stability").out);
  EXPECT_EQ(found["rods"]["AB"]["growth_rate"][1], at_45["rods"]["AB"]["growth_rate"]);
}

TEST_F(Sweep, MarksPointsWhereTheLinkageDoesNotClose) {
  const Json found = document(scene("six_link") + " --rpm 300 --x crank.length=40:200:40 --only stability");
  ASSERT_EQ(found["x"]["values"].size(), 5u);
  ASSERT_FALSE(found["problems"].empty());
  for (const Json& problem : found["problems"]) {
    EXPECT_FALSE(problem["reason"].get<std::string>().empty());
    EXPECT_TRUE(found["rods"]["AB"]["growth_rate"][problem["index"].get<std::size_t>()].is_null());
  }
  EXPECT_TRUE(found["rods"]["AB"]["growth_rate"][0].is_number());
}

TEST_F(Sweep, RefusesWrongRanges) {
  const std::string six = scene("six_link");
  for (const char* range : {"300", "300:300:10", "600:300:10", "300:600:0", "300:600:-10", "300:600:1e-9",
                            "300:600:nan", "300:inf:10", "300:600", "300:600:10:10", "300:600:x1", "300:600:x",
                            "300:600:x2.5", "300:600:x2000000", "a:b:c", "300:600:500", "-600:600:10", "0:600:10"}) {
    const CommandResult result = hb("sweep " + six + " --json --rpm=" + range);
    EXPECT_EQ(result.status, 2) << range;
    EXPECT_NE(result.err.find("--rpm"), std::string::npos) << range << ": " << result.err;
    EXPECT_NE(result.err.find("allowed"), std::string::npos) << range << ": " << result.err;
    EXPECT_TRUE(result.out.empty());
  }
  for (const char* x : {"AB.J", "AB.J=40", "AB.J=40:40:1", "=1:2:1", "AB.J=60:40:5", "AB.J=1:2:1e-9", "rpm=-5:10:1"}) {
    const CommandResult result = hb("sweep " + six + " --json --x " + x);
    EXPECT_EQ(result.status, 2) << x;
    EXPECT_NE(result.err.find("--x"), std::string::npos) << x << ": " << result.err;
  }
}

TEST_F(Sweep, TakesANumberOfPointsAndTheScenesRange) {
  const std::string only = " --only steady --modes 1";
  const Json counted = document(scene("six_link") + only + " --rpm 300:900:x4");
  const Json stepped = document(scene("six_link") + only + " --rpm 300:900:200");
  EXPECT_EQ(counted["rpm"], stepped["rpm"]);
  EXPECT_EQ(counted["rods"]["AB"]["max_abs"], stepped["rods"]["AB"]["max_abs"]);
  const Json parameter = document(scene("six_link") + only + " --rpm 300 --x AB.J=40:60:x3");
  EXPECT_EQ(parameter["x"]["values"], Json::parse("[40.0, 50.0, 60.0]")) << parameter["x"];
  const Json from_scene = document(scene("six_link") + only + " --set 'analysis.rpm=[300, 900, 200]'");
  EXPECT_EQ(from_scene["rpm"], stepped["rpm"]);
  const CommandResult single = hb("sweep " + scene("six_link"));
  EXPECT_EQ(single.status, 2);
  EXPECT_NE(single.err.find("rpm = [from, to, step] in the scene"), std::string::npos) << single.err;
}

TEST_F(Sweep, RefusesUnknownPathsWithTheNearestAndImpossibleValues) {
  const CommandResult unknown = hb("sweep " + scene("six_link") + " --rpm 300 --x AB.K=40:60:5");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("AB.J"), std::string::npos) << unknown.err;
  const CommandResult negative = hb("sweep " + scene("six_link") + " --rpm 300 --x AB.J=-60:60:5");
  EXPECT_EQ(negative.status, 2);
  EXPECT_NE(negative.err.find("AB.J"), std::string::npos) << negative.err;
  const CommandResult twice = hb("sweep " + scene("six_link") + " --rpm 300 --x AB.J=40:60:5 --set AB.J=50");
  EXPECT_EQ(twice.status, 2);
  const CommandResult two_speeds = hb("sweep " + scene("six_link") + " --rpm 300 --x rpm=300:600:50");
  EXPECT_EQ(two_speeds.status, 2);
}

TEST_F(Sweep, WritesTablesAndPictures) {
  const CommandResult result = hb("sweep " + scene("slider_crank") + " --rpm 2000:6000:500 --modes 2 --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"sweep.json", "sweep_rod.csv", "critical.csv", "unstable_bands.csv", "not_excluded.csv",
                           "sweep_joint_forces.csv", "campbell_rod.svg", "campbell_rod.png", "peaks_rod.png",
                           "growth_rod.png", "sweep.gp"}) {
    EXPECT_TRUE(fs::is_regular_file(folder_ / "out" / name)) << name;
  }
  EXPECT_EQ(num_entries(folder_), 1u);
}

TEST_F(Sweep, StatsSayWhatWasNotAskedFor) {
  const auto skipped = [&](const std::string& only) {
    std::set<std::string> stages;
    const Json found = document(scene("slider_crank") + " --rpm 2000:3000:500 --modes 2 --stats " + only);
    for (const Json& stage : found["stats"])
      if (stage.contains("skipped")) stages.insert(stage["stage"].get<std::string>());
    return stages;
  };
  EXPECT_TRUE(skipped("").empty());
  EXPECT_EQ(skipped("--only growth"),
            (std::set<std::string>{"steady states", "shapes", "joint forces", "further exponents", "theory errors",
                                   "narrow bands and peaks", "resonance peaks"}));
  EXPECT_EQ(skipped("--only steady"), (std::set<std::string>{"shapes", "joint forces", "stability"}));
}

TEST_F(Sweep, OfWhatWasNotLookedForThereAreNoFiles) {
  const std::string sweep = "sweep " + scene("slider_crank") + " --rpm 2000:6000:1000 --modes 2 --no-plots ";
  ASSERT_EQ(hb(sweep + "--only verdict --out verdict").status, 0);
  ASSERT_EQ(hb(sweep + "--only stability --out bands").status, 0);
  for (const char* name : {"unstable_bands.csv", "not_excluded.csv"}) {
    EXPECT_FALSE(fs::exists(folder_ / "verdict" / name)) << name;
    EXPECT_TRUE(fs::exists(folder_ / "bands" / name)) << name;
  }
  const std::string bound = "a closed-form bound";
  EXPECT_NE(read(folder_ / "verdict/sweep_rod.csv").find(bound), std::string::npos);
  EXPECT_EQ(read(folder_ / "bands/sweep_rod.csv").find(bound), std::string::npos);
  const std::string map = "map " + scene("mathieu") + " --x omega=1.5:3:4 --y hill.damping.0.0=0.1:0.2:3 --no-plots ";
  ASSERT_EQ(hb(map + "--no-boundaries --out grid").status, 0);
  EXPECT_FALSE(fs::exists(folder_ / "grid/map_boundaries.csv"));
}

// Beside the end of a band the linear response was 1e14 mm, and the axis began at 100 mm: nothing else was in the
// picture.
TEST_F(Sweep, PicturesShowResponsesThatCanBe) {
  const CommandResult result = hb("sweep " + scene("six_link") + " --rpm 900:1920:60 --modes 1 --rods AB --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string script = read(folder_ / "out" / "sweep.gp");
  const std::size_t picture = script.find("'peaks_AB.'"), range = script.find("set yrange [", picture);
  ASSERT_NE(range, std::string::npos);
  double low = 0, high = 0;
  ASSERT_EQ(std::sscanf(script.c_str() + range, "set yrange [%lf:%lf]", &low, &high), 2);
  constexpr double at_900_rpm = 1.36, length = 259;  // mm
  EXPECT_LT(low, at_900_rpm);
  EXPECT_LT(high, 10 * length);
}

TEST_F(Sweep, GoesOnWhereItWasStoppedAndRefusesAChangedScene) {
  const std::string arguments =
      "sweep " + scene("six_link") + " --rpm 200:6000:2 --only stability --no-plots --out out ";
  ASSERT_EQ(stopped_by("INT", arguments, "out.part"), 130);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  const CommandResult changed = hb(arguments + "--set AB.J=46 --resume");
  EXPECT_EQ(changed.status, 2);
  EXPECT_NE(changed.err.find("--resume"), std::string::npos) << changed.err;
  EXPECT_TRUE(fs::exists(folder_ / "out.part"));
}

TEST_F(Sweep, ResumedWorkEndsInTheSameDocument) {
  const std::string arguments =
      "sweep " + scene("six_link") + " --rpm 1000:1500:5 --only steady,stability --modes 2 --no-plots --out ";
  const int status = hb(arguments + "whole").status;
  ASSERT_EQ(stopped_by("KILL", arguments + "parts", "parts.part"), 137);
  const CommandResult resumed = hb(arguments + "parts --resume");
  ASSERT_EQ(resumed.status, status) << resumed.err;
  EXPECT_EQ(read(folder_ / "whole/sweep.json"), read(folder_ / "parts/sweep.json"));
  EXPECT_FALSE(fs::exists(folder_ / "parts.part"));
}

}  // namespace
