// `hb tune`: what it says of designs, writes, and refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/tune_command.hpp"

namespace {

using namespace hb;
namespace fs = std::filesystem;

TEST_F(Tune, NamesTheKeysThatASafetyNeeds) {
  const auto refused = [&](const std::string& set) {
    return refusal("--minimise mass --vary rod.section.height=0.002:0.02 --over rpm=8000:9000 " + set);
  };
  for (const char* part : {"safety: found no strength of rod", "rod.yield", "rod.endurance beside rod.tensile"})
    EXPECT_NE(refused("--keep 'safety>=1.5'").find(part), std::string::npos) << refused("--keep 'safety>=1.5'");
  EXPECT_NE(
      refused("--keep 'safety>=1.5' --set rod.endurance=1e8").find("rod.endurance without rod.tensile or rod.yield"),
      std::string::npos);
  EXPECT_NE(refused("--keep 'safety<=1.5'").find("better large"), std::string::npos);
  const CommandResult flat = hb("tune " + scene("slider_crank") +
                                " --minimise mass --vary rod.J=800:900 --keep 'safety>=1.5' --set rod.yield=250e3");
  EXPECT_EQ(flat.status, 2);
  EXPECT_NE(flat.err.find("found no section height of rod, allowed: --height rod=H, or a section in the scene"),
            std::string::npos)
      << flat.err;
  EXPECT_NE(
      hb("tune " + scene("mathieu") + " --maximise safety --vary hill.damping.0.0=0.1:0.2 --rpm 10").err.find("[hill]"),
      std::string::npos);
}

// The stress met its bound without a word of the axial force, which is not in it.
TEST_F(Tune, SaysThatItsStressIsOfBendingAlone) {
  const std::string question = " --vary rod.section.height=0.006:0.02 --over rpm=1000:2000 --modes 1 --analyses 4";
  EXPECT_NE(hb("tune engine.toml --minimise stress" + question).out.find("bending alone"), std::string::npos);
  EXPECT_EQ(hb("tune engine.toml --minimise deflection" + question).out.find("bending alone"), std::string::npos);
}

TEST_F(Tune, SaysWhereBothDesignsAreWorst) {
  const Json found = document(least_mass + "--out tuned --no-plots");
  for (const char* design : {"before", "after"}) {
    SCOPED_TRACE(design);
    const Json worst = found["metrics"][1][design];
    const std::string scene_file = std::string(design) == "before" ? "engine.toml" : "tuned/tuned.toml";
    const Json peak = steady(scene_file + " --rpm " + worst["rpm"].dump())["rods"]["rod"]["deflection"];
    EXPECT_NEAR(worst["value"], peak["max_abs"], 1e-6 * peak["max_abs"].get<double>());
    EXPECT_NEAR(worst["x_over_l"], peak["x"].get<double>() / 0.12, 1e-6);
    EXPECT_NEAR(worst["crank_angle"], peak["crank_angle"], 1e-6);
    EXPECT_EQ(worst["confirmed"], true);
  }
  const CommandResult table = hb("tune engine.toml --speeds 6 --analyses 4 " + least_mass);
  EXPECT_NE(table.out.find("rpm, 0."), std::string::npos) << table.out;
}

TEST_F(Tune, SaysWhatIsNotConfirmedOfAnUnstableStart) {
  // The rods of the paper with J = 45 mm^4: unbounded at the edges of instability, so more speeds show more.
  const CommandResult result = hb("tune " HB_SOURCE_DIR
                                  "/results/tune_six_link/scene.toml --minimise mass --vary CD.section.height=7:8 "
                                  "--over rpm=300:3000 --speeds 12 --analyses 12");
  EXPECT_NE(result.out.find("the design before is not stable"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(">"), std::string::npos) << result.out;
}

// A goal that damping does not change read "+0 %", one that it hardly does "-5.1e-05 %".
TEST_F(Tune, SaysInWordsWhatChangesTheGoalByNothing) {
  const std::string range =
      " --vary rod.section.height=0.006:0.02 --over rpm=1000:2000 --speeds 4 --modes 1 --analyses 12";
  const std::string mass = hb("tune engine.toml --minimise mass --keep stable" + range).out;
  EXPECT_NE(mass.find("internal damping, all links             nothing"), std::string::npos) << mass;
  EXPECT_EQ(mass.find("+0 %"), std::string::npos) << mass;
  const std::string deflection = hb("tune engine.toml --minimise deflection" + range).out;
  EXPECT_NE(deflection.find("less than 0.001 %"), std::string::npos) << deflection;
  EXPECT_EQ(deflection.find("e-", deflection.find("1 % more of")), std::string::npos) << deflection;
}

// Designs that only a slope asked for were counted as designs tried, and the best of these might be one of them.
TEST_F(Tune, CountsWhatOnlySlopesAskedForApart) {
  // Varied speeds have no adjoint solution: differences.
  const CommandResult result =
      hb("tune engine.toml --maximise speed-range --vary over.to=1000:3000 --keep stable --keep 'deflection<=1e-4' "
         "--over rpm=500:1500 --speeds 4 --modes 1 --algorithm slsqp --analyses 30 --stats --json");
  const Json found = Json::parse(result.out);
  EXPECT_GT(found["analyses_for_slopes"], 0) << result.out;
  EXPECT_LT(found["analyses_for_slopes"], found["analyses"]);
  const Json direct = document(least_mass + "--algorithm direct --analyses 12 --modes 1 --stats", 3);
  EXPECT_EQ(direct["analyses_for_slopes"], 0);
  for (const Json& stage : direct["stats"]) {
    if (stage["stage"] != "designs") continue;
    // The confirmation is on other speeds and counted there.
    EXPECT_EQ(stage["note"].get<std::string>().find(
                  std::to_string(direct["analyses"].get<int>() - direct["confirmations"].get<int>()) + " analysed"),
              0)
        << stage;
  }
}

// A bare number beside a section in mm is in the scene's metres: only `hb steady` and `hb sweep` said that no rod has
// it.
TEST_F(Tune, WarnsOfBoundsInAUnitThatWasNotMeant) {
  const std::string goal = " --minimise mass --over rpm=1000:2000 --speeds 2 --modes 1 --analyses 4 ";
  const std::string no_rod = "rod.elastic.section: found length/sqrt(J/area) = 0.0831";
  const Json found = Json::parse(hb("tune engine.toml --json" + goal + "--vary rod.section.height=0.006:5").out);
  const auto told = std::ranges::find_if(found["warnings"], [&](const Json& warning) {
    const std::string words = warning;
    return words.find(no_rod) != std::string::npos && words.ends_with("(at the upper bounds)");
  });
  EXPECT_NE(told, found["warnings"].end()) << found["warnings"];
  const std::string table = hb("tune engine.toml" + goal + "--vary rod.section.height=0.006:5").out;
  EXPECT_NE(table.find(no_rod), std::string::npos) << table;
  EXPECT_NE(table.find("WARNING: engine.toml"), std::string::npos) << table;
  EXPECT_FALSE(Json::parse(hb("tune engine.toml --json" + goal + "--vary rod.section.height=0.006:0.0065").out)
                   .contains("warnings"));
}

// The refusal named --rpm FROM:TO:STEP, which is not how a design is told its speeds.
TEST_F(Tune, WithoutSpeedsNamesTheFlagForThem) {
  const std::string words = refusal("--minimise mass --vary rod.section.height=0.005:0.01");
  EXPECT_NE(words.find("--over: no speeds given, and engine.toml has none under [analysis]; allowed: rpm=FROM:TO"),
            std::string::npos)
      << words;
}

TEST_F(Tune, SaysWhichConditionCannotBeMet) {
  const CommandResult result =
      hb("tune engine.toml --minimise mass --vary rod.section.height=0.002:0.005 --keep 'deflection<=1e-7' --keep "
         "'mass<=1' --over rpm=8000:9000 --speeds 2 --out tuned --no-plots");
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.out.find("not met: deflection<=1e-7"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("at its upper bound"), std::string::npos) << result.out;  // the nearest design
  // ... in a file that says so.
  EXPECT_FALSE(fs::exists(folder_ / "tuned" / "tuned.toml"));
  EXPECT_NE(read(folder_ / "tuned" / "nearest.toml").find("\n# NOT REACHED: "), std::string::npos);
  EXPECT_NE(result.out.find("nearest.toml"), std::string::npos) << result.out;
  EXPECT_EQ(hb("steady tuned/nearest.toml --rpm 1000 --no-plots").status, 0);
}

TEST_F(Tune, MovesAStartIntoTheBoundsAndSaysSo) {
  const CommandResult result =
      hb("tune engine.toml --minimise mass --vary rod.section.height=0.01:0.02 --over rpm=2000:3000 --speeds 4 --json");
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("0.006 lies outside 0.01 to 0.02"), std::string::npos) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["variables"][0]["moved_from"], 0.006);
  EXPECT_NEAR(found["variables"][0]["after"], 0.01, 1e-6);  // mass alone: the lower bound
}

