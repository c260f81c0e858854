// Derivatives of every metric of a design against central differences of the whole analysis.
#include "hb/analysis/tune/tune_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hb/analysis/tune/tune_design.hpp"
#include "hb/engine/design/differences.hpp"
#include "lib/scene/scene.hpp"

namespace {

using namespace hb;

struct Question {
  SceneSource source;
  std::vector<std::string> paths;
  Settings settings;
  double from, to;  // rpm

  SceneModel model(const std::vector<double>& x) const {
    std::vector<Override> overrides;
    for (std::size_t i = 0; i < x.size(); ++i) overrides.push_back(number_override(paths[i], x[i]));
    return make_model(source.with(overrides), settings);
  }
  std::vector<MetricValue> values(const std::vector<double>& x, const std::vector<Metric>& metrics) const {
    const SceneModel scene = model(x);
    const double unit = speed_from_rpm(1, scene.scene.units);
    const Work work;
    DesignAnalysis analysis(scene, settings, {from * unit, to * unit, 8}, heights(scene), work);
    std::vector<MetricValue> values;
    for (const Metric& metric : metrics) values.push_back(analysis.value(metric));
    return values;
  }
  // Any function of the design will do.
  static SectionHeights heights(const SceneModel& scene) {
    SectionHeights heights;
    if (!scene.linkage()) return heights;
    for (const int link : elastic_links(*scene.linkage())) {
      const Body& body = *body_at(*scene.linkage(), link);
      heights[body.name] = std::sqrt(12 * body.elastic->second_moment / body.elastic->area);
    }
    return heights;
  }
};

// Differences over steps h and h/2: their distance is three times the truncation error of the finer ones. The values
// themselves are good to `noise`: steady states to 1e-12, worst speeds to 1e-7, whose square enters; growth rates to
// the 1e-9 that they are asked for.
void expect_gradients(const Question& question, const std::vector<double>& x, const std::vector<std::string>& goals,
                      const std::vector<std::string>& keeps) {
  constexpr double part = 1e-3;
  std::vector<Metric> metrics;
  for (const std::string& goal : goals) metrics.push_back(parse_goal(goal).terms[0].metric);
  for (const std::string& keep : keeps) metrics.push_back(parse_keep(keep).metric);
  const std::vector<MetricValue> values = question.values(x, metrics);
  std::vector<double> lower, upper;
  for (const double number : x) {
    lower.push_back(number / 2);
    upper.push_back(number * 2);
  }
  const DesignFamily family{[&](const std::vector<double>& y) { return question.model(y); }, Question::heights, lower,
                            upper, question.settings};
  const auto gradients = metric_gradients(family, x, metrics, values);
  ASSERT_TRUE(gradients);
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::VectorXd place = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
  const auto differences = [&](double step) {
    return *difference_jacobian(
        [&](const Eigen::VectorXd& y) -> OptionalVector {
          Eigen::VectorXd numbers(static_cast<Eigen::Index>(metrics.size()));
          const std::vector<MetricValue> found = question.values({y.data(), y.data() + n}, metrics);
          for (std::size_t k = 0; k < found.size(); ++k) numbers(static_cast<Eigen::Index>(k)) = found[k].value;
          return numbers;
        },
        place, place / 2, place * 2, step * place);
  };
  const Eigen::MatrixXd coarse = differences(part), fine = differences(part / 2);
  for (Eigen::Index k = 0; k < fine.rows(); ++k) {
    const MetricKind kind = metrics[static_cast<std::size_t>(k)].kind;
    const double noise = kind == MetricKind::margin || kind == MetricKind::margin_per_turn ? 1e-9 : 2e-11;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double value = std::abs(values[static_cast<std::size_t>(k)].value),
                   unit = value / x[static_cast<std::size_t>(i)];
      const double allowed = std::abs(coarse(k, i) - fine(k, i)) + 4 * noise * unit / part;
      EXPECT_NEAR((*gradients)(k, i), fine(k, i), allowed)
          << metrics[static_cast<std::size_t>(k)].text << " over " << question.paths[static_cast<std::size_t>(i)];
      EXPECT_LE(allowed, 1e-3 * (std::abs(fine(k, i)) + unit));  // that says something
    }
  }
}

Settings settings_of(int modes) {
  Settings settings;
  settings.modes = modes;
  settings.tolerance = 1e-12;
  settings.only = {false, true, true, false};
  return settings;
}

const std::string tuned_scenes = HB_SOURCE_DIR "/tests/scenes/";

TEST(TuneGradient, AgreesWithDifferencesOfTheSixLinkMechanism) {
  // The worst force of a joint turns with the design; the longest lever is at the upper end of the speeds.
  const Question question{SceneSource(tuned_scenes + "six_link.toml"),
                          {"AB.J", "crank.length", "CD.damping_internal"},
                          settings_of(3),
                          500,
                          1400};
  expect_gradients(
      question, {45, 55, 1e-4},
      {"deflection", "deflection:AB", "stress:CD", "total-stress:CD", "force:CD.1", "torque-ripple", "mass"},
      {"stable", "stable>=0/turn", "frequency>=1", "clearance:3>=0.1"});
}

TEST(TuneGradient, AgreesWithDifferencesOfTheSliderCrank) {
  const SceneSource scene_file(tuned_scenes + "slider_crank.toml");
  const Question question{
      SceneSource(scene_file.text_with({{"rod.yield", "\"250 MPa\""}, {"rod.endurance", "\"100 MPa\""}}),
                  "slider_crank.toml", tuned_scenes),
      {"rod.length", "rod.mass"},
      settings_of(3),
      1000,
      3000};
  const Scene scene = question.source.with();
  const Body& rod = *body_at(std::get<Linkage>(scene.model), 1);
  expect_gradients(question, {rod.length, rod.mass}, {"deflection", "stress", "total-stress", "force:rod.0", "mass"},
                   {"stable", "safety>=1"});
  // Fatigue is nearer there; without an endurance limit yielding is what is left.
  const Question yielding{
      SceneSource(scene_file.text_with({{"rod.yield", "\"250 MPa\""}}), "slider_crank.toml", tuned_scenes),
      question.paths, question.settings, 1000, 3000};
  expect_gradients(yielding, {rod.length, rod.mass}, {"mass"}, {"safety>=1"});
}

TEST(TuneGradient, AgreesWithDifferencesOfARodWithShear) {
  const Question question{SceneSource(tuned_scenes + "thick_rod.toml"),
                          {"rod.shear.G", "rod.shear.k", "rod.length"},
                          settings_of(2),
                          3000,
                          9000};
  expect_gradients(question, {79.3e9, 0.85, 0.11}, {"deflection", "stress", "force:rod.0"}, {"stable", "frequency>=1"});
}

TEST(TuneGradient, AgreesWithDifferencesOfAHillSystem) {
  const Question question{
      SceneSource(tuned_scenes + "mathieu.toml"), {"hill.damping.0.0", "hill.mass.0.0"}, settings_of(1), 25, 40};
  expect_gradients(question, {question.source.value("hill.damping.0.0"), question.source.value("hill.mass.0.0")},
                   {"deflection"}, {"stable"});
}

}  // namespace
