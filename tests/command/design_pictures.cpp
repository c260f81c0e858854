// Pictures for a design report: measured values, verdicts as a strip, bent links, bands, names of axes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class DesignPictures : public CommandTest {
 protected:
  std::string sweep(const std::string& flags) const {
    return "sweep " + scene("slider_crank_units") + " --rpm 1000:3000:500 --modes 2 --format svg --out out " + flags;
  }
  void measured(const std::string& text) const { std::ofstream(folder_ / "m.csv") << text; }
  // Rows of a CSV file that hb wrote, without comments and names.
  std::vector<std::vector<double>> rows(const std::string& file) const {
    std::istringstream text(read(folder_ / file));
    std::vector<std::vector<double>> found;
    bool names = true;
    for (std::string line; std::getline(text, line);) {
      if (line.starts_with("#")) continue;
      if (names) {
        names = false;
        continue;
      }
      std::istringstream fields(line);
      found.emplace_back();
      for (std::string field; std::getline(fields, field, ',');)
        found.back().push_back(std::strtod(field.c_str(), nullptr));
    }
    return found;
  }
};

TEST_F(DesignPictures, ShowMeasuredValuesInTheirUnits) {
  measured("speed [Hz],deflection rod [um],torque [kN m],frequency rod [rpm]\n25,30,0.05,60000\n50,90,0.07,61000\n");
  const CommandResult result = hb(sweep("--measured m.csv"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto values = rows("out/measured.csv");
  ASSERT_EQ(values.size(), 2u);
  EXPECT_DOUBLE_EQ(values[0][0], 1500);  // rpm
  const Json units = Json::parse(read(folder_ / "out/sweep.json"))["units"];
  EXPECT_NEAR(values[0][1], units["length"] == "mm" ? 0.03 : 3e-5, 1e-12);
  EXPECT_NEAR(values[0][2], 50, 1e-9);
  EXPECT_NEAR(values[0][3], 1000, 1e-9);
  const std::string script = read(folder_ / "out/sweep.gp");
  for (const char* column : {"'measured.csv' using 1:2", "'measured.csv' using 1:3", "'measured.csv' using 1:4"})
    EXPECT_NE(script.find(column), std::string::npos) << column;
  EXPECT_NE(read(folder_ / "out/sweep_deflection_rod.svg").find("circles: measured"), std::string::npos);

  measured("crank angle,torque [N m],q_1 rod\n0,1,0\n90,2,0\n");
  const CommandResult steady =
      hb("steady " + scene("slider_crank_units") + " --rpm 1500 --modes 2 --format svg --measured m.csv --out turn");
  ASSERT_EQ(steady.status, 0) << steady.err;
  EXPECT_NE(read(folder_ / "turn/torque.svg").find("measured"), std::string::npos);
  EXPECT_NE(read(folder_ / "turn/response_rod.svg").find("circles: measured"), std::string::npos);
}

TEST_F(DesignPictures, MeasuredValuesThatCannotBeShownAreRefused) {
  const auto refusal = [&](const std::string& text) {
    measured(text);
    const CommandResult result = hb(sweep("--measured m.csv"));
    EXPECT_EQ(result.status, 2) << text;
    EXPECT_TRUE(result.out.empty());
    return result.err;
  };
  EXPECT_NE(refusal("speed,deflection CD\n1,2\n").find("found the column \"deflection CD\", allowed: deflection rod"),
            std::string::npos);
  EXPECT_NE(refusal("speed,deflection rod [N]\n1,2\n").find("found the unit N of deflection rod"), std::string::npos);
  EXPECT_NE(refusal("1,2\n3,4\n").find("found no header line"), std::string::npos);
  EXPECT_NE(refusal("speed,torque\n1,x\n").find("m.csv:2"), std::string::npos);
}

// The motion's own values, shifted by what is then found; the linear theory's are elsewhere (10 % in deflection there).
TEST_F(DesignPictures, MeasuredValuesAreComparedWithTheMotionWithoutLinearisation) {
  const std::string about = scene("six_link") + " --modes 1 --theory nonlinear";
  const std::string range = " --rpm 1500:1540:20 --only steady,stability,shape --no-search";
  const Json branch = Json::parse(hb("sweep " + about + range + " --no-plots --json").out)["branches"][0];
  const Json& AB = branch["rods"]["AB"];
  std::ostringstream text;
  text << std::setprecision(17) << "speed [rpm],deflection AB,q_1 AB,growth rate AB\n";
  for (std::size_t k = 0; k < branch["x"].size(); ++k)
    if (branch["asked"][k] && branch["verdict"][k] == "stable" && branch["x"][k] == 1520)
      text << 1520 << ',' << AB["deflection"][k].get<double>() + 0.5 << ',' << AB["max_abs"][k][0] << ",0\n";
  measured(text.str());
  const CommandResult result = hb("sweep " + about + range + " --measured m.csv --format svg --out along");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("by the linear theory: growth rate AB"), std::string::npos) << result.out;
  const Json list = Json::parse(read(folder_ / "along/sweep.json"))["measured"]["deviations"];
  EXPECT_EQ(list[0]["theory"], "nonlinear");
  EXPECT_EQ(list[2]["theory"], "linear");
  EXPECT_NEAR(list[0]["largest"], 0.5, 1e-5);
  EXPECT_NEAR(list[1]["largest"], 0, 1e-5);
  EXPECT_NE(read(folder_ / "along/branches_AB.svg").find("measured"), std::string::npos);

  const std::string one = "steady " + scene("slider_crank_units") + " --rpm 2000 --modes 1 --theory nonlinear";
  measured("crank angle [deg],torque\n0,0\n90,0\n");
  const Json found = Json::parse(hb(one + " --measured m.csv --json").out);
  EXPECT_EQ(found["measured"]["deviations"][0]["values"], 2);
  EXPECT_EQ(found["measured"]["deviations"][0]["theory"], "nonlinear");
}

// All of a map that is stable everywhere was nearly one blue: half of the colours were for what does not occur.
TEST_F(DesignPictures, AMapOfOneVerdictHasAllColoursOverWhatItHas) {
  const std::string about =
      "map " + scene("slider_crank_units") + " --modes 1 --y rod.section.height=15mm:25mm:3 --format svg --x rpm=";
  ASSERT_EQ(hb(about + "500:1500:3 --out stable").status, 0);
  const Json found = Json::parse(read(folder_ / "stable/map.json"));
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Json& row : found["growth_rate"])
    for (const double rate : row) low = std::min(low, rate), high = std::max(high, rate);
  ASSERT_LT(high, 0);
  const std::string script = read(folder_ / "stable/map.gp");
  std::istringstream range(script.substr(script.find("set cbrange [") + 13));
  double from = 0, to = 0;
  char colon = 0;
  range >> from >> colon >> to;
  EXPECT_NEAR(from, low, 0.02 * std::abs(low)) << script;
  EXPECT_NEAR(to, high, 0.02 * std::abs(high)) << script;
  EXPECT_EQ(script.find("#b2182b"), std::string::npos);
  ASSERT_EQ(hb(about + "500:1500:3 --colour tenfold --out tenfold").status, 0);
  EXPECT_NE(read(folder_ / "tenfold/map.gp").find("time to fall tenfold"), std::string::npos);
}