TEST_F(Tune, TakesAHeightOnlyForStressInARodWithoutASection) {
  const std::string good = "--vary rod.section.height=0.001:0.02 --over rpm=1:2 --minimise ";
  EXPECT_NE(refusal(good + "stress --height rod=0.0006").find("rod=0.0006, where the section"), std::string::npos);
  EXPECT_NE(refusal(good + "stress --height '*=1'").find("allowed: no --height"), std::string::npos);
  const std::string bars = "tune " + scene("four_bar") + " --vary crank.length=0.05:0.12 --minimise ";
  const CommandResult both = hb(bars + "stress --height '*=1' --height rocker=2"),
                      none = hb(bars + "mass --height '*=1'");
  EXPECT_EQ(both.status, 2);
  EXPECT_NE(both.err.find("* beside"), std::string::npos) << both.err;
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("with stress"), std::string::npos) << none.err;
}

TEST_F(Tune, SaysWhatEachUnmetConditionCouldHaveAlone) {
  const auto best = [&](const std::string& mass) {
    return document(
        "--minimise deflection --vary rod.section.height=0.002:0.01 --over rpm=2800:3000 --analyses 40 "
        "--keep 'deflection<=3e-5' --keep 'mass<=" +
            mass + "'",
        3)["conditions"];
  };
  // 7850 * 0.12 * 0.006 h: 0.0113 kg at the lower bound.
  const Json together = best("0.02"), alone = best("0.005");
  EXPECT_LE(together[0]["best_tried"], 3e-5);
  EXPECT_LE(together[1]["best_tried"], 0.02);
  EXPECT_GE(alone[1]["best_tried"], 7850 * 0.12 * 0.006 * 0.002 * (1 - 1e-12));
  const CommandResult table =
      hb("tune engine.toml --speeds 6 --minimise deflection --vary rod.section.height=0.002:0.01 --over rpm=2800:3000 "
         "--analyses 40 --keep 'deflection<=3e-5' --keep 'mass<=0.02'");
  EXPECT_NE(table.out.find("but not together with the others"), std::string::npos) << table.out;
}

