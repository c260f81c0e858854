// What `hb` prints is true in the sentence in which it stands.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <set>

#include "tests/support/run_command.hpp"
#include "tools/work/forecast.hpp"
#include "tools/work/progress.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Words : public CommandTest {
 protected:
  std::string said(const std::string& arguments, int status = 0) const {
    const CommandResult result = hb(arguments);
    EXPECT_EQ(result.status, status) << result.err;
    return result.out;
  }
  static std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }
};

void expect(const std::string& text, const std::vector<const char*>& parts,
            const std::vector<const char*>& without = {}) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  for (const char* part : without) EXPECT_EQ(text.find(part), std::string::npos) << part << "\n" << text;
}

// Unequal damping kept the modes coupled, and omega_1 was taken from one coordinate alone.
TEST_F(Words, ANearestResonanceIsThatOfTheLowestMode) {
  std::ofstream(folder_ / "two.toml") << "[hill]\nmass = [[1, 0], [0, 1]]\ndamping = [[0.02, 0], [0, 0.04]]\n"
                                         "stiffness = [{ harmonic = 0, cos = [[1, 0.3], [0.3, 2]] }, "
                                         "{ harmonic = 1, cos = [[0.1, 0], [0, 0]] }]\n"
                                         "load = [{ harmonic = 1, cos = [1.0, 0] }]\n[analysis]\nomega = 0.4\n";
  const Json nearest = Json::parse(said("steady two.toml --json"))["rods"]["system"]["nearest_resonance"];
  const double omega_1 = std::sqrt(1.5 - std::sqrt(0.25 + 0.09));
  EXPECT_EQ(nearest["order"], 2);
  EXPECT_NEAR(nearest["omega"], omega_1 / 2, 1e-9);
}

// Far below all resonances one of order 278 was named, of which nothing is in the response.
TEST_F(Words, AResonanceOfAnOrderThatTheResponseDoesNotHaveIsNone) {
  const std::string slow = "steady " + scene("six_link") + " --rpm 10 --modes 2";
  expect(said(slow), {"resonance         none: omega_1 is about ", "the response has harmonics up to "}, {"nearest"});
  EXPECT_EQ(Json::parse(said(slow + " --json"))["rods"]["AB"]["nearest_resonance"]["in_response"], false);
  const std::string fast = "steady " + scene("six_link") + " --rpm 1500 --modes 2";
  expect(said(fast), {"resonance         nearest "}, {"resonance         none"});
  EXPECT_EQ(Json::parse(said(fast + " --json"))["rods"]["AB"]["nearest_resonance"]["in_response"], true);
}

// A peak was named after the mode as followed from point to point: 3 Omega with a coarse step, 2 Omega with a fine one.
TEST_F(Words, APeakIsNamedAlikeWithAnyStep) {
  std::vector<Json> peaks;
  for (const char* range : {"2600:2750:50", "2660:2700:5"}) {
    const Json found = Json::parse(said("sweep " + scene("six_link") + " --modes 2 --rods AB --json --rpm " + range));
    for (const Json& peak : found["critical"])
      if (std::abs(peak["rpm"].get<double>() - 2682) < 2) peaks.push_back(peak);
  }
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_EQ(peaks[0]["order"], 2);
  EXPECT_EQ(peaks[1]["order"], 2);
}

// The middle between closed-form bounds was printed as the growth rate.
TEST_F(Words, AGrowthRateOfBoundsIsAnUpperBound) {
  const std::string table = said("sweep " + scene("six_link") + " --rpm 200:400:100 --modes 2 --only verdict");
  expect(table, {"<= -16"}, {"e+03"});
}

// An unstable rod was said to grow "at half the crank's speed", as if its spectrum had one line.
TEST_F(Words, PeriodDoublingNamesThePeriodAndTheStrongestLines) {
  const std::string text = said("steady " + scene("six_link") + " --rpm 3000 --modes 2");
  expect(text,
         {"repeating after two turns of the crank (period doubling), strongest at 25, 75, 125 Hz = 1/2, 3/2, 5/2 of "
          "the speed"},
         {"at half the crank's speed"});
}

// --speeds of tune was in no page of the manual, --rpm of tune denied there.
TEST_F(Words, EveryFlagOfTheHelpIsInTheManual) {
  const std::string manual = read(HB_SOURCE_DIR "/tools/README.md");
  const std::size_t begin = manual.find("\n## Flags"), end = manual.find("\n## ", begin + 1);
  ASSERT_NE(end, std::string::npos);
  const std::string table = manual.substr(begin, end - begin);
  const std::regex flag("\n +(?:-h,)?(--[a-z-]+)");
  for (const char* command :
       {"new", "scene", "steady", "sweep", "map", "check", "bench", "compare", "fit", "tune", "report"}) {
    const std::string help = said(std::string(command) + " --help");
    int flags = 0;
    for (std::sregex_iterator found(help.begin(), help.end(), flag), none; found != none; ++found, ++flags) {
      const std::string name = (*found)[1];
      EXPECT_NE(table.find("`" + name), std::string::npos) << command << " " << name;
    }
    EXPECT_GT(flags, 0) << help;
  }
}

