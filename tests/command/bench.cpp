// `hb bench` as its users meet it. Times are not looked at.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "hb/analysis/bench_rod.hpp"
#include "tests/support/run_command.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Bench : public CommandTest {
 protected:
  Json rows(const std::string& arguments, const std::string& rod) const {
    const CommandResult result = hb("bench " + arguments + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out)["rods"][rod];
  }
};

// x'' + 0.1 x' + (1.2 + 0.4 cos t) x = cos t.
TEST_F(Bench, EveryMethodConvergesOnTheForcedMathieuEquation) {
  const Json found = rows(scene("mathieu") + " --omega 1 --case-limit 2", "system");
  EXPECT_EQ(found["verdict"], "stable");
  EXPECT_LE(found["reference_error"].get<double>(), 1e-11);
  std::map<std::string, double> best;
  for (const Json& row : found["rows"]) {
    const double error = row["error"];
    EXPECT_GT(row["seconds"].get<double>(), 0);
    double& smallest = best.emplace(row["method"], HUGE_VAL).first->second;
    smallest = std::min(smallest, error);
    if (row["method"] == "harmonic balance, automatic") {
      EXPECT_LE(error, row["asked"].get<double>() + found["reference_error"].get<double>());
    }
  }
  EXPECT_LE(best.at("harmonic balance, given harmonics"), 1e-11);
  EXPECT_LE(best.at("harmonic balance, automatic"), 1e-11);
  EXPECT_LE(best.at("shooting, CVODE Adams"), 1e-9);
  EXPECT_LE(best.at("shooting, CVODE BDF"), 1e-6);
  EXPECT_LE(best.at("marching, CVODE Adams"), 1e-6);
  EXPECT_LE(best.at("marching, Newmark"), 1e-2);
  EXPECT_LE(best.at("marching, Runge-Kutta 4"), 1e-4);
  EXPECT_EQ(found["ratios"].size(), 4u);
}

// What both paths leave out was told by all commands but this one.
TEST_F(Bench, SaysWhatTheLinearTheoryLeavesOut) {
  const std::string of = scene("six_link") + " --rpm 1500 --modes 1";
  const CommandResult result = hb("bench " + of + " --rods AB --case-limit 0.01 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out), steady = Json::parse(hb("steady " + of + " --json").out);
  const double expected = steady["rods"]["AB"]["theory_error"];
  EXPECT_NEAR(found["rods"]["AB"]["theory_error"], expected, 1e-6 * expected);
  EXPECT_NE(found["warnings"].dump().find("AB: beyond the linear theory"), std::string::npos) << found["warnings"];
}

TEST_F(Bench, WritesTheTableAndAPicture) {
  const CommandResult result =
      hb("bench " + scene("six_link") + " --rpm 300 --modes 1 --rods AB --case-limit 0.05 --out out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("error"), std::string::npos);
  for (const char* name : {"bench.csv", "bench_AB.svg", "bench_AB.png"}) {
    EXPECT_GT(fs::file_size(folder_ / "out" / name), 1000u) << name;
  }
  EXPECT_EQ(num_entries(folder_ / "out"), 6u);  // bench.json, bench.gp and the list of all beside
  // Every method's points are joined by a line.
  const std::string picture = read(folder_ / "out" / "bench_AB.svg");
  for (const char* method : {"harmonic balance, automatic", "shooting, CVODE BDF", "marching, Newmark", "reference"})
    EXPECT_NE(picture.find(method), std::string::npos) << method;
}

TEST_F(Bench, SaysTheLargestMemory) {
  const std::string run = "bench " + scene("mathieu") + " --omega 1 --case-limit 0.02";
  const double megabytes = Json::parse(hb(run + " --json").out)["memory_megabytes"];
  EXPECT_GT(megabytes, 4);
  EXPECT_LT(megabytes, 200);
  const std::string text = hb(run).out, before = "largest memory of the whole run: ";
  const std::size_t at = text.find(before);
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(at + before.size())), megabytes, 0.3 * megabytes);
}

// What is not known to an accuracy is not said to be reached.
TEST(RatioSentence, CountsTheErrorOfTheReference) {
  using namespace hb;
  RodBench bench;
  bench.reference_error = 6e-7;
  bench.rows = {{"rod", "harmonic balance, automatic", 1e-6, 8, 5e-7, 1e-4, 1e-4, true},
                {"rod", "shooting, CVODE Adams", 1e-6, 100, 3e-7, 2e-3, 2e-3, false}};
  EXPECT_NE(ratio_sentence(bench, 1e-7).find("not known"), std::string::npos) << ratio_sentence(bench, 1e-7);
  EXPECT_NE(ratio_sentence(bench, 1e-6).find("only shooting"), std::string::npos) << ratio_sentence(bench, 1e-6);
  EXPECT_NE(ratio_sentence(bench, 1e-3).find("20 times as long"), std::string::npos) << ratio_sentence(bench, 1e-3);
  bench.rows[1].seconds = 1e-5;
  EXPECT_NE(ratio_sentence(bench, 1e-3).find("shorter by a factor of 10"), std::string::npos)
      << ratio_sentence(bench, 1e-3);
}

TEST_F(Bench, LeavesNothingBehindWhenInterrupted) {
  for (const char* folder : {"out", "a/b/c"}) {
    const CommandResult result = hb("bench " + scene("six_link") + " --rpm 300 --out " + folder, "timeout -s INT 0.3");
    EXPECT_NE(result.status, 0);
    EXPECT_EQ(num_entries(folder_), 0u) << folder;
  }
}

TEST_F(Bench, WrongFlagsEndWithStatus2) {
  for (const char* flags : {"--rpm 100:200:10", "--rpm 0", "--rpm 300 --case-limit 0", "--rpm 300 --case-limit nan"}) {
    const CommandResult result = hb("bench " + scene("six_link") + " " + flags);
    EXPECT_EQ(result.status, 2) << flags;
    EXPECT_TRUE(result.out.empty()) << flags;
    EXPECT_FALSE(result.err.empty()) << flags;
  }
}

}  // namespace