TEST_F(Tune, ShowsAndWritesTheSpeedRangeFound) {
  const std::string question =
      "--maximise speed-range --vary over.to=1500:3000 --over rpm=1000:2000 --keep 'deflection<=4e-5' ";
  const Json found = document(question + "--out tuned --no-plots");
  const double to = found["variables"][0]["after"];
  EXPECT_GT(to, 2000);
  EXPECT_LT(to, 3000);
  EXPECT_EQ(found["over_before"]["rpm"], Json({1000, 2000}));
  EXPECT_NEAR(found["over"]["rpm"][1], to, 1e-9 * to);
  const std::string written = read(folder_ / "tuned" / "tuned.toml");
  EXPECT_NE(written.find("rpm = [1000, " + found["over"]["rpm"][1].dump()), std::string::npos) << written;
  EXPECT_NE(written.find("# Speeds found: 1000 to "), std::string::npos) << written;
  EXPECT_EQ(hb("sweep tuned/tuned.toml --no-plots").status, 0);
  EXPECT_NE(hb("tune engine.toml --speeds 6 " + question).out.find("before: 1000 to 2000 rpm"), std::string::npos);
}

TEST_F(Tune, TellsAMinimumInsideFromAVariableWithoutEffect) {
  const Json found =
      document("--minimise mass --vary crank.length=0.02:0.03 --vary rod.section.height=0.004:0.008 --rpm 1000");
  EXPECT_EQ(found["without_effect"], Json({"crank.length"}));
  // A minimum inside is none.
  const Json inside =
      document("--minimise 0.5*deflection+0.5*mass --vary rod.section.height=0.004:0.02 --over rpm=1000:3000");
  EXPECT_EQ(inside["without_effect"], Json::array());
  EXPECT_GT(inside["variables"][0]["after"], 0.0041);
  EXPECT_LT(inside["variables"][0]["after"], 0.0199);
  EXPECT_LE(inside["slope_left_over"], 1e-3);
}

TEST_F(Tune, SaysWhereTheDesignBeforeIsNotTheScenes) {
  const std::string question =
      "--minimise mass --vary rod.section.height=0.01:0.02 --tie rod.section.width=0.5*rod.section.height --over "
      "rpm=2000:2100";
  const Json differs = document(question)["before_differs"];
  ASSERT_EQ(differs.size(), 2u);
  EXPECT_EQ(differs[0], Json({{"path", "rod.section.height"}, {"value", 0.01}, {"scene", 0.006}, {"tied", false}}));
  EXPECT_EQ(differs[1], Json({{"path", "rod.section.width"}, {"value", 0.005}, {"scene", 0.006}, {"tied", true}}));
  EXPECT_NE(hb("tune engine.toml --speeds 4 " + question).out.find("before: the scene with rod.section.height = 0.01"),
            std::string::npos);
  EXPECT_EQ(document(least_mass + "--analyses 4 ", 3)["before_differs"], Json::array());
}

