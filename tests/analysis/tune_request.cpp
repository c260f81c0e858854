// `hb::tune` as C++ calls it: of a scene's text, and of functions that build a linkage or a Hill system.
#include "hb/analysis/tune/tune_request.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "hb/analysis/steady.hpp"
#include "lib/scene/scene.hpp"

namespace hb {
namespace {

const std::string slider_crank = HB_SOURCE_DIR "/tests/scenes/slider_crank.toml";

// The second moment of the only rod, J, by a function: the text's own linkage otherwise.
SceneFamily by_function(const Scene& scene) {
  const Linkage given = std::get<Linkage>(scene.model);
  return {{{"J", 900}},
          [given](const std::vector<double>& values) {
            Linkage linkage = given;
            // A rod whose inertia the text leaves out has that of its section too: m J/A.
            Body& rod = linkage.dyads[0].coupler;
            rod.inertia += rod.mass / rod.elastic->area * (values[0] - rod.elastic->second_moment);
            rod.elastic->second_moment = values[0];
            return linkage;
          },
          scene.units};
}

TuneRequest least_deflection(const std::string& path) {
  TuneRequest request;
  request.minimise = "deflection";
  request.vary = {{path, 700, 1200}};
  request.keep = {"stable"};
  request.over = along("rpm", 2000, 3000, 6);
  request.modes = 2;
  request.tolerance = 1e-8;
  request.analyses = 30;
  request.algorithm = DesignAlgorithm::cobyla;
  return request;
}

// Designs could be searched for among the numbers of a scene's text alone.
TEST(TuneRequest, AFunctionIsTunedAsTheTextItStandsFor) {
  const SceneSource source(slider_crank);
  const TuneResult by_text = tune(source, least_deflection("rod.J"));
  const TuneResult found = tune(by_function(source.with()), least_deflection("J"));
  EXPECT_TRUE(by_text.design.status == DesignStatus::optimal) << by_text.design.evidence;
  EXPECT_LT(by_text.goal_after, by_text.goal_before);
  EXPECT_NEAR(by_text.tuned[0], 1200, 1);  // the stiffest bends least
  EXPECT_NEAR(found.tuned[0], by_text.tuned[0], 1e-9 * by_text.tuned[0]);
  EXPECT_NEAR(found.goal_after, by_text.goal_after, 1e-12 * by_text.goal_after);
  // Which number the damping is proportional to, only a text tells.
  EXPECT_TRUE(by_text.damping_sensitivity);
  EXPECT_FALSE(found.damping_sensitivity);
}

// q'' + 2 d q' + (1 + 0.4 cos tau) q = 0 at twice its frequency: the most stable is the most damped.
TEST(TuneRequest, AHillSystemBuiltInCodeIsTuned) {
  const SceneFamily family({{"d", 0.01}}, [](const std::vector<double>& values) {
    HillSystem system;
    system.mass = Eigen::MatrixXd::Identity(1, 1);
    system.damping = Eigen::MatrixXd::Constant(1, 1, 2 * values[0]);
    system.stiffness[0] = FourierSeries(1, 1);
    system.stiffness[0].c << 1, 0.2;
    return system;
  });
  TuneRequest request;
  request.maximise = "stable";
  request.vary = {{"d", 0.005, 0.3}};
  request.omega = 2;
  const TuneResult found = tune(family, request);
  EXPECT_NEAR(found.tuned[0], 0.3, 1e-3);
  Request one;
  one.omega = 2;
  const SteadyResult there = steady(family.scene({{"d", found.tuned[0]}}), one);
  EXPECT_NEAR(found.goal_after, -there.rods[0].stability->growth_rate, 1e-6);
}

TEST(TuneRequest, RefusesWhatCannotBeAsked) {
  const SceneSource source(slider_crank);
  const auto field = [&](const std::function<void(TuneRequest&)>& spoil) -> std::string {
    TuneRequest request = least_deflection("rod.J");
    spoil(request);
    try {
      (void)tune_task(source, request);
    } catch (const RequestError& error) {
      return error.field;
    }
    return "";
  };
  EXPECT_EQ(field([](TuneRequest&) {}), "");
  EXPECT_EQ(field([](TuneRequest& request) { request.minimise.clear(); }), "minimise");
  EXPECT_EQ(field([](TuneRequest& request) { request.maximise = "stable"; }), "minimise");
  EXPECT_EQ(field([](TuneRequest& request) { request.minimise = "beauty"; }), "minimise");
  EXPECT_EQ(field([](TuneRequest& request) { request.vary.clear(); }), "vary");
  EXPECT_EQ(field([](TuneRequest& request) { request.vary[0].upper = 700; }), "vary");
  EXPECT_EQ(field([](TuneRequest& request) { request.vary[0].upper = std::nan(""); }), "vary");
  EXPECT_EQ(field([](TuneRequest& request) { request.vary.push_back(request.vary[0]); }), "vary");
  EXPECT_EQ(field([](TuneRequest& request) { request.keep = {"beauty<=1"}; }), "keep");
  EXPECT_EQ(field([](TuneRequest& request) { request.over->path = "rod.J"; }), "over");
  EXPECT_EQ(field([](TuneRequest& request) { request.over->values = {-1, 3}; }), "over");
  EXPECT_EQ(field([](TuneRequest& request) { request.analyses = 0; }), "analyses");
  EXPECT_EQ(field([](TuneRequest& request) { request.algorithm = DesignAlgorithm::bobyqa; }), "algorithm");
  TuneRequest unknown = least_deflection("rod.j");
  EXPECT_THROW((void)tune_task(source, unknown), SceneError);
}

}  // namespace
}  // namespace hb
