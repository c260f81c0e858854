// Worst cases and errors of what a design is judged by, against brute force, and the notation of goals.
#include "hb/analysis/tune/tune_design.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "hb/analysis/tune/tune_quantities.hpp"
#include "lib/scene/scene.hpp"

namespace hb {
namespace {

// All speeds one by one.
struct Brute {
  double deflection = 0, growth = -HUGE_VAL;
};
Brute brute(const SceneModel& model, const Settings& settings, double from, double to, int count) {
  Brute worst;
  Settings options = settings;
  options.only = {true, true, false, true};
  for (int k = 0; k < count; ++k) {
    const SpeedResult result = analyse(model, from + (to - from) * k / (count - 1), options);
    for (const RodResult& rod : result.rods) {
      worst.deflection = std::max(worst.deflection, rod.shape->deflection.max_abs);
      worst.growth = std::max(worst.growth, rod.stability->growth_rate);
    }
  }
  return worst;
}

TEST(WorstCaseOfADesign, IsNotBelowAnySpeedSampled) {
  for (const char* name : {"six_link", "four_bar"}) {
    SCOPED_TRACE(name);
    Scene scene = read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + name + ".toml");
    const double unit = speed_from_rpm(1, scene.units);
    Settings settings;
    settings.modes = 3;
    const SceneModel model = make_model(std::move(scene), settings);
    const SpeedSpan span{300 * unit, 1600 * unit, 16};
    const Work work;
    DesignAnalysis design(model, settings, span, {}, work);
    const Brute dense = brute(model, settings, span.from, span.to, 250);
    const double deflection = design.value(parse_goal("deflection").terms[0].metric).value;
    const double margin = design.value(parse_keep("stable").metric).value;
    EXPECT_GE(deflection, dense.deflection * (1 - 1e-9));
    EXPECT_LE(deflection, dense.deflection * 1.02);  // the peak between two of the 250
    EXPECT_LE(margin, -dense.growth + 1e-6 * std::abs(dense.growth));
  }
}

// Values with few modes against those with twenty; the estimate may be pessimistic, but not by orders.
TEST(ErrorOfAMetric, CoversTheModesLeftOut) {
  for (const char* name : {"six_link", "slider_crank", "four_bar"}) {
    const Scene scene = read_scene(std::string(HB_SOURCE_DIR "/tests/scenes/") + name + ".toml");
    const double speed = 1500 * speed_from_rpm(1, scene.units);
    const SpeedSpan span{speed, speed, 1};
    Settings few, many;
    few.modes = 2;
    many.modes = 20;
    few.tolerance = many.tolerance = 1e-12;
    const SceneModel cut = make_model(scene, few), full = make_model(scene, many);
    const Work work;
    DesignAnalysis cut_design(cut, few, span, {{"*", 8}}, work), full_design(full, many, span, {{"*", 8}}, work);
    for (const char* goal :
         {"deflection", "stress", "total-stress", "force", "torque-ripple", "stable", "frequency", "clearance"}) {
      SCOPED_TRACE(std::string(name) + ", " + goal);
      const bool large = std::string_view("stable frequency clearance").find(goal) != std::string_view::npos;
      const Metric metric = (large ? parse_largest_goal(goal) : parse_goal(goal)).terms[0].metric;
      MetricValue value = cut_design.value(metric);
      complete(value, cut, {{"*", 8}}, span, few, metric);
      const double truth = full_design.value(metric).value, off = std::abs(value.value - truth);
      EXPECT_LE(off, value.error + 1e-9 * std::abs(truth));
      EXPECT_LE(value.error, 100 * off + 1e-4 * std::abs(truth));
    }
  }
}

TEST(TuneNotation, ReadsGoalsAndConditions) {
  const Goal goal = parse_goal("0.7*deflection:AB + 1e+1*mass");
  ASSERT_EQ(goal.terms.size(), 2u);
  EXPECT_EQ(goal.terms[0].weight, 0.7);
  EXPECT_EQ(goal.terms[0].metric.name, "AB");
  EXPECT_EQ(goal.terms[1].weight, 10);
  EXPECT_TRUE(goal.weighted);
  EXPECT_FALSE(parse_goal("force:B").weighted);
  const Keep turn = parse_keep("stable>=0.1/turn");
  EXPECT_EQ(turn.metric.kind, MetricKind::margin_per_turn);
  EXPECT_EQ(turn.bound, 0.1);
  EXPECT_EQ(parse_keep("clearance:3>=0.2").metric.orders, 3);
  for (const char* wrong :
       {"", "stable>=x", "mass", "mass<=0", "frequency<=3", "force<=", "mass<=nan", "clearance:0>=1"})
    EXPECT_THROW((void)parse_keep(wrong), RequestError) << wrong;
  for (const char* wrong : {"", "mass+", "-1*mass", "frequency", "stable", "deflection:", "torque-ripple:AB", "safety"})
    EXPECT_THROW((void)parse_goal(wrong), RequestError) << wrong;
}

}  // namespace
}  // namespace hb
