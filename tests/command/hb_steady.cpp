// `hb steady` as its users meet it: the built command, its documents, table and exit codes.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class Steady : public CommandTest {
 protected:
  Json document(const std::string& arguments, int expected_status = 0) const {
    const CommandResult result = hb(arguments + " --json");
    EXPECT_EQ(result.status, expected_status) << result.err;
    return Json::parse(result.out);
  }
};

// Largest |sum c_n e^{i n tau}| on the 8192 crank angles of the reference, by direct summation.
double largest(const Json& coefficients) {
  constexpr int samples = 8192;
  double result = 0;
  for (int j = 0; j < samples; ++j) {
    const double tau = 2 * std::numbers::pi * j / samples;
    double value = coefficients[0][0];
    for (std::size_t n = 1; n < coefficients.size(); ++n) {
      const std::complex<double> c(coefficients[n][0], coefficients[n][1]);
      value += 2 * (c * std::polar(1.0, static_cast<double>(n) * tau)).real();
    }
    result = std::max(result, std::abs(value));
  }
  return result;
}

double reference_tolerance(double value) { return 1e-9 * std::abs(value); }

TEST_F(Steady, RefusesTheNonlinearTheoryOfARodWithShear) {
  EXPECT_EQ(hb("steady " + scene("thick_rod") + " --json").status, 0);
  const CommandResult result = hb("steady " + scene("thick_rod") + " --theory nonlinear --json");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("--theory: found \"nonlinear\" with shear of rod"), std::string::npos) << result.err;
}