// Keys of a document that are nowhere in the manual; names of links and joints are not keys.
void add_unknown_keys(const Json& document, const std::string& manual, const std::string& parent,
                      std::set<std::string>& unknown) {
  const auto is_word = [&](const std::string& key) {
    const auto part_of_word = [&](std::size_t at) {
      return at < manual.size() && (std::isalnum(static_cast<unsigned char>(manual[at])) || manual[at] == '_');
    };
    for (std::size_t at = manual.find(key); at != std::string::npos; at = manual.find(key, at + 1))
      if ((at == 0 || !part_of_word(at - 1)) && !part_of_word(at + key.size())) return true;
    return false;
  };
  if (document.is_object()) {
    const bool names = parent == "joints" || parent == "rods" || parent == "bearings" || parent == "sliders";
    for (const auto& [key, value] : document.items()) {
      if (!names && !is_word(key)) unknown.insert(key);
      add_unknown_keys(value, manual, key, unknown);
    }
  } else if (document.is_array()) {
    for (const Json& value : document) add_unknown_keys(value, manual, "", unknown);
  }
}

// `joints_difference` of a check over a range was in no page of the manual.
TEST_F(Words, EveryKeyOfADocumentIsInTheManual) {
  const std::string manual = read(HB_SOURCE_DIR "/tools/README.md");
  const std::string measured = "'" HB_SOURCE_DIR "/results/first_steps/scene.toml'";
  const std::string crank = scene("slider_crank") + " --modes 1 ";
  for (const std::string& command :
       {"scene " + scene("six_link"), "scene " + scene("mathieu"), "steady " + scene("mathieu") + " --omega 1 --stats",
        "steady " + measured + " --rpm 3000 --modes 2", "steady " + scene("six_link") + " --rpm 1000 --modes 2",
        "steady " + crank + "--rpm 1000 --theory nonlinear",
        "sweep " + measured + " --rpm 7000:8000:100 --modes 2 --stats",
        "sweep " + crank + "--rpm 2000:2200:100 --theory nonlinear",
        "map " + measured + " --x rpm=7000:8000:4 --y rod.section.width=15:17:3 --modes 1 --stress",
        "map " + scene("mathieu") + " --x omega=1.9:2.5:4 --y hill.stiffness.1.cos.0.0=0.1:0.5:3 --damping-range 0.5:2",
        "check " + crank + "--rpm 1500 --march --stats", "check " + crank + "--rpm 1500:1600:100",
        "check " + crank + "--rpm 1500 --theory nonlinear", "bench " + scene("mathieu") + " --omega 1 --case-limit 0.1",
        "compare " + scene("slider_crank") + " " + crank + "--rpm 1500",
        "tune " + crank +
            "--minimise mass --vary rod.J=800:1000 --keep 'deflection<=5' --over rpm=2000:2200 --analyses 8",
        "fit " + measured + " --rod rod --decay '" HB_SOURCE_DIR "/results/first_steps/decay.csv'"}) {
    const CommandResult found = hb(command + " --json --no-plots");
    std::set<std::string> unknown;
    const Json document = Json::parse(found.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << command << found.err;
    add_unknown_keys(document, manual, "", unknown);
    EXPECT_EQ(unknown, std::set<std::string>()) << command;
  }
}

// Marks stood in a column that nothing explained.
TEST_F(Words, MarksInTheTableOfASweepAreExplainedWhereTheyStand) {
  const std::string sweep = "sweep " + scene("six_link") + " --modes 1 --no-search --rpm ";
  expect(said(sweep + "300:1500:600"), {" !", "!: beyond the linear theory or beyond small deflections"});
  expect(said(sweep + "300:600:100"), {}, {"!"});
}

// A mean torque of 1e-6 N m was printed beside an error of 8e-6 N m: without damping there is none.
TEST_F(Words, AMeanThatItsErrorHidesIsZero) {
  std::ofstream(folder_ / "undamped.toml")
      << "[crank]\npivot = [0, 0]\nlength = 0.04\n[[dyad]]\non = \"crank\"\nbranch = 1\n"
      << "coupler = { name = \"rod\", length = 0.16, elastic = { material = \"steel\", section = { shape = "
      << "\"rectangle\", width = 0.016, height = 0.02 } } }\n"
      << "slider = { name = \"piston\", mass = 0.6, guide = [0, 0] }\n";
  expect(said("steady undamped.toml --rpm 6000"), {"driving torque: mean 0 +/- ", "power: mean 0 +/- "});
}

// What is left was said of each of many steps as if it were of the whole, which seemed to begin anew.
TEST(Progress, WhatIsLeftOfALaterStepIsNotCalledWhatIsLeft) {
  EXPECT_EQ(hb::tools::progress_line("sweep", 30, 120, 2, 0), "sweep: 30 of 120 (25 %), 6 s left");
  EXPECT_EQ(hb::tools::progress_line("stability map, step 3", 448, 14096, 10, 60),
            "stability map, step 3: 448 of 14096 (3 %), 5.1 min left of this step; 70 s so far");
}

// The sentence was of each step alone, by its first parts: a wild map was said to take six minutes, or nothing was
// said.
TEST(Forecast, IsOfAllStepsByThePartsOfEachKind) {
  double now = 0;
  hb::tools::Forecast forecast("the map", 1, false, [&now] { return now; });
  const auto said = [&](auto&& work) {
    testing::internal::CaptureStderr();
    work();
    return testing::internal::GetCapturedStderr();
  };
  forecast.begin(10, 0, "node", {{"node", 90}, {"edge", 200}});
  EXPECT_EQ(said([&] { now = 0.1, forecast.advance(10); }), "");
  forecast.begin(20, 0, "edge", {{"node", 90}, {"edge", 180}, {"curve point", 10}});
  EXPECT_EQ(
      said([&] { now = 1.1, forecast.advance(10); }),
      "hb: the map takes about 21 s (1 thread); --threads and --time-limit change that\n");  // 1.1 + 190 x 0.1 + 0.9
  EXPECT_EQ(said([&] { now = 2.1, forecast.advance(10); }), "");
  forecast.begin(180, 90, "edge", {});  // half of them are known from an earlier run
  EXPECT_EQ(said([&] { now = 12.1, forecast.advance(10); }),
            "hb: the map takes about 44 s, as later parts show (1 thread); --threads and --time-limit change that\n");

  hb::tools::Forecast alone("the branch", 0, false, [&now] { return now; });
  alone.begin(100, 1);
  EXPECT_EQ(said([&] { now += 2, alone.advance(4); }), "hb: the branch takes about 50 s; --time-limit changes that\n");
}

// Imaginary parts were folded to half the speed without a word; a mode of 88 Hz was shown as 0.3 rad/s.
TEST_F(Words, ExponentsAreShownWithTheFrequencyOfTheMotion) {
  const std::string text = said("steady " + scene("six_link") + " --rpm 300 --modes 2");
  expect(text, {"frequency [Hz]", "damping ratio"}, {"imaginary part"});
  const Json found = Json::parse(said("steady " + scene("six_link") + " --rpm 300 --modes 2 --json"));
  const Json& rod = found["rods"]["AB"];
  ASSERT_EQ(rod["frequencies"].size(), rod["exponents"].size());
  ASSERT_EQ(rod["multipliers"].size(), rod["exponents"].size());
  const double omega = found["omega"];
  for (std::size_t k = 0; k < rod["exponents"].size(); ++k) {
    // The frequency is the folded one up to a multiple of the speed, and a turn multiplies by e^(lambda T).
    const double folded = std::abs(rod["exponents"][k][1].get<double>());
    const double turns = rod["frequencies"][k].get<double>() / omega;
    const double distance = std::abs(turns - std::round(turns)) * omega;
    EXPECT_NEAR(std::min(distance, omega - distance), std::min(folded, omega - folded), 1e-6 * omega);
    const double modulus = std::hypot(rod["multipliers"][k][0].get<double>(), rod["multipliers"][k][1].get<double>());
    EXPECT_NEAR(modulus, std::exp(rod["exponents"][k][0].get<double>() * 2 * std::numbers::pi / omega), 1e-12);
  }
  EXPECT_EQ(text.find("multipliers"), std::string::npos);
  expect(said("steady " + scene("six_link") + " --rpm 300 --modes 1 --multipliers"), {"multipliers", "modulus"});
}

// "resonance 0.0881 away" stood there for a healthy machine.
TEST_F(Words, ResonanceIsSaidAsSpeedAndAmplification) {
  const std::string text = said("steady " + scene("slider_crank") + " --rpm 3000 --modes 2");
  expect(text, {"nearest ", "Omega = omega_1 at ", "rpm", "amplification"}, {"away (1: far"});
  // A rod driven far below its first frequency follows its load.
  const Json rod = Json::parse(said("steady " + scene("slider_crank") + " --rpm 3000 --modes 2 --json"))["rods"]["rod"];
  EXPECT_NEAR(rod["amplification"].get<double>(), 1, 0.2);
  const Json& nearest = rod["nearest_resonance"];
  EXPECT_NEAR(nearest["frequency"].get<double>(), nearest["order"].get<double>() * nearest["omega"].get<double>(),
              1e-9 * nearest["frequency"].get<double>());
}

// Forces at 2400 rpm contain rod AB, which is unstable; with --rods CD text and pictures said "stable".
TEST_F(Words, TheVerdictIsTheMechanismsWhateverRodsAreShown) {
  const std::string text = said("steady " + scene("six_link") + " --rpm 2400 --modes 2 --rods CD --out out");
  EXPECT_NE(first_line(text).find("UNSTABLE because of AB"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("Verdict: UNSTABLE because of AB\n")) << text;
  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
    if (entry.path().extension() != ".svg" || entry.path().stem() == "mechanism") continue;
    ++pictures;
    expect(read(entry.path()), {"UNSTABLE because of AB"}, {", stable"});
  }
  EXPECT_GE(pictures, 5u);
}

TEST_F(Words, TheVerdictIsTheFirstLineOfEveryTable) {
  const std::string sweep = said("sweep " + scene("six_link") + " --rpm 1500:1900:100 --modes 2 --only stability");
  EXPECT_NE(first_line(sweep).find("UNSTABLE because of AB at 168"), std::string::npos) << sweep;
  const std::string map = said("map " + scene("mathieu") + " --x omega=1.5:2.6:8 --y hill.stiffness.1.scale=0.5:1:3");
  EXPECT_TRUE(first_line(map).starts_with("Forced Mathieu equation: UNSTABLE at ") &&
              first_line(map).ends_with(" % of the points"))
      << map;
  const std::string steady = said("steady " + scene("mathieu") + " --omega 1");
  EXPECT_EQ(first_line(steady), "Forced Mathieu equation, omega = 1 rad/s: stable (system)");
}

// Tables, JSON and pictures of the cross-check, the benchmark and the design said nothing of the mechanism.
TEST_F(Words, CheckBeginsWithTheVerdictOfTheMechanism) {
  const std::string at = "check " + scene("six_link") + " --modes 1 --tol 1e-7 ";
  const std::string one = said(at + "--rpm 2400 --rods CD --out out");
  EXPECT_EQ(first_line(one),
            "Six-link mechanism, 2400 rpm: UNSTABLE because of AB; harmonic balance and time integration agree");
  expect(read(folder_ / "out/check_CD.svg"), {"2400 rpm, UNSTABLE because of AB"});
  EXPECT_EQ(Json::parse(read(folder_ / "out/check.json"))["verdict"], "unstable");
  const std::string several = said(at + "--rpm 300:2400:2100 --only steady,stability --out range");
  EXPECT_EQ(first_line(several),
            "Six-link mechanism: UNSTABLE because of AB at 1 of 2 speeds; harmonic balance and time "
            "integration agree");
  EXPECT_EQ(Json::parse(read(folder_ / "range/check.json"))["verdict"], Json({"stable", "unstable"}));
  expect(read(folder_ / "range/check.svg"), {"UNSTABLE because of AB at 1 of 2 speeds"});
  const Json without = Json::parse(said(at + "--rpm 300 --only steady --json"));
  EXPECT_FALSE(without.contains("verdict"));
}

TEST_F(Words, BenchBeginsWithTheVerdictOfTheMechanism) {
  const std::string text =
      said("bench " + scene("six_link") + " --rpm 2400 --modes 1 --rods CD --case-limit 0.05 --out out");
  EXPECT_EQ(first_line(text), "Six-link mechanism, 2400 rpm: UNSTABLE because of AB");
  EXPECT_EQ(Json::parse(read(folder_ / "out/bench.json"))["verdict"], "unstable");
  expect(read(folder_ / "out/bench_CD.svg"), {"CD, 2400 rpm, UNSTABLE because of AB"});
}

TEST_F(Words, TuneBeginsWithTheVerdictOfBothDesigns) {
  const std::string question =
      "tune " + scene("six_link") +
      " --modes 1 --tol 1e-6 --minimise deflection --vary CD.J=40:50 --over rpm=1500:2400 --speeds 4 --analyses 8 "
      "--algorithm direct ";
  const CommandResult result = hb(question + "--rods CD --out out");
  ASSERT_TRUE(result.status == 0 || result.status == 3) << result.err;
  expect(first_line(result.out),
         {"Six-link mechanism: the design found is UNSTABLE because of AB over 1500 to 2400 rpm; before: UNSTABLE "
          "because of AB"});
  const Json found = Json::parse(read(folder_ / "out/tune.json"));
  EXPECT_EQ(found["verdict"], "unstable");
  EXPECT_EQ(found["verdict_before"], "unstable");
  expect(read(folder_ / "out/before_after.svg"), {"UNSTABLE because of AB"});
  // Metres stood at the unknowns of a system of equations.
  const std::string system = said("tune " + scene("mathieu") +
                                  " --minimise deflection --vary hill.damping.0.0=0.1:0.2 --over omega=3:4 --speeds 4");
  expect(system, {"the design found is stable (system) over 3 to 4 rad/s; before: stable (system)", "largest |q_i|"},
         {" m\n", "largest deflection", "crank"});
}

// The share that axial elasticity has in the correction was printed as if it were known.
TEST_F(Words, WhatAxialElasticityChangesIsARoughEstimate) {
  expect(said("steady " + scene("six_link") + " --rpm 300 --modes 1"),
         {" % would be changed by axial elasticity, which it leaves out; a rough estimate"}, {"taken away"});
  // A rod so stocky that the mass at its end swings along it as slowly as it bends.
  expect(said("steady " + scene("slider_crank") + " --rpm 300 --modes 1 --set rod.J=45000"),
         {"half or more would be changed by axial elasticity"});
}

// Without damping nothing is stable, but "bounded or stable elsewhere" stood there.
TEST_F(Words, WithoutDampingASystemIsBoundedElsewhere) {
  const std::string text = said("sweep " + scene("mathieu") + " --omega 1.5:2.6:0.1 --set hill.damping.0.0=0");
  EXPECT_EQ(first_line(text), "Forced Mathieu equation: UNSTABLE at 2.00509 to 2.36939 rad/s; bounded elsewhere");
  expect(said("steady " + scene("mathieu") + " --omega 1 --set hill.damping.0.0=0"), {"bounded"}, {" -0 "});
}

// The first line of a sweep without linearisation was that of the linear theory.
TEST_F(Words, ANonlinearSweepBeginsWithItsOwnVerdict) {
  const std::string text =
      said("sweep " + scene("four_bar") + " --rpm 60:100:20 --modes 1 --theory nonlinear --only steady,stability");
  EXPECT_NE(first_line(text).find("motion without linearisation: stable (all rods together) at all 3 points"),
            std::string::npos)
      << text;
}

// Words of a crank and millimetres stood in answers about a system of equations.
TEST_F(Words, ASystemOfEquationsHasNoCrank) {
  for (const char* arguments : {"steady ", "steady --multipliers ", "sweep --omega 1:2.2:0.1 "}) {
    const std::string command = std::string(arguments).substr(0, std::string(arguments).find(' '));
    const std::string flags = std::string(arguments).substr(command.size());
    const std::string text =
        said(command + " " + scene("mathieu") + flags + (command == "steady" ? " --omega 2.1" : ""));
    expect(text, {"rad/s"}, {"crank", "turn", " mm", " Hz", "rpm", "machine"});
  }
}

// The fastest speed, the worst one, was not in the table.
TEST_F(Words, TheLastPointOfASweepIsInItsTableWithUnits) {
  const std::string text = said("sweep " + scene("slider_crank") + " --rpm 500:4000:100 --modes 1");
  expect(text, {"\n            4000", "theory error", " rpm", "growth [1/s]"});
  const std::string peaks =
      said("sweep " + scene("six_link") + " --rpm 1000:1200:20 --rods CD --only steady,stability");
  expect(peaks, {"1095.6", " mm, mode 1 at 90.", " Hz = 5 Omega"}, {"per turn of the crank"});
}

TEST_F(Words, ASweepSaysHowFarTheNextBoundaryIs) {
  const Json found = Json::parse(said("sweep " + scene("mathieu") + " --omega 1.5:2.6:0.1 --json"))["rods"]["system"];
  EXPECT_NEAR(found["distance_to_boundary"][0].get<double>(), 2.0325246720 - 1.5, 1e-9);
  expect(said("sweep " + scene("mathieu") + " --omega 1.5:2.6:0.1"), {"to boundary [rad/s]"});
  expect(said("sweep " + scene("slider_crank") + " --rpm 500:900:100 --modes 1"), {"stable at all 5 points"},
         {"to boundary"});
}

// A bare number beside a section in mm is in the scene's metres; a sweep said so of its first value alone, a map never.
TEST_F(Words, RangesAreWarnedOfAtBothEnds) {
  const std::string scene = " " HB_SOURCE_DIR "/results/first_steps/scene.toml --modes 1 ";
  const char* const no_rod = "rod.elastic.section: found length/sqrt(J/area) = 0.0866";
  const std::string sweep = said("sweep" + scene + "--no-search --rpm 1000 --x rod.section.height=0.008:12:x3");
  expect(sweep, {"WARNING: ", no_rod, "taken as given (at rod.section.height = 12)"});
  for (const std::string axes : {"--x rpm=1000:2000:3 --y rod.section.height=0.008:12:3",
                                 "--x rod.section.height=0.008:12:3 --y rpm=1000:2000:3"}) {
    expect(said("map" + scene + "--no-boundaries " + axes), {"WARNING: ", no_rod, "(at rod.section.height = 12)"});
    const Json found = Json::parse(said("map" + scene + "--json --no-boundaries " + axes));
    EXPECT_NE(found["warnings"][0].get<std::string>().find(no_rod), std::string::npos) << found["warnings"];
  }
  // What every value has stands without a place; what none has is not said.
  expect(said("sweep" + scene + "--no-search --rpm 1000 --set rod.E=200000 --x rod.section.height=0.008:0.009:x2"),
         {"(solids have 1 GPa to 1.5 TPa); taken as given\n"});
  expect(said("map" + scene + "--no-boundaries --x rpm=1000:2000:3 --y 'rod.section.height=8 mm:9 mm:2'"), {},
         {"are section and length in their units?"});
}

// `hb check` and `hb compare` were silent on a scene that `hb steady` warns of.
TEST_F(Words, AnOddSceneIsWarnedOfWhereverItIsComputed) {
  const std::string file = HB_SOURCE_DIR "/results/first_steps/scene.toml";
  const std::string odd = " --rpm 1000 --modes 1 --set rod.section.height=12 ";
  const std::string slender = " --theory nonlinear --set rod.E=200000";
  expect(said("check " + file + " --rpm 10 --modes 1" + slender, 3), {"WARNING: ", "solids have 1 GPa to 1.5 TPa"});
  for (const std::string& command : {"steady " + file, "check " + file, "bench --case-limit 1 " + file})
    expect(said(command + odd), {"WARNING: ", "are section and length in their units?"});
  expect(said("compare " + file + " " + file + odd), {"WARNING: A and B: ", "are section and length in their units?"});
  expect(said("compare " + file + " " + file + " --rpm 1000 --modes 1 --set-b rod.section.height=12"),
         {"WARNING: B: ", "are section and length in their units?"}, {"WARNING: A"});
  expect(said("compare " + file + " " + file + " --rpm 1000:1100:x2 --modes 1 --set-b rod.section.height=12"),
         {"WARNING: B: ", "are section and length in their units?"}, {"WARNING: A"});
}

// Good answers ended with status 3 because of a tolerance that nobody had asked for.
TEST_F(Words, WhatIsKnownLessWellWithoutBeingAskedForIsANote) {
  const std::string undamped = " --omega 2 --set 'hill.damping.0.0=0' --only stability";
  EXPECT_EQ(hb("steady " + scene("mathieu") + undamped).status, 0);
  const CommandResult map = hb("map " + scene("six_link") + " --x rpm=1600:2000:5 --y AB.J=40:50:3 --modes 2");
  EXPECT_EQ(map.status, 0) << map.out;
  EXPECT_EQ(map.out.find("known to less than"), std::string::npos) << map.out;
}

// A push near the buckling load and strains that no steel bears were not worth a word.
TEST_F(Words, AnswersBeyondSmallDeflectionsSaySoAndEndWithStatus0) {
  const Json plain = Json::parse(said("steady " + scene("six_link") + " --rpm 300 --modes 2 --json"));
  EXPECT_LT(plain["rods"]["AB"]["axial_force"]["buckling_share"], 0.5);
  EXPECT_FALSE(plain.contains("warnings")) << plain["warnings"];
  const std::string steady = " --rpm 3000 --modes 2";
  const std::string text = said("steady " + scene("six_link") + steady);
  expect(text, {"of its buckling load", "stress            axial", "WARNING: AB: beyond small deflections: "});
  const Json found = Json::parse(said("steady " + scene("six_link") + steady + " --json"));
  bool told = false;
  for (const Json& warning : found["warnings"])
    told = told || warning.get<std::string>().find("beyond small deflections") != std::string::npos;
  EXPECT_TRUE(told) << found["warnings"];
  const std::string sweep = said("sweep " + scene("six_link") + " --rpm 2900:3000:50 --modes 2 --no-plots --out out");
  expect(sweep, {"beyond small deflections"});
}

TEST_F(Words, TheTimeLimitIsForTheWholeCommandAndGivesWhatIsThere) {
  const CommandResult sweep =
      hb("sweep " + scene("six_link") + " --rpm 200:6000:0.1 --only steady,stability --time-limit 1 --json");
  EXPECT_EQ(sweep.status, 3) << sweep.err;
  const Json found = Json::parse(sweep.out, nullptr, false);
  ASSERT_FALSE(found.is_discarded());
  EXPECT_NE(found["notes"][0].get<std::string>().find("ended before the answer was complete"), std::string::npos);
  EXPECT_TRUE(found["rods"]["AB"]["max_abs"][0].is_array());
  EXPECT_TRUE(found["rods"]["AB"]["max_abs"].back().is_null());
  // What was not computed is neither stable nor free of bands.
  EXPECT_EQ(found["not_excluded"]["AB"].back()[1], 6000) << found["not_excluded"]["AB"];
  const std::string text =
      hb("sweep " + scene("six_link") + " --rpm 200:6000:0.1 --only steady,stability --time-limit 1").out;
  EXPECT_NE(text.find("; no answer at "), std::string::npos) << text;
  EXPECT_EQ(text.find("elsewhere"), std::string::npos) << text;
  const CommandResult map =
      hb("map " + scene("six_link") + " --x rpm=200:6000:400 --y AB.J=20:200:300 --time-limit 1 --json");
  EXPECT_EQ(map.status, 3) << map.err;
  EXPECT_NE(Json::parse(map.out)["notes"][0].get<std::string>().find("ended before"), std::string::npos);
  for (const char* wrong : {"0", "-1", "soon"}) {
    const CommandResult refused = hb("steady " + scene("mathieu") + " --omega 1 --time-limit " + wrong);
    EXPECT_EQ(refused.status, 2) << wrong;
    EXPECT_NE(refused.err.find("--time-limit"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(hb("steady " + scene("mathieu") + " --omega 1 --time-limit 60").status, 0);
}

// With --out what is finished is kept for --resume, and the answer so far is in its folder.
TEST_F(Words, AfterTheTimeLimitResumeGoesOn) {
  const std::string arguments =
      "sweep " + scene("six_link") + " --rpm 500:900:0.05 --only steady --modes 3 --no-plots --out ";
  ASSERT_EQ(hb(arguments + "whole").status, 0);
  const CommandResult cut = hb(arguments + "parts --time-limit 1");
  ASSERT_EQ(cut.status, 3) << cut.err;
  ASSERT_TRUE(fs::exists(folder_ / "parts.part")) << cut.err;
  EXPECT_EQ(hb(arguments + "parts --resume").status, 0);
  EXPECT_EQ(read(folder_ / "whole/sweep_AB.csv"), read(folder_ / "parts/sweep_AB.csv"));
}

// Ctrl-C without --out lost everything.
TEST_F(Words, CtrlCPrintsWhatIsThere) {
  // A shell without job control starts what runs in the background with SIGINT ignored: -m turns it on.
  std::ofstream(folder_ / "run.sh") << "cd '" << folder_.string() << "'\n'" HB_COMMAND "' sweep " << scene("six_link")
                                    << " --rpm 200:6000:0.1 --only steady >out.txt 2>err.txt </dev/null &\n"
                                       "child=$!\nsleep 1.5\nkill -INT $child\nwait $child\n";
  const int status = std::system(("bash -m '" + (folder_ / "run.sh").string() + "' 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 130);
  expect(read(folder_ / "out.txt"), {"ended before the answer was complete", "AB: 5 modes"});
}

// The lower end of an interval without an upper one was told as the growth rate.
TEST_F(Words, AGrowthRateWithoutAnUpperBoundHasNone) {
  std::ofstream(folder_ / "two.toml")
      << "[hill]\nmass = [[2.0, 0.1], [0.1, 1.0]]\ndamping = [[0.2, 0.05], [0.0, 0.3]]\n"
         "stiffness = [{ harmonic = 0, cos = [[6.0, 0.5], [0.5, 9.0]] }, { harmonic = 1, "
         "cos = [[0.4, 0.2], [0.1, 0.0]] }]\nload = [{ harmonic = 1, cos = [1.0, 0] }]\n";
  const std::string at = "two.toml --omega 3.4 --only stability --stability-method ";
  const Json found = Json::parse(said("steady " + at + "bound --json"))["rods"]["system"];
  EXPECT_TRUE(found["growth_rate"].is_null()) << found["growth_rate"];
  EXPECT_TRUE(found["growth_interval"][0].is_number());
  expect(said("steady " + at + "bound"), {"growth rate       no upper bound, at least -0.09987 1/s"}, {"inf"});
  expect(said("steady " + at + "determinant"), {"growth rate       not found\n"}, {"inf"});
  const std::string range = "sweep two.toml --omega 3:3.4:0.2 --stability-method bound";
  expect(said(range), {"no bound  undecided", "not excluded in 100 % of the range"}, {"inf"});
  for (const Json& rate : Json::parse(said(range + " --json"))["rods"]["system"]["growth_rate"])
    EXPECT_TRUE(rate.is_null()) << rate;
}

// "agree" of nothing, names of nothing.
TEST_F(Words, WithoutElasticLinksNothingIsSaidOfThem) {
  std::ofstream(folder_ / "rigid.toml") << R"(
[crank]
pivot = [0, 0]
length = 0.04
[[dyad]]
on = "crank"
branch = 1
coupler = { name = "K", length = 0.22, mass = 0.3 }
rocker = { name = "R", pivot = [0.2, -0.03], length = 0.13, mass = 0.3 }
)";
  expect(said("check rigid.toml --rpm 300 --only steady"), {"could not be compared", "Nothing could be compared."});
  expect(said("check rigid.toml --rpm 300"), {"The paths agree within the sum of their error bars."});
  const std::string tune = "tune rigid.toml --vary R.mass=0.2:0.3 --over rpm=100:300 --no-plots --minimise ";
  expect(said(tune + "torque-ripple"), {"torque-ripple"});
  const CommandResult refused = hb(tune + "deflection");
  EXPECT_EQ(refused.status, 2);
  expect(refused.err, {"deflection: found no elastic link, allowed: force, torque-ripple where no link is elastic"});
}

// A value of the wrong dimension was "the path of a number".
TEST_F(Words, NumbersOfAWrongSceneSayWhatIsWrong) {
  const CommandResult paths = hb("scene " + scene("six_link") + " --paths --set 'AB.length=22 kg'");
  EXPECT_EQ(paths.status, 2);
  expect(paths.err, {"AB.length=22 kg: AB.length: found \"22 kg\", a mass, allowed a number > 0"},
         {"path of a number"});
  std::ofstream(folder_ / "flat.toml")
      << "[hill]\nmass = [[1, 1], [1, 1]]\nstiffness = [{ harmonic = 0, cos = [[1, 0], "
         "[0, 1]] }]\n";
  expect(hb("steady flat.toml --omega 1").err, {"found that the mass is singular"}, {"HillSystem"});
}

// A scene without a title had its file's name in the documents of some commands.
TEST_F(Words, TheTitleOfADocumentIsTheScenes) {
  std::ofstream(folder_ / "plain.toml")
      << "[hill]\nmass = [[1]]\ndamping = [[0.1]]\nstiffness = [{ harmonic = 0, cos = "
         "[[1.2]] }]\nload = [{ harmonic = 1, cos = [1.0] }]\n";
  for (const char* command : {"steady", "sweep", "check", "bench --case-limit 0.01"}) {
    const std::string range = std::string(command) == "sweep" ? "1:2:0.5" : "1";
    EXPECT_EQ(Json::parse(said(std::string(command) + " plain.toml --json --omega " + range))["title"], "") << command;
  }
}

// "nan", an empty list, the points of a slider passed over.
TEST_F(Words, WhatHasNoValueOrIsAPointIsSaid) {
  std::ofstream(folder_ / "resonant.toml")
      << "[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { harmonic = 0, cos = [[1, 0], "
         "[0, 9]] }\nload = { harmonic = 1, cos = [1.0, 0] }\n";
  const Json q = Json::parse(said("steady resonant.toml --omega 1 --json", 3))["rods"]["system"]["q"];
  EXPECT_EQ(q["max_abs"], Json({nullptr, nullptr}));
  EXPECT_EQ(q["crank_angle"], Json({nullptr, nullptr}));
  std::ofstream(folder_ / "slider.toml") << R"(
[crank]
pivot = [0, 0]
length = 0.04
[[dyad]]
on = "crank"
branch = 1
coupler = { name = "rod", length = 0.19, mass = 0.3 }
slider = { name = "piston", mass = 0.4, guide = [0, 0], points = { P = [0.05, 0.0] } }
)";
  expect(said("scene slider.toml"), {"point piston.P at (0.05, 0) m in its frame"});
  const Json slider = Json::parse(said("scene slider.toml --json"))["linkage"]["dyads"][0]["slider"];
  EXPECT_EQ(slider["points_xy"]["P"], Json({0.05, 0.0}));
}

// A whole number of the scene was refused as 1.0; modes are shared by all points.
TEST_F(Words, WholeNumbersOfTheSceneCanBeSwept) {
  std::ofstream(folder_ / "two.toml") << "[hill]\nmass = [[1]]\ndamping = [[0.1]]\nstiffness = { harmonic = 0, cos = "
                                         "[[4]] }\nload = [{ harmonic = 1, cos = [1] }]\n";
  const Json found = Json::parse(said("sweep two.toml --omega 1 --x hill.load.0.harmonic=1:2:1 --no-search --json"));
  EXPECT_NEAR(found["rods"]["system"]["max_abs"][0][0], 1 / std::hypot(3, 0.1), 1e-12);
  EXPECT_NEAR(found["rods"]["system"]["max_abs"][1][0], 1 / 0.2, 1e-12);
  const CommandResult modes = hb("sweep " + scene("six_link") + " --rpm 300 --x analysis.modes=1:3:1");
  EXPECT_EQ(modes.status, 2);
  expect(modes.err, {"analysis.modes", "all points share the rest"});
}

}  // namespace
