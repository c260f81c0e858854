// The `hb` command as its users meet it: flags, output folders, `hb scene`.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

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
  for (const char* name : {"steady.json", "joint_forces.csv", "torque.csv", "mechanism.csv", "plots.gp"}) {
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
  EXPECT_FALSE(fs::exists(folder_ / "out/plots.gp"));
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
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("gnuplot is not installed"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/response_system.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/plots.gp"));
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
    {"--rpm 3e2x", "\"3e2x\"", "positive"},
    {"--rpm 1e999", "\"1e999\"", "positive"},
    {"--rpm 1:2", "\"1:2\"", "FROM:TO:STEP"},
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
    {"--rpm 300 --only all", "--only: found \"all\"", "steady, stability, verdict, reactions, shape"},
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

TEST_F(Command, SceneSaysWhatItUnderstood) {
  const CommandResult table = hb("scene " + scene("six_link"));
  EXPECT_EQ(table.status, 0) << table.err;
  for (const char* part : {"O2BC", "natural frequencies", "transmission angle", "mm", "WARNING"}) {
    EXPECT_NE(table.out.find(part), std::string::npos) << part;
  }
  const CommandResult result = hb("scene " + scene("six_link") + " --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["linkage"]["dyads"].size(), 2u);
  // The paper's moments of inertia of both rockers are smaller than mass times radius^2.
  ASSERT_EQ(found["warnings"].size(), 2u);
  EXPECT_NE(found["warnings"][0].get<std::string>().find("inertia_pivot"), std::string::npos);
  // omega_1 = (pi/l)^2 sqrt(EJ/mu) of AB.
  const double l = 259, mu = 0.165 / l;
  const double omega = std::pow(std::numbers::pi / l, 2) * std::sqrt(21e7 * 45 / mu);
  EXPECT_NEAR(found["linkage"]["dyads"][0]["coupler"]["natural_frequencies"][0], omega, 1e-12 * omega);
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
  EXPECT_NE(table.find("constant applied force -7 kg m/s^2"), std::string::npos) << table;
  EXPECT_EQ(table.find("e-1"), table.find("e-10")) << table;  // the tolerance
  EXPECT_EQ(Json::parse(hb("scene s.toml --json").out)["linkage"]["crank"]["com_xy"][0], 0.0);
}

TEST_F(Command, SceneDrawsTheMechanism) {
  const CommandResult result = hb("scene " + scene("eight_link") + " --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* name : {"mechanism.svg", "mechanism.png", "mechanism.csv"}) {
    EXPECT_GT(fs::file_size(folder_ / "out" / name), 1000u) << name;
  }
}

}  // namespace