// A crank and rocker, metres, whose rod sags under its own weight: by a slope beyond 1, and so far that the loop opens.
TEST_F(Steady, SaysWhereTheLinearAnswerFoldsARodOrOpensTheMechanism) {
  const auto sagging = [&](const std::string& file, const std::string& modulus, const std::string& pivot) {
    std::ofstream(folder_ / file) << R"(
gravity = 9.81
[crank]
pivot = [0, 0]
length = 0.1
[[dyad]]
on = "crank"
branch = -1
rocker = { name = "rocker", length = 0.2, mass = 0.5, com = [0.1, 0], inertia_pivot = 0.01, pivot = [)"
                                  << pivot << R"(, 0] }
coupler = { name = "rod", length = 0.3, mass = 0.1, elastic = { area = 20e-6, J = 30e-12, damping_internal = 1e-4, E = )"
                                  << modulus << " } }\n";
    return document("steady " + file + " --rpm 30 --modes 1 --only steady");
  };
  for (const auto& [found, words] :
       {std::pair{sagging("folded.toml", "1e8", "0.38"), "rod is bent to a slope of 3.7"},
        std::pair{sagging("open.toml", "2e9", "0.395"), "rod and rocker does not close with its links bent"}}) {
    EXPECT_TRUE(found["rods"]["rod"]["theory_error"].is_null());
    const std::string said = found["warnings"].dump();
    EXPECT_NE(said.find("rod: beyond the linear theory"), std::string::npos) << said;
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_NE(said.find("at crank angle"), std::string::npos) << said;
  }
}

TEST_F(Steady, VerdictAloneIsProvedWithoutExponentsAndItsIntervalHoldsTheGrowthRate) {
  const std::string six_link = "steady " + scene("six_link") + " --rpm 300 --rods AB --only ";
  const Json verdict = document(six_link + "verdict")["rods"]["AB"],
             full = document(six_link + "stability")["rods"]["AB"];
  EXPECT_EQ(verdict["verdict"], "stable");
  EXPECT_EQ(verdict["stability_method"], "bound");
  EXPECT_TRUE(verdict["exponents"].empty());
  const double off = verdict["growth_rate"].get<double>() - full["growth_rate"].get<double>();
  EXPECT_LE(std::abs(off), verdict["exponent_error"].get<double>());
  // At 2400 rpm nothing is proved: exponents decide.
  EXPECT_EQ(document("steady " + scene("six_link") + " --rpm 2400 --rods AB --only verdict")["rods"]["AB"]["verdict"],
            "unstable");
  EXPECT_EQ(hb("report " + scene("six_link") + " --rpm 300:400:50 --only verdict").status, 2);
}

TEST_F(Steady, GrowthRateAloneIsThatOfAllExponents) {
  for (const char* rpm : {"300", "1500", "2400"}) {
    const std::string six_link = "steady " + scene("six_link") + " --rpm " + rpm + " --only ";
    const Json growth = document(six_link + "growth"), full = document(six_link + "stability");
    EXPECT_EQ(growth["verdict"], full["verdict"]);
    for (const char* rod : {"AB", "CD"}) {
      const Json &mine = growth["rods"][rod], &all = full["rods"][rod];
      EXPECT_EQ(mine["verdict"], all["verdict"]);
      EXPECT_EQ(mine["exponents_unresolved"], 0);
      EXPECT_LE(std::abs(mine["growth_rate"].get<double>() - all["growth_rate"].get<double>()),
                mine["exponent_error"].get<double>() + all["exponent_error"].get<double>());
    }
  }
}

TEST_F(Steady, EveryStabilityMethodGivesTheSameAnswer) {
  const std::string mathieu = "steady " + scene("mathieu") + " --only stability --tol 1e-8 --stability-method ";
  const Json automatic = document(mathieu + "automatic")["rods"]["system"];
  for (const std::string method : {"hill", "slaving", "propagation", "determinant"}) {
    const Json found = document(mathieu + method)["rods"]["system"];
    EXPECT_EQ(found["verdict"], automatic["verdict"]) << method;
    EXPECT_EQ(found["stability_method"], method);
    EXPECT_NEAR(found["growth_rate"], automatic["growth_rate"], 1e-8) << method;
  }
}

TEST_F(Steady, GivesTheReferenceValuesOfTheSixLinkMechanism) {
  const Json reference = Json::parse(read(HB_SOURCE_DIR "/tests/reference/six_link.json"));
  for (const Json& expected : reference["cases"]) {
    const std::string arguments = "steady " + scene("six_link") + " --rpm " + expected["rpm"].dump() + " --modes " +
                                  expected["modes"].dump() + " --set '*.J=" + expected["J"].dump() + "'";
    SCOPED_TRACE(arguments);
    const Json found = document(arguments);
    for (const auto& [name, rod] : expected["rods"].items()) {
      const Json& mine = found["rods"][name];
      EXPECT_EQ(mine["modes"], expected["modes"]);
      for (std::size_t i = 0; i < rod["max_abs_q"].size(); ++i) {
        const double value = rod["max_abs_q"][i];
        EXPECT_NEAR(largest(mine["q"]["fourier"][i]), value, reference_tolerance(value)) << name << " q" << i + 1;
        // The true peak lies between the reference's angles: above its value by (n pi/8192)^2/2 at most, n a harmonic.
        EXPECT_GE(mine["q"]["max_abs"][i], value * (1 - 1e-9)) << name << " q" << i + 1;
        EXPECT_LE(mine["q"]["max_abs"][i], value * (1 + 5e-6)) << name << " q" << i + 1;
      }
      const double growth = rod["exponents"][0][0];
      EXPECT_NEAR(mine["growth_rate"], growth, std::max(1e-8 * std::abs(growth), 10 * double(mine["exponent_error"])));
      EXPECT_EQ(mine["verdict"], growth < 0 ? "stable" : "unstable");
    }
  }
}

TEST_F(Steady, JsonHasTheKeysOfTheContract) {
  const Json found = document("steady " + scene("six_link") + " --rpm 300");
  EXPECT_EQ(found["rpm"], 300.0);
  EXPECT_NEAR(found["omega"], 10 * std::numbers::pi, 1e-13);
  ASSERT_EQ(found["rods"].size(), 2u);
  for (const Json& rod : found["rods"]) {
    EXPECT_EQ(rod["modes"], 5);
    EXPECT_EQ(rod["q"]["max_abs"].size(), 5u);
    ASSERT_EQ(rod["q"]["fourier"].size(), 5u);
    for (const Json& mode : rod["q"]["fourier"]) EXPECT_EQ(mode.size(), rod["harmonics"].get<std::size_t>() + 1);
    EXPECT_LE(rod["error_bound"], 1e-10);
    EXPECT_GT(rod["modes_error"], 0.0);
    for (const char* peak : {"deflection", "bending_moment"}) {
      for (const char* key : {"max_abs", "x", "crank_angle", "error"})
        EXPECT_TRUE(rod[peak][key].is_number()) << peak << key;
    }
    EXPECT_EQ(rod["exponents"][0].size(), 2u);
    EXPECT_EQ(rod["exponents"].size(), rod["exponent_errors"].size());
    EXPECT_TRUE(rod["growth_rate"].is_number());
    EXPECT_TRUE(rod["exponent_error"].is_number());
    EXPECT_EQ(rod["verdict"], "stable");
  }
  for (const char* joint : {"AB.0", "AB.1", "CD.0", "CD.1", "crank.pivot", "O2BC.pivot", "O3D.pivot"}) {
    for (const char* component : {"x", "y", "x_rigid", "y_rigid"}) {
      const Json& range = found["joints"][joint][component];
      EXPECT_LE(range["min"], range["max"]) << joint << component;
    }
  }
  EXPECT_LE(found["torque"]["min"], found["torque"]["max"]);
  EXPECT_LE(found["torque"]["rigid"]["min"], found["torque"]["rigid"]["max"]);
  for (const char* error : {"joints_error", "torque_error", "joints_modes_error", "torque_modes_error"}) {
    EXPECT_GT(found[error], 0.0) << error;
    EXPECT_LT(found[error], 1e-6) << error;
  }
  EXPECT_FALSE(found.contains("stats"));
}

TEST_F(Steady, SlidersReportTheNormalForceOfTheirGuide) {
  const Json found = document("steady " + scene("slider_crank") + " --rpm 600");
  int guides = 0;
  for (const auto& [name, joint] : found["joints"].items()) {
    if (!name.ends_with(".guide")) continue;
    ++guides;
    EXPECT_LE(joint["n"]["min"], joint["n"]["max"]);
    EXPECT_LE(joint["n_rigid"]["min"], joint["n_rigid"]["max"]);
    EXPECT_FALSE(joint.contains("x"));
  }
  EXPECT_EQ(guides, 1);
}

TEST_F(Steady, AHillSceneHasOneRodNamedSystemAndNoJoints) {
  const Json found = document("steady " + scene("mathieu") + " --omega 1");
  ASSERT_EQ(found["rods"].size(), 1u);
  const Json& system = found["rods"]["system"];
  EXPECT_TRUE(found["joints"].empty());
  EXPECT_FALSE(found.contains("torque"));
  EXPECT_FALSE(system.contains("deflection"));
  // x(0) and x'(0) of x'' + 0.1 x' + (1.2 + 0.4 cos t) x = cos t.
  double x = 0, v = 0;
  const Json& c = system["q"]["fourier"][0];
  for (std::size_t n = 0; n < c.size(); ++n) {
    x += (n == 0 ? 1 : 2) * c[n][0].get<double>();
    v += -2.0 * static_cast<double>(n) * c[n][1].get<double>();
  }
  EXPECT_NEAR(x, 4.65595993, 5e-9);
  EXPECT_NEAR(v, 2.71750522, 5e-9);
  // Multipliers 0.63284681 +/- 0.36468206 i.
  const std::complex<double> exponent(system["exponents"][0][0], system["exponents"][0][1]);
  const std::complex<double> multiplier = std::exp(2 * std::numbers::pi * exponent);
  EXPECT_NEAR(multiplier.real(), 0.63284681, 6e-9);
  EXPECT_NEAR(std::abs(multiplier.imag()), 0.36468206, 6e-9);
}

TEST_F(Steady, OnlyComputesWhatIsAskedFor) {
  const std::string base = "steady " + scene("six_link") + " --rpm 1500 --only ";
  const Json full = document("steady " + scene("six_link") + " --rpm 1500");
  const Json stability = document(base + "stability");
  EXPECT_FALSE(stability.contains("joints"));
  EXPECT_FALSE(stability.contains("torque"));
  EXPECT_FALSE(stability["rods"]["AB"].contains("q"));
  EXPECT_FALSE(stability["rods"]["AB"].contains("deflection"));
  EXPECT_EQ(stability["rods"]["AB"]["growth_rate"], full["rods"]["AB"]["growth_rate"]);

  const Json steady = document(base + "steady,shape");
  EXPECT_FALSE(steady["rods"]["AB"].contains("verdict"));
  EXPECT_FALSE(steady.contains("joints"));
  EXPECT_EQ(steady["rods"]["AB"]["q"], full["rods"]["AB"]["q"]);
  EXPECT_EQ(steady["rods"]["AB"]["deflection"], full["rods"]["AB"]["deflection"]);

  const Json reactions = document(base + "reactions");
  EXPECT_FALSE(reactions["rods"]["AB"].contains("q"));
  EXPECT_EQ(reactions["joints"], full["joints"]);
  EXPECT_EQ(reactions["torque"], full["torque"]);
}

TEST_F(Steady, RodsPicksRodsWithoutChangingAnyNumber) {
  const Json full = document("steady " + scene("six_link") + " --rpm 1500");
  const Json one = document("steady " + scene("six_link") + " --rpm 1500 --rods CD");
  ASSERT_EQ(one["rods"].size(), 1u);
  EXPECT_EQ(one["rods"]["CD"], full["rods"]["CD"]);
  EXPECT_EQ(one["joints"], full["joints"]);
  const CommandResult unknown = hb("steady " + scene("six_link") + " --rpm 1500 --rods EF");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("\"EF\""), std::string::npos) << unknown.err;
  EXPECT_NE(unknown.err.find("AB, CD"), std::string::npos) << unknown.err;
}

TEST_F(Steady, FlagsWinOverTheScene) {
  const Json found = document("steady " + scene("six_link") + " --rpm 600 --modes 3 --tol 1e-6 --set AB.J=60");
  EXPECT_EQ(found["rpm"], 600.0);
  EXPECT_EQ(found["rods"]["AB"]["modes"], 3);
  EXPECT_EQ(found["tolerance"], 1e-6);
  const Json plain = document("steady " + scene("six_link") + " --rpm 600 --modes 3 --tol 1e-6");
  EXPECT_LT(found["rods"]["AB"]["q"]["max_abs"][0], plain["rods"]["AB"]["q"]["max_abs"][0]);
  const double omega = plain["omega"];
  const Json by_omega = document("steady " + scene("six_link") + " --modes 3 --tol 1e-6 --omega " + Json(omega).dump());
  EXPECT_EQ(by_omega["rods"]["AB"]["growth_rate"], plain["rods"]["AB"]["growth_rate"]);
}

TEST_F(Steady, AProvedBoundIsSaidToBeProvedAndIsNearTheEstimate) {
  const auto bound = [&](const std::string& flags) {
    const Json json = document("steady " + scene("six_link") + " --rpm 300 --only steady " + flags);
    return std::pair{json["rods"]["AB"]["error_bound_proved"].get<bool>(),
                     json["rods"]["AB"]["error_bound"].get<double>()};
  };
  const auto [estimated_proved, estimated] = bound("");
  const auto [proved_proved, proved] = bound("--bound proved");
  EXPECT_FALSE(estimated_proved);
  EXPECT_TRUE(proved_proved);
  EXPECT_LE(proved, 10 * estimated);
  EXPECT_NE(hb("steady " + scene("six_link") + " --rpm 300 --bound proved").out.find(", proved"), std::string::npos);
}

TEST_F(Steady, AutoModesReachTheToleranceOnTheDeflection) {
  const Json found = document("steady " + scene("six_link") + " --rpm 1500 --modes auto --tol 1e-6");
  for (const Json& rod : found["rods"]) {
    EXPECT_LE(rod["modes_error"], 1e-6);
    EXPECT_EQ(rod["q"]["max_abs"].size(), rod["modes"].get<std::size_t>());
  }
}

TEST_F(Steady, StatsSayWhatWasSkipped) {
  const Json found = document("steady " + scene("six_link") + " --rpm 300 --only steady --stats");
  bool skipped = false;
  for (const Json& stage : found["stats"]) skipped = skipped || stage.contains("skipped");
  EXPECT_TRUE(skipped);
}

TEST_F(Steady, TheTableSaysTheVerdictInWords) {
  const CommandResult stable = hb("steady " + scene("six_link") + " --rpm 300");
  EXPECT_EQ(stable.status, 0) << stable.err;
  EXPECT_NE(stable.out.find("stable: every disturbance dies out"), std::string::npos) << stable.out;
  EXPECT_EQ(stable.out.find(" nan"), std::string::npos);
  const CommandResult unstable = hb("steady " + scene("six_link") + " --rpm 3000");
  EXPECT_EQ(unstable.status, 0) << unstable.err;
  EXPECT_NE(unstable.out.find("would not be seen in a machine"), std::string::npos) << unstable.out;
  EXPECT_NE(unstable.out.find("period doubling"), std::string::npos) << unstable.out;
}

TEST_F(Steady, AResultThatMissesItsToleranceIsMarkedAndGiven) {
  const CommandResult result = hb("steady " + scene("mathieu") +
                                  " --omega 1 --set 'hill.damping.0.0=0' "
                                  "--set 'hill.stiffness.1.cos.0.0=0' --set 'hill.stiffness.0.cos.0.0=1'");
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_NE(result.out.find("NOT REACHED"), std::string::npos) << result.out;
  const Json found = document("steady " + scene("mathieu") +
                                  " --omega 1 --set 'hill.damping.0.0=0' "
                                  "--set 'hill.stiffness.1.cos.0.0=0' --set 'hill.stiffness.0.cos.0.0=1'",
                              3);
  EXPECT_EQ(found["status"], "tolerance not reached");
  EXPECT_EQ(found["rods"]["system"]["status"], "singular");
  EXPECT_TRUE(found["rods"]["system"]["error_bound"].is_null());
}

TEST_F(Steady, ALinkageTooNearADeadCentreIsSaidToBeUnresolvedAtOnce) {
  // Coupler and rocker are 0.1 um short of standing in line at 180 deg.
  std::ofstream(folder_ / "near.toml") << R"([crank]
pivot = [0, 0]
length = 50
[[dyad]]
on = "crank"
coupler = { name = "AB", length = 150, mass = 0.1, elastic = { E = 21e7, area = 10, J = 45 } }
rocker = { name = "R", pivot = [200, 0], length = 100.0001 }
branch = -1
)";
  for (const char* options : {"", " --json", " --out out"}) {
    const CommandResult result = hb(std::string("steady near.toml --rpm 300") + options);
    EXPECT_EQ(result.status, 3) << result.err;
    if (std::string(options) == " --json") {
      const Json said = Json::parse(result.out);
      EXPECT_EQ(said["status"], "tolerance not reached");
      EXPECT_NE(said["notes"][0].dump().find("dead centre"), std::string::npos) << said;
    } else {
      EXPECT_TRUE(result.out.empty());
    }
    for (const char* part : {"near.toml", "AB, R", "0.105 deg of a dead centre", "180 deg", "16384"})
      EXPECT_NE(result.err.find(part), std::string::npos) << part << ": " << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
  EXPECT_EQ(hb("scene near.toml").status, 0);
}

// One scene could not serve steady and sweep: each refused what the other needs.
TEST_F(Steady, OfARangeInTheSceneTheFirstSpeedIsTaken) {
  std::ofstream(folder_ / "range.toml") << read(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  const Json found = document("steady range.toml --modes 1 --only steady --set 'analysis.rpm=[200, 6000, 20]'");
  EXPECT_EQ(found["rpm"], 200);
  const CommandResult flag = hb("steady range.toml --rpm 200:6000:20");
  EXPECT_EQ(flag.status, 2);
  EXPECT_NE(flag.err.find("one speed"), std::string::npos) << flag.err;
  const CommandResult bad = hb("steady range.toml --rpm 3o0");
  EXPECT_EQ(bad.err.find("FROM:TO"), std::string::npos) << bad.err;
  const CommandResult backwards = hb("steady range.toml --rpm -300");
  EXPECT_EQ(backwards.status, 2);
  EXPECT_NE(backwards.err.find("mirror the scene"), std::string::npos) << backwards.err;
}

TEST_F(Steady, ListsEveryExponentOrSaysHowManyAreMissing) {
  for (const char* rpm : {"300", "6000"}) {
    const Json found = document("steady " + scene("six_link") + " --only stability --modes 10 --tol 1e-4 --rpm " + rpm);
    for (const char* name : {"AB", "CD"}) {
      const Json& rod = found["rods"][name];
      EXPECT_EQ(rod["exponents"].size() + rod["exponents_unresolved"].get<std::size_t>(), 20u) << rpm << name;
      EXPECT_EQ(rod["exponents"].size(), rod["exponent_errors"].size());
      EXPECT_LE(rod["exponents_uncertain"].size(), rod["exponents_unresolved"].get<std::size_t>()) << rpm << name;
      for (const Json& exponent : rod["exponents_uncertain"])
        EXPECT_GT(exponent["error"], 1e-6 * found["omega"].get<double>()) << rpm << name;
    }
  }
}

TEST_F(Steady, LooseToleranceLoosensTheExponents) {
  const Json strict =
      document("steady " + scene("six_link") + " --rpm 1500 --only stability --stability-method propagation");
  const Json loose = document("steady " + scene("six_link") +
                              " --rpm 1500 --only stability --tol 1e-4 "
                              "--stability-method propagation");
  for (const char* rod : {"AB", "CD"}) {
    EXPECT_NEAR(loose["rods"][rod]["growth_rate"].get<double>(), strict["rods"][rod]["growth_rate"].get<double>(),
                loose["rods"][rod]["exponent_error"].get<double>());
    EXPECT_LE(loose["rods"][rod]["exponent_error"].get<double>(), 1e-3 * 157.08);
  }
}

// Nearly at rest the response is that of the static deflection, thousands of harmonics from the natural frequencies.
TEST_F(Steady, AnswersNearlyAtRest) {
  const CommandResult result = hb("steady " + scene("eight_link") + " --omega 0.002 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json json = Json::parse(result.out);
  ASSERT_FALSE(json["rods"].empty());
  for (const auto& [name, rod] : json["rods"].items()) {
    ASSERT_TRUE(rod["error_bound"].is_number()) << name;
    EXPECT_LE(rod["error_bound"].get<double>(), 1e-8) << name;
    EXPECT_NE(rod["verdict"], "undecided") << name;
  }
}

// Next to a dead centre the deflection needs nineteen modes, the growth rate nine; with nineteen it is known to 3e5
// only.
TEST_F(Steady, NextToADeadCentreTheGrowthRateHasItsOwnNumberOfModes) {
  const std::string at = "steady " + scene("slider_crank") + " --set crank.length=144.9 --rpm 3000 --json";
  const CommandResult result = hb(at + " --modes auto");
  EXPECT_EQ(result.status, 0) << result.err;
  const Json found = Json::parse(result.out), rod = found["rods"]["rod"];
  EXPECT_LE(rod["error_bound"], 1e-8);
  EXPECT_LE(rod["modes_error"], 1e-8);
  EXPECT_LE(rod["growth_modes_error"], 1e-8);
  EXPECT_EQ(rod["verdict"], "unstable");
  EXPECT_LE(rod["exponent_error"], 1e-8 * rod["growth_rate"].get<double>());
  EXPECT_LT(rod["growth_modes"], rod["modes"]);
  EXPECT_EQ(rod["q"]["fourier"].size(), rod["modes"].get<std::size_t>());
  EXPECT_LE(rod["exponents"].size(), 2 * rod["growth_modes"].get<std::size_t>());
  // Alone it is the same, and that of more modes within what the modes left out may change.
  const Json alone = document(at + " --modes auto --only growth")["rods"]["rod"];
  EXPECT_EQ(alone["growth_modes"], rod["growth_modes"]);
  EXPECT_NEAR(alone["growth_rate"], rod["growth_rate"].get<double>(),
              alone["exponent_error"].get<double>() + rod["exponent_error"].get<double>());
  const Json finer = document(at + " --modes 13 --only growth")["rods"]["rod"];
  const double left_out = rod["growth_modes_error"].get<double>() * rod["growth_rate"].get<double>();
  EXPECT_NEAR(finer["growth_rate"], rod["growth_rate"].get<double>(), left_out);
}

// Rounding alone is beyond the tolerance there, residuals in extended precision are not.
TEST_F(Steady, NextToADeadCentreNineteenModesReachTheTolerance) {
  const CommandResult result =
      hb("steady " + scene("slider_crank") + " --set crank.length=144.9 --rpm 3000 --modes 19 --only reactions --json");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_LE(Json::parse(result.out)["joints_error"], 1e-8);
}

// One number of modes asked for is that of the exponents too; automatic, each rod has two, in words too.
TEST_F(Steady, SaysHowManyModesTheExponentsWereComputedWith) {
  const std::string at = "steady " + scene("six_link") + " --rpm 1500";
  for (const Json& rod : document(at + " --modes 4")["rods"]) EXPECT_EQ(rod["growth_modes"], 4);
  for (const Json& rod : document(at + " --modes 4 --only steady")["rods"]) EXPECT_FALSE(rod.contains("growth_modes"));
  const std::string automatic = at + " --modes auto --tol 1e-6";
  const Json found = document(automatic), alone = document(automatic + " --only stability");
  for (const auto& [name, rod] : found["rods"].items()) {
    EXPECT_LE(rod["growth_modes"], rod["modes"]) << name;
    EXPECT_EQ(rod["exponents"].size() + rod["exponents_uncertain"].size(), 2 * rod["growth_modes"].get<std::size_t>())
        << name;
    EXPECT_EQ(alone["rods"][name]["exponents"], rod["exponents"]) << name;
    EXPECT_EQ(alone["rods"][name]["modes"], rod["growth_modes"]) << name;
  }
  const int of_growth = found["rods"]["AB"]["growth_modes"];
  ASSERT_LT(of_growth, found["rods"]["AB"]["modes"]);
  EXPECT_NE(hb(automatic).out.find("; exponents with " + std::to_string(of_growth) + " modes"), std::string::npos);
}

TEST_F(Steady, SaysBeforehandThatItWillNotFitIntoMemory) {
  const std::string limit = "ulimit -v 600000;", crank = scene("slider_crank") + " --time-limit 1";
  const std::string near = crank + " --set crank.length=144.9 --modes 30";
  EXPECT_NE(hb("steady " + near, limit).err.find("hb steady: this speed needs about 1.3 GB"), std::string::npos);
  EXPECT_NE(hb("check " + near + " --case-limit 0.1", limit).err.find("hb check: the check needs about"),
            std::string::npos);
  EXPECT_NE(hb("sweep " + near + " --rpm 300:600:x4", limit).err.find("hb sweep: the sweep needs about"),
            std::string::npos);
  const std::string long_one = scene("six_link") + " --time-limit 0.2 --no-search --only stability --rpm 300:3000:";
  EXPECT_NE(hb("sweep " + long_one + "x90000 --modes 30 --json", limit).err.find("hb sweep: the sweep needs about"),
            std::string::npos);
  EXPECT_EQ(hb("sweep " + long_one + "x90 --modes 3", limit).err.find("needs about"), std::string::npos);
  EXPECT_EQ(hb("steady " + crank, limit).err.find("needs about"), std::string::npos);
}

TEST_F(Steady, TheMemorySaidIsThatMeasured) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  const std::string run =
      "steady " + scene("slider_crank") + " --set crank.length=144.9 --modes 20 --rpm 300 --only shape";
  const std::string before = "hb steady: this speed needs about ", text = hb(run, "ulimit -v 500000;").err;
  const std::size_t at = text.find(before);
  ASSERT_NE(at, std::string::npos) << text;
  ASSERT_EQ(hb(run).status, 0);
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const double measured = 1024.0 * static_cast<double>(usage.ru_maxrss),
               said = 1e9 * std::stod(text.substr(at + before.size()));
  EXPECT_GT(measured, said / 3);
  EXPECT_LT(measured, said * 3);
}

TEST_F(Steady, SaysBeforehandWhatALongSpeedWillTake) {
  ASSERT_EQ(hb("new slider-crank crank.toml").status, 0);
  const std::string near = " crank.toml --set 'crank.length=144.999 mm' --time-limit 0.5";
  EXPECT_NE(hb("steady" + near).err.find("hb steady: this speed takes about"), std::string::npos);
  EXPECT_NE(hb("sweep" + near + " --rpm 300:600:100").err.find("hb sweep: the sweep takes about"), std::string::npos);
  EXPECT_NE(hb("steady crank.toml --stability-method determinant --time-limit 0.5").err.find("takes at most about"),
            std::string::npos);
  EXPECT_EQ(hb("steady crank.toml").err.find("takes"), std::string::npos);
}

}  // namespace
