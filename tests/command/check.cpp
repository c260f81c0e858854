// `hb check` as its users meet it, and errors injected into one path to see that it finds them.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hb/analysis/cross_check.hpp"
#include "tests/support/run_command.hpp"

namespace {

using Json = nlohmann::json;

class Check : public CommandTest {};

TEST_F(Check, SixLinkMechanismAgreesOnBothPaths) {
  const CommandResult result = hb("check " + scene("six_link") + " --rpm 1500 --modes 3 --json");
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  const Json found = Json::parse(result.out);
  for (const char* name : {"AB", "CD"}) {
    const Json& rod = found["rods"][name];
    EXPECT_EQ(rod["agrees"], true);
    EXPECT_LE(rod["q_difference"].get<double>(), 1e-9);
    EXPECT_LE(rod["exponent_difference"].get<double>(), rod["exponent_allowed"].get<double>());
  }
  EXPECT_EQ(found["joints"]["agrees"], true);
  EXPECT_EQ(found["torque"]["agrees"], true);
  EXPECT_GT(found["seconds"]["harmonic_balance"].get<double>(), 0);
  EXPECT_GT(found["seconds"]["shooting"].get<double>(), 0);
}

// Two paths that agree to ten digits on an answer that is off by a sixth said so nowhere.
TEST_F(Check, SaysWhatTheLinearTheoryIsOffBy) {
  const std::string at = "check " + scene("six_link") + " --modes 1 --tol 1e-8 --only steady --rpm ";
  const Json found = Json::parse(hb(at + "1500 --rods CD --json").out);
  EXPECT_NEAR(found["rods"]["CD"]["theory_error"].get<double>(), 0.037, 0.002);
  ASSERT_EQ(found["warnings"].size(), 1u);  // of AB, which is not asked for
  EXPECT_EQ(found["warnings"][0].get<std::string>().find("AB: beyond the linear theory"), 0u);
  const CommandResult text = hb(at + "1500");
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("WARNING: AB: beyond the linear theory: the nonlinear correction changes q by 0.17"),
            std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("linear theory            off by 0.037"), std::string::npos) << text.out;
  const Json several = Json::parse(hb(at + "300:1500:600 --json").out);
  EXPECT_EQ(several["rods"]["AB"]["theory_error"].size(), 3u);
  // One sentence for a link, not for each speed.
  ASSERT_EQ(several["warnings"].size(), 1u) << several["warnings"];
  EXPECT_EQ(several["warnings"][0].get<std::string>().find("AB: beyond the linear theory at 1 of 3 points ("), 0u)
      << several["warnings"];
  EXPECT_FALSE(Json::parse(hb(at + "300 --json").out).contains("warnings"));
  EXPECT_FALSE(
      Json::parse(hb("check " + scene("mathieu") + " --omega 1 --tol 1e-7 --json").out)["rods"]["system"].contains(
          "theory_error"));
}

TEST_F(Check, EveryIntegratorAgreesOnAHillScene) {
  for (const char* integrator : {"adams", "bdf", "collocation"}) {
    const CommandResult result =
        hb("check " + scene("mathieu") + " --omega 1 --tol 1e-7 --json --integrator " + integrator);
    ASSERT_EQ(result.status, 0) << integrator << result.out << result.err;
    EXPECT_EQ(Json::parse(result.out)["rods"]["system"]["agrees"], true);
  }
}

TEST_F(Check, MarchingFromRestAgreesToo) {
  const CommandResult result = hb("check " + scene("mathieu") + " --omega 1 --tol 1e-7 --march --json");
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  const Json rod = Json::parse(result.out)["rods"]["system"];
  EXPECT_LE(rod["marching_difference"].get<double>(), rod["marching_allowed"].get<double>());
  EXPECT_GT(rod["marching"]["turns"].get<int>(), 10);
}

TEST_F(Check, AnUnstableMotionIsNotMarchedAndThatIsNoShortfall) {
  const CommandResult result = hb("check " + scene("mathieu") + " --omega 2.15 --tol 1e-7 --march");
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("never settles"), std::string::npos) << result.out;
}

