// The `hb` command as its users meet it: flags, output folders, `hb scene`.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;
using Command = CommandTest;
using Output = CommandTest;

TEST_F(Output, WritesCsvAndPictures) {
  const CommandResult result = hb("steady " + scene("slider_crank") + " --rpm 600 --modes 2 --out new/results");
  ASSERT_EQ(result.status, 0) << result.err;
  const fs::path out = folder_ / "new/results";
  for (const char* name : {"steady.json", "joint_forces.csv", "torque.csv", "mechanism.csv", "steady.gp"}) {
    EXPECT_TRUE(fs::is_regular_file(out / name)) << name;
  }
  // Every picture of the script is there in both forms, and nothing else lies about.
  std::size_t svg = 0, png = 0;
  for (const auto& entry : fs::directory_iterator(out)) {
    const std::string extension = entry.path().extension().string();
    svg += extension == ".svg";
    png += extension == ".png";
    if (entry.path().filename() != ".hb-steady") {
      EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
    }
    if (extension == ".csv") {
      const std::string text = read(entry.path());
      EXPECT_EQ(text.front(), '#') << entry.path();
      EXPECT_EQ(text.find("nan"), std::string::npos) << entry.path();
    }
  }
  EXPECT_EQ(svg, png);
  EXPECT_GE(svg, 9u);
  EXPECT_EQ(num_entries(folder_ / "new"), 1u);
}

TEST_F(Output, AddsToAFolderWithoutTouchingOtherFiles) {
  fs::create_directory(folder_ / "out");
  std::ofstream(folder_ / "out/mine.txt") << "mine";
  const std::string arguments = "steady " + scene("mathieu") + " --omega 1 --no-plots --out out";
  ASSERT_EQ(hb(arguments).status, 0);
  const std::size_t entries = num_entries(folder_ / "out");
  ASSERT_EQ(hb(arguments).status, 0);
  EXPECT_EQ(read(folder_ / "out/mine.txt"), "mine");
  EXPECT_EQ(num_entries(folder_ / "out"), entries);
  EXPECT_FALSE(fs::exists(folder_ / "out/steady.gp"));
}

