// Files of samples: forces and pressures over the crank angle, matrices and loads of [hill].
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <sstream>

#include "lib/constants.hpp"
#include "lib/scene/scene.hpp"

using namespace hb;

namespace {

class SampleFiles : public testing::Test {
 protected:
  SampleFiles() { std::filesystem::create_directories(folder_); }
  ~SampleFiles() override { std::filesystem::remove_all(folder_); }

  // A 2 x 2 system with stiffness from the file.
  Scene hill(const std::string& csv, const std::string& more = "", const std::string& before = "") {
    std::ofstream(folder_ / "k.csv") << csv;
    return parse_scene(before + "[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { file = \"k.csv\" }\n" + more,
                       "file.toml", {}, folder_);
  }
  static FourierSeries stiffness(const Scene& scene) { return std::get<HillSystem>(scene.model).stiffness[0]; }

  Scene slider(const std::string& csv, const std::string& force, const std::vector<Override>& overrides = {},
               const std::string& branch = "1") {
    std::ofstream(folder_ / "f.csv") << csv;
    return parse_scene(
        "units.angle = \"deg\"\n[crank]\npivot = [0, 0]\nlength = 0.04\n[[dyad]]\non = \"crank\"\ncoupler = { name = "
        "\"rod\", length = 0.15 }\nslider = { name = \"piston\", mass = 0.4, guide = [0, 0], " +
            force + " }\nbranch = " + branch + "\n",
        "file.toml", overrides, folder_);
  }
  static FourierSeries force(const Scene& scene) {
    return std::get<Slider>(std::get<Linkage>(scene.model).dyads[0].closing).force;
  }

