// Errors beside what a machine's designer reads: they hold, of one speed, along a sweep and of a bent motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;

class LoadErrors : public CommandTest {
 protected:
  Json document(const std::string& arguments) const {
    const CommandResult result = hb("steady " + arguments + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
};

// Of everything that both documents have at `path`, few modes against many: no further off than the error says.
void expect_covered(const Json& few, const Json& many, const std::string& path, const std::string& error) {
  const Json::json_pointer at("/" + path), of("/" + error);
  ASSERT_TRUE(few.contains(at)) << path;
  ASSERT_TRUE(few.contains(of)) << error;
  const auto check = [&](const Json& a, const Json& b, const Json& e) {
    EXPECT_LE(std::abs(a.get<double>() - b.get<double>()), e.get<double>()) << path;
    EXPECT_GE(e.get<double>(), 0) << path;
  };
  if (!few[at].is_array()) return check(few[at], many[at], few[of]);
  for (std::size_t k = 0; k < few[at].size(); ++k) check(few[at][k], many[at][k], few[of][k]);
}

void expect_covered_loads(const Json& few, const Json& many) {
  for (const auto& [name, bearing] : few["bearings"].items()) {
    const std::string path = "bearings/" + name;
    expect_covered(few, many, path + "/max", path + "/error");
  }
  for (const char* key : {"min", "max", "mean", "rms"}) {
    expect_covered(few, many, std::string("torque/") + key, "torque/error");
    expect_covered(few, many, std::string("power/") + key, "power/error");
  }
  expect_covered(few, many, "frame/max", "frame/force_error");
  for (const char* key : {"min", "max"})
    expect_covered(few, many, std::string("frame/moment/") + key, "frame/moment_error");
  for (const char* key : {"flywheel/energy_fluctuation", "flywheel/speed_fluctuation"})
    expect_covered(few, many, key, std::string(key) + "_error");
  for (const char* key : {"axial", "bending"})
    expect_covered(few, many, std::string("rods/rod/stress/") + key, std::string("rods/rod/stress/") + key + "_error");
}

TEST_F(LoadErrors, EveryLoadHasAnErrorThatHolds) {
  const std::string about = scene("slider_crank_units") + " --rpm ";
  const auto sweep = [&](const char* more) {
    return Json::parse(hb("sweep " + about + "1000:3000:500 --no-search --json --modes " + more).out);
  };
  for (const char* few : {"1", "2", "5 --tol 1e-3"}) {
    const Json here = sweep(few), truth = sweep("20 --tol 1e-12");
    expect_covered_loads(here, truth);
    for (const char* key : {"deflection", "bending_moment", "buckling_share"})
      expect_covered(here, truth, std::string("rods/rod/") + key, std::string("rods/rod/") + key + "_error");
    EXPECT_LT(here["bearings"]["rod.0"]["error"][2].get<double>(),
              0.05 * here["bearings"]["rod.0"]["max"][2].get<double>());
    EXPECT_LT(here["rods"]["rod"]["deflection_error"][2].get<double>(),
              0.05 * here["rods"]["rod"]["deflection"][2].get<double>());
  }
  const Json one = document(about + "2000 --modes 2"), truth = document(about + "2000 --modes 20");
  expect_covered_loads(one, truth);
  for (const char* key : {"tension", "compression"})
    expect_covered(one, truth, std::string("rods/rod/axial_force/") + key, "rods/rod/axial_force/error");
  for (const char* key : {"position", "velocity", "acceleration"})
    for (const char* end : {"min", "max"})
      expect_covered(one, truth, std::string("sliders/piston/") + key + "/" + end,
                     std::string("sliders/piston/") + key + "/error");
  const Json bent = document(about + "2000 --modes 2 --theory nonlinear"),
             finer = document(about + "2000 --modes 6 --theory nonlinear");
  expect_covered_loads(bent, finer);
  EXPECT_LT(bent["rods"]["rod"]["axial_force"]["error"], bent["rods"]["rod"]["axial_force"]["compression"]);
}

// The motion of the values asked for, of a branch that has no fold.
TEST_F(LoadErrors, AlongABranchCoverTheModesLeftOut) {
  const auto rod_of = [&](const char* modes) {
    const Json branch =
        Json::parse(hb("sweep " + scene("slider_crank_units") +
                       " --rpm 1000:3000:1000 --only steady,shape --theory nonlinear --json --modes " + modes)
                        .out)["branches"][0];
    Json asked;
    for (std::size_t k = 0; k < branch["asked"].size(); ++k) {
      if (!branch["asked"][k]) continue;
      for (const auto& [key, list] : branch["rods"]["rod"].items())
        if (key != "stress" && key != "max_abs") asked[key].push_back(list[k]);
      for (const auto& [key, list] : branch["rods"]["rod"]["stress"].items()) asked["stress"][key].push_back(list[k]);
    }
    return asked;
  };
  const Json few = rod_of("1"), many = rod_of("5");
  ASSERT_EQ(few["deflection"].size(), 3u);
  for (const char* key : {"deflection", "bending_moment", "buckling_share", "stress/axial", "stress/bending"})
    expect_covered(few, many, key, std::string(key) + "_error");
  for (const char* key : {"stress/max_abs", "stress/mean", "stress/amplitude"})
    expect_covered(few, many, key, "stress/error");
  EXPECT_LT(few["stress"]["error"][0].get<double>(), few["stress"]["max_abs"][0].get<double>());
}

// At each value asked for what `hb steady` says of the motion there.
TEST_F(LoadErrors, ABranchHasTheMachineLoadsOfItsMotions) {
  const std::string about = scene("slider_crank_units") + " --modes 2 --theory nonlinear";
  const CommandResult result = hb("sweep " + about + " --rpm 1000:2000:500 --no-search --no-plots --out along");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json branch = Json::parse(read(folder_ / "along/sweep.json"))["branches"][0];
  const Json one = document(about + " --rpm 1500");
  int found = 0;
  for (std::size_t k = 0; k < branch["x"].size(); ++k) {
    EXPECT_EQ(branch["frame"]["max"][k].is_number(), branch["asked"][k].get<bool>());
    if (!branch["asked"][k] || branch["x"][k] != 1500) continue;
    ++found;
    const auto near = [&](const Json& along, const Json& at) {
      EXPECT_NEAR(along[k].get<double>(), at.get<double>(), 1e-6 * std::abs(at.get<double>())) << at;
    };
    for (const auto& [name, bearing] : one["bearings"].items()) near(branch["bearings"][name]["max"], bearing["max"]);
    near(branch["frame"]["max"], one["frame"]["max"]);
    near(branch["frame"]["moment"]["max"], one["frame"]["moment"]["max"]);
    near(branch["torque"]["rms"], one["torque"]["rms"]);
    near(branch["power"]["max"], one["power"]["max"]);
    near(branch["flywheel"]["energy_fluctuation"], one["flywheel"]["energy_fluctuation"]);
    EXPECT_LT(branch["bearings"]["rod.0"]["error"][k].get<double>(),
              0.05 * branch["bearings"]["rod.0"]["max"][k].get<double>());
  }
  EXPECT_EQ(found, 1);
  const std::string csv = read(folder_ / "along/branches_machine.csv");
  EXPECT_NE(csv.find("\n1500,1,-1,"), std::string::npos) << csv;
}

// Weakly bent the motion has the modes of the linear theory.
TEST_F(LoadErrors, AMotionsModesHaveFrequenciesAndDampingRatios) {
  for (const char* about : {"slider_crank_units --rpm 700 --modes 3", "six_link --rpm 150 --modes 3"}) {
    const std::string words = about, name = words.substr(0, words.find(' ')), rest = words.substr(words.find(' '));
    const Json linear = document(scene(name.c_str()) + rest),
               motion = document(scene(name.c_str()) + rest + " --theory nonlinear");
    const Json& system = motion["system"];
    ASSERT_EQ(system["damping_ratios"].size(), system["exponents"].size()) << about;
    std::vector<double> of_rods, of_motion;
    for (const auto& [rod, entry] : linear["rods"].items())
      for (const double hertz : entry["frequencies_hz"]) of_rods.push_back(hertz);
    for (const double hertz : system["frequencies_hz"]) of_motion.push_back(hertz);
    std::ranges::sort(of_rods);
    std::ranges::sort(of_motion);
    ASSERT_EQ(of_rods.size(), of_motion.size()) << about;
    for (std::size_t k = 0; k < of_rods.size(); ++k)
      EXPECT_NEAR(of_motion[k], of_rods[k], 0.002 * of_rods[k]) << about << " " << k;
    const CommandResult table = hb("steady " + scene(name.c_str()) + rest + " --theory nonlinear");
    EXPECT_NE(table.out.find("damping ratio"), std::string::npos) << table.out;
  }
}

// At 600 rpm five modes miss a resonance of the eight-link mechanism's rod PQ.
TEST_F(LoadErrors, ASweepStatesNoErrorWhereItsModesMissAResonance) {
  const auto sweep = [&](const char* modes) {
    return Json::parse(
        hb("sweep " + scene("eight_link") + " --rpm 500:600:100 --no-search --json --modes " + modes).out);
  };
  const Json few = sweep("5"), many = sweep("16");
  int missing = 0;
  for (const auto& [name, rod] : few["rods"].items())
    for (std::size_t k = 0; k < 2; ++k) {
      const Json& error = rod["deflection_error"][k];
      missing += error.is_null();
      if (error.is_null()) continue;
      EXPECT_LE(std::abs(rod["deflection"][k].get<double>() - many["rods"][name]["deflection"][k].get<double>()),
                error.get<double>())
          << name << " " << k;
    }
  EXPECT_GE(missing, 1);
}

}  // namespace