// A multiplier near 1 amplifies the rounding of the integration 1e6 times: both paths were right, the bar too small.
TEST_F(Check, AnIllConditionedPeriodIsNoDisagreement) {
  const CommandResult result = hb("check " + scene("mathieu") + " --rpm 6000 --json");
  const Json rod = Json::parse(result.out)["rods"]["system"];
  EXPECT_EQ(rod["agrees"], true) << result.out;
  EXPECT_LE(rod["q_difference"].get<double>(), 1e-9);
}

// Harmonics left out beyond H weigh more than H times as much in q'.
TEST_F(Check, LooseTolerancesAreNoDisagreement) {
  for (const char* flags : {"--rpm 1500 --tol 1e-3", "--rpm 1500 --tol 1e-5", "--rpm 3000 --tol 1e-7"}) {
    const CommandResult result = hb("check " + scene("slider_crank") + " --modes 2 " + flags);
    EXPECT_EQ(result.status, 0) << result.out;
  }
}

TEST_F(Check, OnlyWhatIsAskedForIsCompared) {
  const CommandResult result = hb("check " + scene("six_link") + " --rpm 1500 --modes 2 --only steady --json");
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_TRUE(found["rods"]["AB"]["q_difference"].is_number());
  EXPECT_TRUE(found["rods"]["AB"]["exponent_difference"].is_null());
  EXPECT_FALSE(found["rods"]["AB"].contains("deflection_difference"));
  EXPECT_FALSE(found.contains("joints"));
}

TEST_F(Check, ARangeNamesItsWorstCase) {
  const CommandResult result = hb("check " + scene("mathieu") + " --omega 1.0:1.4:0.2 --threads 2 --json");
  ASSERT_EQ(result.status, 0) << result.out << result.err;
  const Json found = Json::parse(result.out);
  EXPECT_EQ(found["omega"].size(), 3u);
  EXPECT_EQ(found["rods"]["system"]["agrees"], Json({true, true, true}));
  EXPECT_EQ(found["worst"]["rod"], "system");
  EXPECT_LE(found["worst"]["difference"].get<double>(), found["worst"]["allowed"].get<double>());
}

TEST(CheckReport, WorstCaseIsTheOneThatUsesMostOfItsAllowance) {
  using namespace hb;
  std::vector<SpeedCheck> checks(2);
  for (double speed : {1.0, 2.0}) {
    SpeedCheck& check = checks[speed > 1.5];
    check.speed = speed;
    RodCheck rod;
    rod.name = "rod";
    rod.q = {"q", 1e-3 * speed, 1};
    rod.q1 = {"q'", 0.1 / speed, 1};
    check.rods.push_back(rod);
  }
  EXPECT_EQ(worst_comparison(checks)->comparison.what, "q'");
  EXPECT_EQ(worst_comparison(checks)->speed, 1.0);
  checks[1].joints = JointCheck{{"forces", 1e-9, 2e-9}, {"torque", NAN, 1}, "A"};
  EXPECT_EQ(worst_comparison(checks)->comparison.what, "torque");
  EXPECT_FALSE(checks[1].agrees());
  EXPECT_TRUE(checks[0].agrees());
}