TEST_F(DesignPictures, BandsOfAMotionAreTheMotionsAtTheirEnds) {
  const std::string about = scene("slider_crank_units") + " --rpm 2000 --modes 1 --theory nonlinear";
  const CommandResult result = hb("steady " + about + " --band E=0.5:1.5");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("E of the elastic links times 0.5 to 1.5"), std::string::npos) << result.out;
  const Json found = Json::parse(hb("steady " + about + " --band E=0.5:1.5 --json").out);
  const Json soft = Json::parse(hb("steady " + about + " --set rod.E=105GPa --json").out);
  const Json quantities = found["bands"][0]["quantities"];
  const auto row = std::ranges::find_if(quantities, [](const Json& q) { return q["name"] == "deflection"; });
  ASSERT_NE(row, quantities.end());
  const double metre_in_mm = 1000;
  EXPECT_NEAR((*row)["from"].get<double>(), metre_in_mm * soft["rods"]["rod"]["deflection"]["max_abs"].get<double>(),
              1e-6 * (*row)["from"].get<double>());
  EXPECT_TRUE((*row)["slope"].is_null());
  EXPECT_TRUE((*row)["error_from"].is_number());
  EXPECT_EQ(found["bands"][0]["verdict_to"], "stable");
  const CommandResult sweep =
      hb("sweep " + scene("slider_crank_units") + " --rpm 1000:2000:500 --theory nonlinear --band E=0.5:1.5");
  EXPECT_EQ(sweep.status, 2);
  EXPECT_NE(sweep.err.find("--set"), std::string::npos) << sweep.err;
}