TEST_F(Tune, RemovesWhatAnEarlierRunOfItsOwnLeft) {
  const std::string question =
      "tune engine.toml --minimise mass --vary rod.section.height=0.004:0.005 --over rpm=1000:2000 --speeds 4 "
      "--no-plots --out tuned ";
  EXPECT_EQ(hb(question).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "tuned" / "tuned.toml"));
  std::ofstream(folder_ / "tuned" / "notes.txt") << "the user's";
  EXPECT_EQ(hb(question + "--keep 'mass<=1e-3'").status, 3);
  EXPECT_FALSE(fs::exists(folder_ / "tuned" / "tuned.toml"));
  EXPECT_TRUE(fs::exists(folder_ / "tuned" / "nearest.toml"));
  EXPECT_TRUE(fs::exists(folder_ / "tuned" / "notes.txt"));
}

TEST_F(Tune, RefusesWrongQuestions) {
  const std::string good = "--minimise deflection --over rpm=1000:2000 ";
  EXPECT_NE(refusal(good + "--vary rod.hight=1:2").find("rod.hight"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=2:1").find("backwards"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=1:1").find("empty"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=nan:1").find("FROM:TO"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --keep 'force:nowhere<=3'").find("rod.0"),
            std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --keep deflection").find("without a bound"),
            std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --keep 'stable<=3'").find(">="), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --tie rod.density=rod.E").find("--tie"),
            std::string::npos);
  for (const char* path : {"analysis.tolerance", "units.length"})
    EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --tie " + path + "=rod.section.height")
                  .find("numbers of the mechanism"),
              std::string::npos)
        << path;
  EXPECT_NE(refusal(good + "--vary rod.section.height=0.001:0.02 --algorithm best").find("slsqp"), std::string::npos);
  EXPECT_NE(refusal("--vary rod.section.height=0.001:0.02 --over rpm=1:2 --minimise beauty").find("deflection"),
            std::string::npos);
  EXPECT_EQ(refusal("--vary rod.section.height=0.001:0.02 --over rpm=1:2 --minimise beauty").find("speed-range"),
            std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=-5:0.02").find("--vary rod.section.height=-5:0.02: its lower"),
            std::string::npos);
  EXPECT_NE(refusal("--vary rod.section.height=0.001:0.02 --over rpm=-1:2 --minimise mass").find("positive"),
            std::string::npos);
  EXPECT_NE(refusal(good).find("--vary"), std::string::npos);
  const std::string height = "--vary rod.section.height=0.001:0.02 ";
  EXPECT_NE(refusal(good + height + "--maximise stable").find("both"), std::string::npos);
  EXPECT_NE(refusal(height + "--over rpm=1:2 --maximise mass").find("better small"), std::string::npos);
  EXPECT_NE(refusal(height + "--over rpm=1:2 --minimise frequency").find("better large"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--vary over.to=900:3000").find("from below to"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--vary rod.section.height=0.001:0.02").find("twice"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary rod.section.height=-2:-1").find("height"), std::string::npos);
  EXPECT_NE(refusal(good + "--vary crank.length=0.13:0.15").find("crank"), std::string::npos);  // closes nowhere
  EXPECT_NE(refusal("--minimise stress:arm --over rpm=1:2 " + height).find("arm"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--keep 'stress<=inf'").find("number"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--only stability").find("--only"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--height nope=3").find("no elastic link of the scene"), std::string::npos);
  EXPECT_NE(refusal(good + height + "--analyses 1").find("2 to"), std::string::npos);
  EXPECT_NE(refusal("--minimise '1e308*deflection+1e308*mass' --over rpm=1:2 " + height).find("--minimise"),
            std::string::npos);
}

TEST_F(Tune, RefusesGoalsThatASceneDoesNotHave) {
  for (const std::string goal : {"mass", "stress", "force", "torque-ripple"}) {
    const CommandResult result =
        hb("tune " + scene("mathieu") + " --minimise " + goal + " --vary hill.damping.0.0=0.1:0.2 --over omega=3:4");
    EXPECT_EQ(result.status, 2) << goal;
    EXPECT_NE(result.err.find(goal), std::string::npos) << result.err;
  }
}

TEST_F(Tune, LeavesAFolderAsItWasWhenTheQuestionIsWrong) {
  fs::create_directory(folder_ / "kept");
  std::ofstream(folder_ / "kept" / "tuned.toml") << "of an earlier run";
  const CommandResult result =
      hb("tune engine.toml --minimise mass --vary rod.section.height=2:1 --over rpm=1000:2000 --out kept");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(read(folder_ / "kept" / "tuned.toml"), "of an earlier run");
  EXPECT_EQ(num_entries(folder_ / "kept"), 1u);
}

TEST_F(Tune, NeverWritesOverItsScene) {
  fs::create_directory(folder_ / "here");
  std::ofstream(folder_ / "here" / "tuned.toml") << engine;
  const CommandResult result =
      hb("tune here/tuned.toml --minimise mass --vary rod.section.height=0.004:0.02 --over "
         "rpm=1000:2000 --out here");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(read(folder_ / "here" / "tuned.toml"), engine);
}

}  // namespace