TEST_F(Check, TooLittleTimeIsSaidInWordsWithStatus3) {
  const CommandResult result = hb("check " + scene("six_link_4500") + " --rpm 300 --integrator bdf --case-limit 0.01");
  EXPECT_EQ(result.status, 3) << result.out << result.err;
  EXPECT_NE(result.out.find("more than the limit for a case"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("harmonic balance"), std::string::npos);
  const CommandResult json =
      hb("check " + scene("six_link_4500") + " --rpm 300 --integrator bdf --case-limit 0.01 --json");
  EXPECT_EQ(json.status, 3);
  const Json document = Json::parse(json.out);
  EXPECT_EQ(document["status"], "tolerance not reached");
  EXPECT_NE(document["notes"].dump().find("more than the limit for a case"), std::string::npos) << document["notes"];
}

TEST_F(Check, WrongFlagsEndWithStatus2) {
  EXPECT_EQ(hb("check " + scene("six_link") + " --rpm 300 --integrator euler").status, 2);
  EXPECT_EQ(hb("check " + scene("six_link") + " --rpm 300 --case-limit -1").status, 2);
  EXPECT_EQ(hb("check " + scene("six_link") + " --rpm 300 --case-limit nan").status, 2);
  EXPECT_EQ(hb("check " + scene("six_link") + " --rpm 300:100:10").status, 2);
}

// ---- injected errors ----

using namespace hb;

Scene damped_six_link() {
  std::vector<Override> overrides;
  for (const char* rod : {"AB", "CD"})
    for (const char* number : {"damping_x", "damping_y"})
      overrides.push_back({std::string(rod) + "." + number, "1e-3"});  // large enough to be seen
  return read_scene(HB_SOURCE_DIR "/tests/scenes/six_link.toml", overrides);
}

Settings two_modes() {
  Settings settings;
  settings.modes = 2;
  settings.tolerance = 1e-12;
  return settings;
}

const CheckOptions quick{.integrator = Integrator::collocation};

TEST(CrossCheck, FindsAnErrorInAnyTermOfTheAxialForceAndLoad) {
  const double speed = 157.0;
  const Settings settings = two_modes();
  SceneModel model = make_model(damped_six_link(), settings);
  const SpeedCheck correct = cross_check(model, speed, settings, quick);
  EXPECT_TRUE(correct.agrees());
  EXPECT_TRUE(correct.shortfalls.empty());
  int injected = 0;
  const HillSystem right = model.rods[0].system;
  const Body& link = *body_at(*model.linkage(), model.rods[0].link);
  for (std::size_t power = 0; power < 3; ++power)
    for (Eigen::Index k = 0; k < 5; ++k) {
      RodCoefficients wrong = model.coefficients.rods[0];
      if (k >= wrong.f[power].c.rows() || wrong.f[power].c.row(k).isZero(0)) continue;
      wrong.f[power].c.row(k) *= 1 + 1e-5;
      model.rods[0].system = ritz_system(link, wrong, 2);
      const SpeedCheck check = cross_check(model, speed, settings, quick);
      EXPECT_FALSE(check.rods[0].agrees()) << "f" << k << " in power " << power;
      EXPECT_TRUE(check.rods[1].agrees());
      ++injected;
    }
  model.rods[0].system = right;
  EXPECT_GE(injected, 10);
}

TEST(CrossCheck, FindsAnErrorInAnyRitzMatrix) {
  const double speed = 157.0;
  const Settings settings = two_modes();
  SceneModel model = make_model(damped_six_link(), settings);
  const HillSystem right = model.rods[0].system;
  const auto expect_found = [&](const std::string& what) {
    EXPECT_FALSE(cross_check(model, speed, settings, quick).rods[0].agrees()) << what;
    model.rods[0].system = right;
  };
  for (Eigen::Index i = 0; i < 2; ++i) {
    model.rods[0].system.mass(i, i) *= 1 + 1e-6;
    expect_found("mass");
    model.rods[0].system.damping(i, i) *= 1 + 1e-5;
    expect_found("damping");
    model.rods[0].system.load[2].c.row(i) *= 1 + 1e-6;
    expect_found("load");
    for (Eigen::Index k = 0; k < 2; ++k) {
      model.rods[0].system.stiffness[2].c.row(i + 2 * k) *= 1 + 1e-6;
      expect_found("stiffness");
    }
  }
}

TEST(CrossCheck, FindsAnErrorInAnyJointForce) {
  const double speed = 157.0;
  const Settings settings = two_modes();
  const SceneModel model = make_model(damped_six_link(), settings);
  const SpeedCheck check = cross_check(model, speed, settings, quick);
  ASSERT_TRUE(check.joints.has_value());
  std::vector<LinkResponse> responses;
  std::vector<int> links;
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    links.push_back(model.rods[r].link);
    responses.push_back({links[r], check.rods[r].steady.q});
  }
  const JointForces right = joint_forces(*model.linkage(), speed, responses);
  const auto agrees = [&](const JointForces& forces) {
    const JointCheck joints = compare_joints(*model.linkage(), forces, check.rods, links, speed);
    return joints.agrees();
  };
  EXPECT_TRUE(agrees(right));
  for (std::size_t k = 0; k < right.joints.size(); ++k)
    for (Eigen::Index component = 0; component < right.joints[k].elastic.c.rows(); ++component) {
      JointForces wrong = right;
      wrong.joints[k].elastic.c.row(component) *= 1 + 1e-5;
      EXPECT_FALSE(agrees(wrong)) << right.joints[k].name << " " << component;
    }
  JointForces wrong = right;
  wrong.torque.c *= 1 + 1e-6;
  EXPECT_FALSE(agrees(wrong));
}

}  // namespace