// Values that hb itself computed, some of them shifted by what is then found.
TEST_F(DesignPictures, DeviationsOfMeasuredValuesAreThoseThatWereAdded) {
  const Json computed = Json::parse(hb(sweep("--no-search --no-plots --json")).out);
  const Json& rod = computed["rods"]["rod"];
  std::ostringstream text;
  text << std::setprecision(17) << "speed [rpm],deflection rod,growth rate rod,frequency rod\n";
  const double shifts[] = {0, 1e-3, -3e-3};
  for (std::size_t k = 0; k < 3; ++k)  // 1000, 1500, 2000 rpm
    text << computed["rpm"][k] << ',' << rod["deflection"][k].get<double>() + shifts[k] << ','
         << rod["growth_rate"][k].get<double>() << ',' << 0 << '\n';
  text << "90000,1,1,1\n";  // beyond the range
  measured(text.str());
  const CommandResult result =
      hb("sweep " + scene("slider_crank_units") + " --rpm 1000:3000:500 --modes 2 --no-search --measured m.csv --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json list = Json::parse(result.out)["measured"]["deviations"];
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0]["values"], 3);
  EXPECT_EQ(list[0]["left_out"], 1);
  EXPECT_NEAR(list[0]["rms"], std::sqrt(1e-5 / 3), 1e-9);
  EXPECT_NEAR(list[0]["mean"], -2e-3 / 3, 1e-9);
  EXPECT_NEAR(list[0]["largest"], -3e-3, 1e-9);
  EXPECT_EQ(list[0]["at"], 2000);
  EXPECT_NEAR(list[1]["rms"], 0, 1e-6);
  // The nearest mode, the first, in Hz.
  const CommandResult one =
      hb("steady " + scene("slider_crank_units") + " --rpm 2000 --modes 2 --only stability --json");
  EXPECT_NEAR(list[2]["largest"].get<double>(), -Json::parse(one.out)["rods"]["rod"]["frequencies_hz"][0].get<double>(),
              0.05 * std::abs(list[2]["largest"].get<double>()));
  EXPECT_NE(hb("sweep " + scene("slider_crank_units") + " --rpm 1000:3000:500 --modes 2 --no-search --measured m.csv")
                .out.find("Measured less computed, m.csv"),
            std::string::npos);

  measured("crank angle [deg],torque\n0,0\n90,0\n200,0\n");
  const CommandResult turn =
      hb("steady " + scene("slider_crank_units") + " --rpm 1500 --modes 2 --measured m.csv --json");
  ASSERT_EQ(turn.status, 0) << turn.err;
  const Json found = Json::parse(turn.out);
  const Json& torque = found["measured"]["deviations"][0];
  EXPECT_EQ(torque["unit"], "N m");
  EXPECT_LE(torque["largest"].get<double>(), -found["torque"]["min"].get<double>() *
                                                 found["units"]["torque_in_newton_metre"].get<double>() * (1 + 1e-9));
  EXPECT_GT(torque["rms"], 0);
}