TEST_F(Output, ReplacesTheFilesOfAnEarlierRunAndNoOthers) {
  const std::string base = "steady " + scene("six_link") + " --rpm 300 --modes 1 --no-plots --out out";
  ASSERT_EQ(hb(base).status, 0);
  ASSERT_TRUE(fs::exists(folder_ / "out/response_CD.csv"));
  std::ofstream(folder_ / "out/mine.csv") << "mine";
  std::ofstream(folder_ / "beside") << "mine";
  // Nothing outside the folder goes, whatever the list says, nor does a folder or what stands behind a link.
  fs::create_directory(folder_ / "out/sub");
  fs::create_symlink("mine.csv", folder_ / "out/link");
  std::ofstream(folder_ / "out/.hb-steady", std::ios::app) << "../beside\nsub\nlink\n\n.\n..\n";
  ASSERT_EQ(hb(base + " --rods AB").status, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/response_CD.csv"));
  for (const char* kept : {"out/response_AB.csv", "out/mine.csv", "out/link", "out/sub", "beside"})
    EXPECT_TRUE(fs::exists(folder_ / kept)) << kept;
  // Another command's files stay.
  ASSERT_EQ(hb("scene " + scene("mathieu") + " --out out").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/response_AB.csv"));
}

TEST_F(Output, WithoutGnuplotTheTablesAreWrittenAndItSaysSo) {
  fs::create_directory(folder_ / "empty");
  const CommandResult result =
      hb("steady " + scene("mathieu") + " --omega 1 --out out", "PATH='" + (folder_ / "empty").string() + "'");
  EXPECT_EQ(result.status, 4);
  EXPECT_NE(result.err.find("gnuplot is not installed; `gnuplot steady.gp` in out draws them"), std::string::npos)
      << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/response_system.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/steady.gp"));
}

TEST_F(Output, UnwritableOutputIsAnErrorThatLeavesNothing) {
  std::ofstream(folder_ / "file") << "x";
  fs::create_directories(folder_ / "blocked/torque.csv");
  for (const char* place : {"file", "file/below", "/proc/hb-test", "/dev/null", "''"}) {
    const CommandResult result = hb("steady " + scene("six_link") + " --rpm 300 --out " + place);
    EXPECT_EQ(result.status, 2) << place;
    EXPECT_NE(result.err.find("--out"), std::string::npos) << result.err;
    EXPECT_TRUE(result.out.empty()) << place;
  }
  const CommandResult blocked = hb("steady " + scene("six_link") + " --rpm 300 --no-plots --out blocked");
  EXPECT_EQ(blocked.status, 2);
  EXPECT_NE(blocked.err.find("torque.csv"), std::string::npos) << blocked.err;
  EXPECT_EQ(num_entries(folder_ / "blocked"), 1u);
  EXPECT_EQ(num_entries(folder_), 2u);
}

TEST_F(Output, AFullDiskIsAnErrorThatLeavesNothing) {
  // A limit on the size of files acts on a write like a full disk.
  for (const char* options : {"", "--no-plots"}) {
    const CommandResult result =
        hb("steady " + scene("six_link") + " --rpm 300 --out deep/out " + options, "ulimit -f 20;");
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_NE(result.err.find("cannot be written"), std::string::npos) << result.err;
    EXPECT_EQ(num_entries(folder_), 0u);
  }
}

TEST_F(Output, AFullStandardOutputIsAnError) {
  const std::string line = "'" HB_COMMAND "' steady " + scene("mathieu") + " --omega 1 --json >/dev/full 2>/dev/null";
  const int status = std::system(line.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

TEST_F(Output, NothingIsWrittenWhenTheInputIsWrong) {
  for (const char* arguments :
       {" --rpm -1", " --rpm 300 --modes 0", " --rpm 300 --rods EF", " --rpm 300 --set AB.nix=1"}) {
    const CommandResult result = hb("steady " + scene("six_link") + arguments + " --out out");
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_TRUE(result.out.empty()) << arguments;
    EXPECT_EQ(num_entries(folder_), 0u) << arguments;
  }
}

struct WrongFlag {
  const char* arguments;
  const char* named;  // must stand in the message
  const char* allowed;  // so must this
};

class WrongFlags : public CommandTest, public testing::WithParamInterface<WrongFlag> {};

TEST_P(WrongFlags, ExitWith2NamingFlagAndWhatIsAllowed) {
  const CommandResult result = hb("steady " + scene("six_link") + " " + GetParam().arguments);
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_TRUE(result.out.empty());
  EXPECT_NE(result.err.find(GetParam().named), std::string::npos) << result.err;
  EXPECT_NE(result.err.find(GetParam().allowed), std::string::npos) << result.err;
}

constexpr WrongFlag wrong_flags[] = {
    {"--rpm 0", "--rpm: found \"0\"", "positive"},
    {"--rpm -5", "\"-5\"", "positive"},
    {"--rpm nan", "\"nan\"", "positive"},
    {"--rpm inf", "\"inf\"", "positive"},
    {"--rpm 3e2x", "\"3e2x\"", "unknown unit x"},
    {"--rpm 1e999", "\"1e999\"", "positive"},
    {"--rpm 1:2", "\"1:2\"", "a positive number"},
    {"--omega 0", "--omega", "positive"},
    {"--rpm 300 --omega 2", "--omega", "one of the two"},
    {"--rpm 1e13", "--rpm: found \"1e13\"", "1e+12"},
    {"--rpm 1e-13", "1e-13", "1e-12"},
    {"--rpm \"\"", "--rpm", "value"},
    {"--rpm 300 --modes \"\"", "--modes", "value"},
    {"--rpm 300 --modes 0", "--modes: found \"0\"", "1 to 60"},
    {"--rpm 300 --modes 61", "\"61\"", "1 to 60"},
    {"--rpm 300 --modes 2.5", "\"2.5\"", "1 to 60"},
    {"--rpm 300 --modes many", "\"many\"", "auto"},
    {"--rpm 300 --tol 0", "--tol: found \"0\"", "1e-14"},
    {"--rpm 300 --tol -1e-3", "\"-1e-3\"", "1e-14"},
    {"--rpm 300 --tol nan", "\"nan\"", "1e-14"},
    {"--rpm 300 --only all", "--only: found \"all\"", "steady, stability, growth, verdict, reactions, shape"},
    {"--rpm 300 --only steady,", "--only", "commas"},
    {"--rpm 300 --rods AB,,CD", "--rods", "commas"},
    {"--rpm 300 --threads 0", "--threads: found \"0\"", "1 to"},
    {"--rpm 300 --set AB.J", "--set: found \"AB.J\"", "PATH=VALUE"},
    {"--rpm 300 --set AB.J=", "--set", "PATH=VALUE"},
    {"--rpm 300 --set AB.J=-1", "AB.J", "> 0"},
    {"--rpm 300 --bound firm", "--bound", "proved"},
    {"--rpm 300 --steady-method magic", "--steady-method", "iterative"},
    {"--rpm 300 --stability-method magic", "--stability-method", "propagation"},
    {"--rpm 300 --rpm 400", "--rpm", "--help"},
    {"--rpm", "--rpm", "--help"},
    {"--frequency 3", "--frequency", "--help"},
    {"--rpm 300 --out --json", "--out: found \"--json\"", "a folder"},
};

INSTANTIATE_TEST_SUITE_P(Each, WrongFlags, testing::ValuesIn(wrong_flags));

TEST_F(Command, HelpAndVersionSucceed) {
  for (const char* arguments : {"--help", "steady --help", "scene --help", "--version"}) {
    const CommandResult result = hb(arguments);
    EXPECT_EQ(result.status, 0) << arguments;
    EXPECT_FALSE(result.out.empty()) << arguments;
  }
}

TEST_F(Command, HelpNamesEachCommandAndEachHasItsOwn) {
  const std::string all = hb("--help").out;
  for (const std::string name :
       {"new", "scene", "steady", "sweep", "map", "check", "bench", "tune", "report", "compare", "fit"}) {
    EXPECT_NE(all.find("\n  " + name + " "), std::string::npos) << name;
    const CommandResult own = hb(name + " --help");
    EXPECT_EQ(own.status, 0) << name;
    EXPECT_NE(own.out.find("Usage: hb " + name), std::string::npos) << own.out;
    EXPECT_EQ(hb("help " + name).out, own.out);
  }
}

TEST_F(Command, WrongCommandsExitWith2) {
  std::ofstream(folder_ / "empty.toml");
  for (const char* arguments :
       {"", "stedy", "steady", "scene", "scene missing.toml", "scene .", "scene empty.toml", "scene a b"}) {
    const CommandResult result = hb(arguments);
    EXPECT_EQ(result.status, 2) << arguments << result.err;
    EXPECT_TRUE(result.out.empty()) << arguments;
    EXPECT_FALSE(result.err.empty()) << arguments;
  }
}

TEST_F(Command, AMisspeltCommandIsRecognised) {
  for (const auto& [typed, meant] : {std::pair("stedy", "steady meant?"), std::pair("scnee x.toml", "scene meant?")}) {
    const CommandResult result = hb(typed);
    EXPECT_EQ(result.status, 2) << typed;
    EXPECT_NE(result.err.find(meant), std::string::npos) << result.err;
  }
  EXPECT_EQ(hb("qqqqqqqqqqqq").err.find("meant?"), std::string::npos);
}

TEST_F(Command, HillScenesHaveNoModesToChooseAndNoJoints) {
  for (const char* flags : {"--modes 3", "--only reactions", "--only shape,reactions"}) {
    const CommandResult result = hb("steady " + scene("mathieu") + " --omega 1 " + flags);
    EXPECT_EQ(result.status, 2) << flags;
    EXPECT_TRUE(result.out.empty()) << flags;
  }
  EXPECT_EQ(hb("steady " + scene("mathieu") + " --omega 1 --modes 1 --only steady").status, 0);
}

TEST_F(Command, RodsOfSimilarNamesKeepTheirFiles) {
  std::string text = read(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  for (const auto& [from, to] : {std::pair("\"AB\"", "\"Ä+b\""), std::pair("\"CD\"", "\"Ö+b\"")})
    text.replace(text.find(from), 4, to);
  std::ofstream(folder_ / "names.toml") << text;
  const CommandResult result = hb("steady names.toml --rpm 300 --modes 1 --no-plots --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/response_Ä%2Bb.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/response_Ö%2Bb.csv"));
}

TEST_F(Command, NewWritesScenesThatRunAtOnce) {
  for (const char* kind : {"slider-crank", "four-bar", "six-link", "hill"}) {
    const std::string name = kind;
    const CommandResult made = hb("new " + name);
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_NE(made.out.find("hb steady " + name + ".toml"), std::string::npos) << made.out;
    const CommandResult understood = hb("scene " + name + ".toml");
    EXPECT_EQ(understood.status, 0) << understood.err;
    EXPECT_EQ(understood.out.find("WARNING"), std::string::npos) << understood.out;
    const CommandResult steady = hb("steady " + name + ".toml");
    EXPECT_EQ(steady.status, 0) << steady.err;
    EXPECT_EQ(steady.out.find("WARNING"), std::string::npos) << steady.out;
    EXPECT_TRUE(steady.out.ends_with(name == "hill" ? "Verdict: stable (system)\n" : ")\n")) << steady.out;
  }
  const std::string before = read(folder_ / "hill.toml");
  const CommandResult twice = hb("new slider-crank hill.toml");
  EXPECT_EQ(twice.status, 2);
  EXPECT_NE(twice.err.find("hill.toml, which is there already"), std::string::npos) << twice.err;
  EXPECT_EQ(read(folder_ / "hill.toml"), before);
  EXPECT_EQ(hb("new four-bar mine.toml").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "mine.toml"));
  const CommandResult shown = hb("new four-bar -");
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(shown.out, read(folder_ / "mine.toml"));
  const CommandResult unknown = hb("new fourbar");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("found \"fourbar\" (four-bar meant?), allowed: slider-crank"), std::string::npos)
      << unknown.err;
  EXPECT_EQ(hb("new hill no/such/folder.toml").status, 2);
}

// The first run ended with two warnings that change nothing.
TEST_F(Command, TheFirstRunEndsWithTheVerdict) {
  const CommandResult result = hb("steady '" HB_SOURCE_DIR "/results/six_link/scene.toml' --rpm 300");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.find("WARNING"), std::string::npos) << result.out;
  EXPECT_TRUE(result.out.ends_with("Verdict: stable (AB, CD)\n")) << result.out;
}

// 210000 with mm, kg, s was taken for 210 MPa without a word.
TEST_F(Command, AWrongUnitOfYoungsModulusIsToldInOneLine) {
  const CommandResult result = hb("steady " + scene("six_link") + " --rpm 300 --modes 1 --set '*.E=210000'");
  bool told = false;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    told = told || (line.starts_with("WARNING: ") &&
                    line.find("210 MPa; 210 GPa if the number was in MPa") != std::string::npos);
  }
  EXPECT_TRUE(told) << result.out;
}