  static std::string message(const std::function<Scene()>& read) {
    try {
      (void)read();
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("hb_sample_files_" + std::to_string(getpid()));
};

double k11(double t) { return 3 + std::cos(t); }
double k12(double t) { return 0.25 * std::sin(2 * t); }
double k22(double t) { return 5 + 0.5 * std::sin(t); }

// Rows "angle,k11,k12,k22" and the like, `n` to a turn; `closing` repeats the first at the end.
std::string rows(int n, double turn, bool angle, bool closing, bool full) {
  std::ostringstream out;
  out << std::setprecision(17);
  for (int j = 0; j < n + closing; ++j) {
    const double t = 2 * pi * (j % n) / n;
    if (angle) out << turn * j / n << ',';
    out << k11(t) << ',' << k12(t) << ',';
    if (full) out << k12(t) << ',';
    out << k22(t) << '\n';
  }
  return out.str();
}

void expect_the_stiffness(const FourierSeries& found) {
  ASSERT_EQ(found.num_components(), 4);
  for (const double t : {0.0, 0.7, 2.0, 5.5}) {
    const Eigen::VectorXd at = fourier::evaluate(found, t);
    EXPECT_NEAR(at(0), k11(t), 100 * eps);
    EXPECT_NEAR(at(1), k12(t), 100 * eps);
    EXPECT_NEAR(at(2), k12(t), 100 * eps);
    EXPECT_NEAR(at(3), k22(t), 100 * eps);
  }
}

}  // namespace

// A table angle,k11,k12,k22 of a symmetric 2 x 2 system was read as four stiffnesses row by row: another system, with
// another verdict.
TEST_F(SampleFiles, HeaderNamesDecideTheColumns) {
  const std::string deg = "units.angle = \"deg\"\n";
  expect_the_stiffness(stiffness(hill("angle,k11,k12,k22\n" + rows(36, 360, true, false, false), "", deg)));
  expect_the_stiffness(stiffness(hill("angle,k11,k12,k22\n" + rows(36, 360, true, true, false), "", deg)));
  expect_the_stiffness(stiffness(hill("angle,k11,k12,k22\n" + rows(36, 2 * pi, true, true, false))));
  expect_the_stiffness(stiffness(hill("angle [deg],K_11,K_12,K_22\n" + rows(36, 360, true, true, false))));
  expect_the_stiffness(stiffness(hill("k11,k12,k22\n" + rows(36, 0, false, false, false))));
  expect_the_stiffness(stiffness(hill("k11,k21,k22\n" + rows(36, 0, false, false, false))));
  expect_the_stiffness(stiffness(hill("\"c11\";\"c12\";\"c21\";\"c22\"\n" + rows(36, 0, false, false, true))));
  expect_the_stiffness(stiffness(hill(rows(36, 0, false, false, true))));
  // Other orders, and a first angle that is not 0.
  std::ostringstream turned;
  turned << "k22,angle,k11,k12\n" << std::setprecision(17);
  for (int j = 0; j < 24; ++j) {
    const double t = 2 * pi * (j + 0.3) / 24;
    turned << k22(t) << ',' << t << ',' << k11(t) << ',' << k12(t) << '\n';
  }
  expect_the_stiffness(stiffness(hill(turned.str())));
}

TEST_F(SampleFiles, ColumnsThatDoNotMakeAMatrixAreRefused) {
  const std::string data = rows(12, 2 * pi, true, false, false);
  for (const auto& [header, part] : std::vector<std::pair<std::string, std::string>>{
           {"angle,k11,k12,k33", "the column \"k33\", allowed angle, k11, k12, ... k22"},
           {"angle,k11,k12,x", "the column \"x\", allowed angle"},
           {"time,k11,k12,k22", "the column \"time\", allowed angle"},
           {"angle,k11,k12,k12", "the column \"k12\" for an entry that another column gives"},
           {"angle,k11,k12,k21", "no column k22"},
           {"angle,k11,k12,c22", "the column \"c22\" beside columns of k"},
           {"angle,angle,k11,k22", "a second one of angles"},
       }) {
    const std::string text = message([&] { return hill(header + "\n" + data); });
    EXPECT_TRUE(text.starts_with("file.toml:3: hill.stiffness.file: found \"k.csv\" with ")) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  const std::string missing = message([&] { return hill("k11,k22\n1,2\n1,3\n1,1\n"); });
  EXPECT_NE(missing.find("no column k21, allowed all entries, or those of one half and the diagonal"),
            std::string::npos)
      << missing;
}

TEST_F(SampleFiles, AnAngleColumnWithoutANameIsRefused) {
  for (const bool closing : {false, true}) {
    for (const double turn : {360.0, 2 * pi, 1.0}) {
      const std::string text = message([&] { return hill(rows(36, turn, true, closing, false)); });
      EXPECT_NE(
          text.find("k.csv:1: found angles in the first column, allowed columns named in a first line (angle, k11"),
          std::string::npos)
          << text;
      EXPECT_NE(message([&] { return hill("a,b,c,d\n" + rows(36, turn, true, closing, false)); }).find("found angles"),
                std::string::npos);
    }
  }
  const std::string fields = message([&] { return hill(rows(36, 0, false, false, false)); });
  EXPECT_NE(fields.find("k.csv:1: found 3 fields, allowed 4 numbers in a row (all entries row by row, no angle)"),
            std::string::npos)
      << fields;
  // A short ramp that is no turn is a stiffness like any other.
  EXPECT_EQ(message([&] { return hill("1,0,0,1\n2,0,0,1\n3,0,0,1\n4,0,0,1\n"); }), "");
  // One column is no table with an angle.
  std::ofstream(folder_ / "k.csv") << "0\n90\n180\n270\n";
  EXPECT_EQ(message([&] {
              return parse_scene("[hill]\nmass = [[1]]\nstiffness = { file = \"k.csv\" }\n", "file.toml", {}, folder_);
            }),
            "");
}

TEST_F(SampleFiles, OneUnknownTakesAngleAndValue) {
  std::ofstream(folder_ / "k.csv") << "angle,k\n0,1\n90,2\n180,3\n270,2\n";
  const Scene scene = parse_scene("units.angle = \"deg\"\n[hill]\nmass = [[1]]\nstiffness = { file = \"k.csv\" }\n",
                                  "file.toml", {}, folder_);
  EXPECT_NEAR(fourier::evaluate(stiffness(scene), pi)(0), 3, 10 * eps);
}

TEST_F(SampleFiles, LoadsHaveNamedColumnsToo) {
  std::ofstream(folder_ / "h.csv") << "h2,angle,h1\n0,0,1\n1,90,0\n0,180,-1\n-1,270,0\n";
  const Scene scene = parse_scene(
      "units.angle = \"deg\"\n[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { harmonic = 0, cos = [[1, 0], [0, 1]] }\n"
      "load = { file = \"h.csv\", scale = 2 }\n",
      "file.toml", {}, folder_);
  const Eigen::VectorXd at = fourier::evaluate(std::get<HillSystem>(scene.model).load[0], 0.4);
  EXPECT_NEAR(at(0), 2 * std::cos(0.4), 10 * eps);
  EXPECT_NEAR(at(1), 2 * std::sin(0.4), 10 * eps);
}

TEST_F(SampleFiles, AClosingRowWithoutAnglesIsLeftOutAndSaid) {
  const Scene scene = hill(rows(36, 0, false, true, true));
  expect_the_stiffness(stiffness(scene));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("k.csv:37: found a last row that repeats the first"), std::string::npos)
      << scene.warnings[0];
  EXPECT_TRUE(hill(rows(36, 0, false, false, true)).warnings.empty());
  EXPECT_TRUE(hill("1,0,0,1\n1,0,0,1\n1,0,0,1\n1,0,0,1\n").warnings.empty());
}

TEST_F(SampleFiles, AJumpAtTheSeamIsSaid) {
  std::string ramp;
  for (int j = 0; j < 20; ++j) ramp += std::to_string(100 + 7 * j) + ",0,0,1\n";
  const Scene scene = hill(ramp);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("found a jump at the seam, 133 from the last row back to the first in column 1"),
            std::string::npos)
      << scene.warnings[0];
}

TEST_F(SampleFiles, UnevenAnglesAreInterpolatedBySplines) {
  std::ostringstream csv;
  csv << "angle,k11,k12,k22\n" << std::setprecision(17);
  for (int j = 0; j < 200; ++j) {
    const double t = 2 * pi * (j + 0.3 * std::sin(j)) / 200;
    csv << t << ',' << k11(t) << ',' << k12(t) << ',' << k22(t) << '\n';
  }
  const FourierSeries found = stiffness(hill(csv.str()));
  for (const double t : {0.2, 3.0}) {
    const Eigen::VectorXd at = fourier::evaluate(found, t);
    EXPECT_NEAR(at(0), k11(t), 1e-6);
    EXPECT_NEAR(at(2), k12(t), 1e-5);
    EXPECT_NEAR(at(3), k22(t), 1e-6);
  }
}

TEST_F(SampleFiles, TablesThatAreNoTurnAreRefused) {
  const auto table = [](double to, int steps) {
    std::ostringstream csv;
    for (int j = 0; j <= steps; ++j) csv << to * j / steps << ',' << std::cos(to * j / steps * pi / 180) << '\n';
    return csv.str();
  };
  const std::string file = "force = { file = \"f.csv\" }";
  const std::string half = message([&] { return slider(table(180, 36), file); });
  EXPECT_NE(half.find("f.csv:37: found half a turn or more without a row behind this one"), std::string::npos) << half;
  EXPECT_NE(message([&] { return slider(table(230, 46), file); }).find("more than a third of a turn"),
            std::string::npos);
  for (const double to : {720.0, 710.0}) {
    const std::string two = message([&] { return slider(table(to, static_cast<int>(to) / 10), file); });
    EXPECT_NE(two.find("two turns"), std::string::npos) << two;
    EXPECT_NE(two.find("four-stroke"), std::string::npos) << two;
    EXPECT_NE(two.find("the mean of both turns"), std::string::npos) << two;  // what to do
    EXPECT_NE(two.find("allowed one turn of 360"), std::string::npos) << two;
  }
  EXPECT_EQ(message([&] { return slider(table(360, 72), file); }), "");
  EXPECT_NE(message([&] {
              return hill("angle,k11,k12,k22\n" + rows(36, 180, true, true, false), "", "units.angle = \"deg\"\n");
            }).find("half a turn"),
            std::string::npos);
}

TEST_F(SampleFiles, NoNameOfAFileIsRefused) {
  // `file = ""` dropped the force without a word.
  const std::string force = message([&] { return slider("", "force = { file = \"\" }"); });
  EXPECT_TRUE(force.starts_with("file.toml:8: piston.force.file: found \"\", allowed the name of a file")) << force;
  const auto hill_message = [](const std::string& terms) {
    return message([&] { return parse_scene("[hill]\nmass = [[1]]\n" + terms, "file.toml"); });
  };
  EXPECT_NE(hill_message("stiffness = { file = \"\" }\n").find("hill.stiffness.file: found \"\""), std::string::npos);
  EXPECT_NE(hill_message("stiffness = { harmonic = 0, cos = [[1]] }\nload = { file = \"\" }\n")
                .find("hill.load.file: found \"\""),
            std::string::npos);
}

TEST_F(SampleFiles, ForcesTakeColumnUnitAndScale) {
  const std::string csv = "angle,other,gas\n0,9,1\n90,9,0\n180,9,-1\n270,9,0\n";
  const auto at_zero = [&](const std::string& keys, const std::vector<Override>& overrides = {}) {
    return fourier::evaluate(force(slider(csv, "force = { file = \"f.csv\", " + keys + " }", overrides)), 0)(0);
  };
  EXPECT_NEAR(at_zero("column = \"gas\""), 1, 10 * eps);
  EXPECT_NEAR(at_zero("column = 3"), 1, 10 * eps);
  EXPECT_NEAR(at_zero("column = \"gas\", unit = \"kN\", scale = -1"), -1000, 1e-12);
  EXPECT_NEAR(at_zero("column = \"gas\", unit = \"lbf\""), 4.4482216152605, 1e-14);
  // Numbers of files are reachable by path.
  EXPECT_NEAR(at_zero("column = \"gas\", scale = 1", {{"piston.force.scale", "2.5"}}), 2.5, 10 * eps);
  EXPECT_NEAR(at_zero("column = \"gas\"", {{"piston.force.scale", "2.5"}}), 2.5, 10 * eps);
  const auto refused = [&](const std::string& table, const std::string& keys) {
    return message([&] { return slider(table, "force = { file = \"f.csv\"" + keys + " }"); });
  };
  for (const auto& [table, keys, part] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {csv, "", "f.csv:2: found 3 fields, allowed 2 numbers in a row (crank angle and force; column"},
           {csv, ", column = \"gass\"", "no column \"gass\", allowed one of the columns angle, other, gas"},
           {csv, ", column = 4", "no column \"4\""},
           {csv, ", column = \"angle\"", "the angles as column"},
           {csv, ", column = []", "piston.force.column: found a list of 0"},
           {csv, ", column = 3, unit = \"bar\"",
            "piston.force.unit: found \"bar\", a pressure, allowed a unit of a force"},
           {csv, ", column = 3, unit = \"Newton\"", "the unknown unit Newton"},
           {csv, ", column = 3, scale = \"2 N\"", "piston.force.scale: found \"2 N\", a force"},
       }) {
    const std::string text = refused(table, keys);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

// A column of pressures in bar was taken for a force in newton.
TEST_F(SampleFiles, TheHeadersUnitCounts) {
  const auto table = [](const std::string& header) { return header + "\n0,1\n90,0\n180,-1\n270,0\n"; };
  const auto at_zero = [&](const std::string& header, const std::string& keys = "") {
    return fourier::evaluate(force(slider(table(header), "force = { file = \"f.csv\"" + keys + " }")), 0)(0);
  };
  EXPECT_NEAR(at_zero("crank angle [deg],force [kN]"), 1000, 1e-12);
  EXPECT_NEAR(at_zero("crank angle / deg, force / N"), 1, 10 * eps);
  EXPECT_NEAR(at_zero("crank angle,force (whatever it is)"), 1, 10 * eps);
  EXPECT_NEAR(at_zero("crank angle,force [kN]", ", unit = \"N\""), 1, 10 * eps);
  const std::string text =
      message([&] { return slider(table("crank angle [deg],pressure [bar]"), "force = { file = \"f.csv\" }"); });
  EXPECT_NE(text.find("the column \"pressure\" in bar, a pressure, allowed a force (pressure = { file, bore }"),
            std::string::npos)
      << text;
}

TEST_F(SampleFiles, PressurePushesTheSliderTowardTheCrank) {
  const std::string csv = "angle,p\n0,3\n90,2\n180,1\n270,2\n";
  const double area = pi / 4 * 0.04 * 0.04;
  const auto at = [&](const std::string& keys, const std::string& branch, double angle) {
    return fourier::evaluate(
        force(slider(csv, "pressure = { file = \"f.csv\", unit = \"bar\", bore = \"40 mm\"" + keys + " }", {}, branch)),
        angle)(0);
  };
  EXPECT_NEAR(at("", "1", 0), -3e5 * area, 1e-10);
  EXPECT_NEAR(at("", "-1", 0), 3e5 * area, 1e-10);
  EXPECT_NEAR(at(", scale = 2", "1", pi), -2e5 * area, 1e-10);
  EXPECT_NEAR(at(", mean = \"5 bar\"", "1", 0), -6e5 * area, 1e-10);
  EXPECT_NEAR(at(", mean = 0", "1", pi), 1e5 * area, 1e-10);
  // Beside a force both act.
  const Scene both = slider(csv, "force = 7, pressure = { file = \"f.csv\", unit = \"bar\", bore = 0.04 }");
  EXPECT_NEAR(fourier::evaluate(force(both), 0)(0), 7 - 3e5 * area, 1e-10);
  for (const auto& [keys, part] : std::vector<std::pair<std::string, std::string>>{
           {"pressure = { file = \"f.csv\", unit = \"bar\" }", "piston.pressure.bore: found nothing"},
           {"pressure = { file = \"f.csv\", bore = -1 }", "piston.pressure.bore: found -1"},
           {"pressure = { file = \"f.csv\", bore = 1, unit = \"N\" }",
            "found \"N\", a force, allowed a unit of a pressure"},
           {"pressure = { bore = 1 }", "piston.pressure.file: found nothing"},
           {"pressure = 3", "piston.pressure: found 3, allowed a table"},
       }) {
    const std::string text = message([&] { return slider(csv, keys); });
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}