// What is unstable is as long as the band was located, not as the points are apart.
TEST_F(DesignPictures, VerdictsAlongASweepEndWhereTheBandsEnd) {
  const CommandResult result = hb("sweep " + scene("mathieu") + " --omega 1.9:2.5:0.1 --out out --format svg");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json bands = Json::parse(read(folder_ / "out/sweep.json"))["unstable_bands"]["system"];
  ASSERT_EQ(bands.size(), 1u);
  double from = HUGE_VAL, to = -HUGE_VAL, stable_below = -HUGE_VAL, stable_above = HUGE_VAL;
  for (const auto& row : rows("out/sweep_verdict.csv")) {
    if (row[3] == 1) from = std::min(from, row[1]), to = std::max(to, row[2]);
    if (row[3] == -1 && row[1] < 2) stable_below = std::max(stable_below, row[2]);
    if (row[3] == -1 && row[2] > 2.4) stable_above = std::min(stable_above, row[1]);
  }
  EXPECT_DOUBLE_EQ(from, bands[0][0].get<double>());
  EXPECT_DOUBLE_EQ(to, bands[0][1].get<double>());
  EXPECT_LE(stable_below, from);
  EXPECT_GE(stable_above, to);
  EXPECT_GT(fs::file_size(folder_ / "out/sweep_verdict.svg"), 3000u);
}

TEST_F(DesignPictures, TheBentMechanismIsDrawnByAFactorThatItStates) {
  const CommandResult result =
      hb("steady " + scene("slider_crank_units") + " --rpm 2000 --modes 2 --format svg --out out --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json peak = Json::parse(result.out)["rods"]["rod"]["deflection"];
  const std::string svg = read(folder_ / "out/bent_mechanism.svg"), csv = read(folder_ / "out/bent_mechanism.csv");
  const std::size_t at = svg.find("deflections drawn ");
  ASSERT_NE(at, std::string::npos);
  const double factor = std::strtod(svg.c_str() + at + std::string("deflections drawn ").size(), nullptr);
  EXPECT_GT(factor, 1);
  // The drawn line is off its chord by factor times the deflection there: no more than factor times the largest.
  double most = 0;
  std::vector<double> chord;
  for (const auto& row : rows("out/bent_mechanism.csv")) {
    ASSERT_EQ(row.size(), 6u);
    if (row[1] == 1) chord = row;
    if (row[1] != 2) continue;
    ASSERT_EQ(chord.size(), 6u);
    const double dx = chord[4] - chord[2], dy = chord[5] - chord[3], l = std::hypot(dx, dy);
    most = std::max(most, std::abs((row[4] - chord[2]) * dy - (row[5] - chord[3]) * dx) / l);
  }
  EXPECT_LE(most, factor * peak["max_abs"].get<double>() * (1 + 1e-9));
  EXPECT_GE(most, 0.3 * factor * peak["max_abs"].get<double>());
}

TEST_F(DesignPictures, AxesHaveTheNamesGiven) {
  ASSERT_EQ(hb(sweep("--no-search --label x='crank [rev/min]'")).status, 0);
  const std::string peaks = read(folder_ / "out/peaks_rod.svg");
  EXPECT_NE(peaks.find("crank [rev/min]"), std::string::npos);
  EXPECT_EQ(peaks.find("crank speed [rpm]"), std::string::npos);
  ASSERT_EQ(hb("map " + scene("mathieu") +
               " --x omega=1:3:8 --y hill.stiffness.1.cos.0.0=0.1:1:6 --label x=Omega --label y='depth q' --format svg "
               "--out map")
                .status,
            0);
  const std::string map = read(folder_ / "map/map.svg");
  EXPECT_NE(map.find(">Omega<"), std::string::npos);
  EXPECT_NE(map.find(">depth q<"), std::string::npos);
  // Any axis of any command by the name that stands there, subscripts and colour bars included.
  const std::string turn = "steady " + scene("slider_crank_units") + " --rpm 1500 --modes 2 --format svg --out turn ";
  const CommandResult other = hb(turn + "--label 'crank angle [deg]=Kurbelwinkel' --label 'no such axis=A'");
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_NE(read(folder_ / "turn/torque.svg").find("Kurbelwinkel"), std::string::npos);
  EXPECT_EQ(read(folder_ / "turn/torque.svg").find("crank angle [deg]"), std::string::npos);
  EXPECT_NE(other.err.find("--label: no axis is named \"no such axis\", there are: "), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("driving torque on the crank [N m]"), std::string::npos) << other.err;
  EXPECT_NE(hb(turn + "--label x=angle").err.find("an axis by the name that stands there"), std::string::npos);
  ASSERT_EQ(hb(sweep("--no-search --label 'growth rate of the mode [1/s]=growth'")).status, 0);
  EXPECT_NE(read(folder_ / "out/campbell_rod.svg").find(">growth<"), std::string::npos);
  const CommandResult wrong = hb(sweep("--label y=deflection"));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("--label: found \"y=deflection\", allowed: x=TEXT"), std::string::npos) << wrong.err;
}