TEST_F(Command, SceneSaysWhatItUnderstood) {
  const CommandResult table = hb("scene " + scene("six_link"));
  EXPECT_EQ(table.status, 0) << table.err;
  for (const char* part : {"O2BC", "natural frequencies", "transmission angle", "mm", "NOTE", "E 210 GPa", " Hz"}) {
    EXPECT_NE(table.out.find(part), std::string::npos) << part;
  }
  const CommandResult result = hb("scene " + scene("six_link") + " --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["linkage"]["dyads"].size(), 2u);
  // The paper's moments of inertia of both rockers are smaller than mass times radius^2: of no effect, said here alone.
  EXPECT_TRUE(found["warnings"].empty());
  ASSERT_EQ(found["notes"].size(), 2u);
  EXPECT_NE(found["notes"][0].get<std::string>().find("inertia_pivot"), std::string::npos);
  EXPECT_EQ(hb("steady " + scene("six_link") + " --rpm 300 --modes 1").out.find("inertia_pivot"), std::string::npos);
  // omega_1 = (pi/l)^2 sqrt(EJ/mu) of AB.
  const double l = 259, mu = 0.165 / l;
  const double omega = std::pow(std::numbers::pi / l, 2) * std::sqrt(21e7 * 45 / mu);
  EXPECT_NEAR(found["linkage"]["dyads"][0]["coupler"]["natural_frequencies"][0], omega, 1e-12 * omega);
}

// The range, mean and sense of a force were nowhere: bar taken for newton, or the wrong sign, could not be seen.
TEST_F(Command, SceneShowsTheForceInNewton) {
  const std::string table = hb("scene " + scene("slider_crank")).out;
  EXPECT_NE(table.find("applied force -2000 .. "), std::string::npos) << table;
  EXPECT_NE(table.find("N, mean -"), std::string::npos) << table;
  EXPECT_NE(table.find("positive = along direction (away from the crank)"), std::string::npos) << table;
  const CommandResult pressure = hb("scene " + scene("slider_crank_units") + " --json");
  ASSERT_EQ(pressure.status, 0) << pressure.err;
  const Json force = Json::parse(pressure.out)["linkage"]["dyads"][0]["slider"]["force"];
  EXPECT_LT(force["min"], -850.0);
  EXPECT_GT(force["min"], -900.0);
}

TEST_F(Command, SceneShowsWhatAHillSystemIs) {
  const CommandResult table = hb("scene " + scene("sampled_stiffness"));
  ASSERT_EQ(table.status, 0) << table.err;
  for (const char* part : {"mean stiffness", "natural frequencies of the mean system", "mass symmetric",
                           "stiffness NOT symmetric, by up to 0.0"}) {
    EXPECT_NE(table.out.find(part), std::string::npos) << part << table.out;
  }
  const Json found = Json::parse(hb("scene " + scene("two_oscillators") + " --json").out)["system"];
  EXPECT_EQ(found["asymmetry"]["stiffness"], 0.0);
  EXPECT_EQ(found["mean_stiffness"].size(), 3u);
  EXPECT_EQ(found["natural_frequencies"].size(), 2u);
  // M = 1, mean stiffness 1.2.
  const Json mathieu = Json::parse(hb("scene " + scene("mathieu") + " --json").out)["system"];
  EXPECT_NEAR(mathieu["natural_frequencies"][0], std::sqrt(1.2), 1e-15);
}

TEST_F(Command, TransmissionAngleOfACentricSliderCrankIsSmallestAtRightAngles) {
  // Coupler at sin(angle to the guide) = r/l when the crank stands across the guide.
  std::ofstream(folder_ / "s.toml") << "[crank]\npivot = [0, 0]\nlength = 1\n[[dyad]]\non = \"crank\"\n"
                                       "coupler = { name = \"rod\", length = 3 }\n"
                                       "slider = { name = \"piston\", mass = 1, guide = [0, 0], direction = 0 }\n"
                                       "branch = 1\n";
  const CommandResult result = hb("scene s.toml --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json angle = Json::parse(result.out)["linkage"]["dyads"][0]["transmission_angle"];
  EXPECT_NEAR(angle["min"], std::acos(1.0 / 3), 1e-12);
  EXPECT_NEAR(std::abs(std::sin(angle["crank_angle"].get<double>())), 1, 1e-9);
}

TEST_F(Command, SceneHasNoRoundingInCoordinatesAndNamesAConstantForce) {
  std::ofstream(folder_ / "s.toml") << "[units]\nangle = \"deg\"\n[crank]\npivot = [0, 0]\nlength = 1\nmass = 1\n"
                                       "com = [0.5, 90]\n[[dyad]]\non = \"crank\"\n"
                                       "coupler = { name = \"rod\", length = 3 }\n"
                                       "slider = { name = \"piston\", mass = 1, guide = [0, 0], direction = 0, "
                                       "force = -7 }\nbranch = 1\n";
  const std::string table = hb("scene s.toml").out;
  EXPECT_NE(table.find("centre of mass (0, 0.5)"), std::string::npos) << table;
  EXPECT_NE(table.find("constant applied force -7 N, positive = along direction (away from the crank)"),
            std::string::npos)
      << table;
  EXPECT_EQ(table.find("e-1"), table.find("e-10")) << table;  // the tolerance
  EXPECT_EQ(Json::parse(hb("scene s.toml --json").out)["linkage"]["crank"]["com_xy"][0], 0.0);
}

TEST_F(Command, SceneDrawsTheMechanism) {
  const CommandResult result = hb("scene " + scene("eight_link") + " --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"scene_mechanism.svg", "scene_mechanism.png", "scene_mechanism.csv"}) {
    EXPECT_GT(fs::file_size(folder_ / "out" / name), 1000u) << name;
  }
}

}  // namespace