TEST_F(DesignPictures, BandsAreComputedAtBothEnds) {
  ASSERT_EQ(hb(sweep("--no-search --band damping=0.5:2 --json")).status, 0);
  const Json found = Json::parse(read(folder_ / "out/sweep.json"));
  ASSERT_EQ(found["bands"].size(), 1u);
  const Json& band = found["bands"][0];
  // More damping: disturbances die out faster, at every speed.
  for (std::size_t k = 0; k < found["rpm"].size(); ++k) {
    EXPECT_GT(band["at_from"]["rods"]["rod"]["growth_rate"][k], found["rods"]["rod"]["growth_rate"][k]);
    EXPECT_LT(band["at_to"]["rods"]["rod"]["growth_rate"][k], found["rods"]["rod"]["growth_rate"][k]);
  }
  EXPECT_GT(fs::file_size(folder_ / "out/sweep_band_damping_rod.svg"), 3000u);
  // Along another number: at each of its values what the factor makes of it.
  const std::string fixed = scene("slider_crank_units") + " --rpm 1500 --modes 2 --json ";
  const Json along = Json::parse(
      hb("sweep " + fixed + "--no-search --x crank.length=20mm:40mm:x3 --band mass=0.9:1.1").out)["bands"][0];
  const Json as_given = Json::parse(hb("steady " + fixed + "--set crank.length=30mm --band mass=0.9:1.1").out);
  for (const Json& quantity : as_given["bands"][0]["quantities"])
    if (quantity["of"] == "rod" && quantity["name"] == "growth rate") {
      EXPECT_NEAR(along["at_from"]["rods"]["rod"]["growth_rate"][1], quantity["from"], 1e-5);
      EXPECT_NEAR(along["at_to"]["rods"]["rod"]["growth_rate"][1], quantity["to"], 1e-5);
    }
  EXPECT_NE(along["at_from"]["rods"]["rod"]["deflection"][1], along["at_to"]["rods"]["rod"]["deflection"][1]);
  const CommandResult text =
      hb("sweep " + scene("slider_crank_units") + " --rpm 1000:3000:500 --modes 2 --no-search --band E=0.9:1.1");
  EXPECT_NE(text.out.find("E of the elastic links times 0.9 to 1.1"), std::string::npos) << text.out;
  // At one speed: a picture of q_1, and the slope of the stress.
  const CommandResult one = hb("steady " + scene("slider_crank_units") +
                               " --rpm 2000 --modes 2 --band mass=0.9:1.1 --format svg --out one --json");
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_GT(fs::file_size(folder_ / "one/band_mass_rod.svg"), 3000u);
  bool stress = false;
  const Json document = Json::parse(one.out);
  for (const Json& quantity : document["bands"][0]["quantities"])
    if (quantity["name"] == "stress, together") {
      stress = true;
      // The power law between both ends.
      const double slope =
          std::log(quantity["to"].get<double>() / quantity["from"].get<double>()) / std::log(1.1 / 0.9);
      EXPECT_NEAR(quantity["slope"].get<double>(), slope, 0.05 * std::abs(slope));
    }
  EXPECT_TRUE(stress);
}

}  // namespace
