// The designs to choose from: from the variables' values to metrics, worst over the speeds, and their
// derivatives; and from metrics to goal and conditions.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/tune/tune_design.hpp"
#include "hb/analysis/tune/tune_gradient.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "hb/engine/design/design.hpp"

namespace hb {

// What was done, for --stats and for the report.
struct TuneCounts {
  int analyses = 0, gradients = 0, gradients_by_differences = 0;
  double analyses_seconds = 0, gradients_seconds = 0;
  int not_closing = 0, refused = 0;  // designs tried that were none
};

class DesignSpace {
 public:
  using At = std::function<Numbers(const std::vector<double>& x)>;
  using SpanAt = std::function<SpeedSpan(const std::vector<double>& x)>;

  // Keeps references to family, settings, counts and work. `required` as in DesignAnalysis.
  DesignSpace(const SceneFamily& family, const Settings& settings, SectionHeights given_heights, At numbers,
              SpanAt span, std::vector<Metric> metrics, std::vector<RequiredDecay> required, TuneCounts& counts,
              const Work& work);

  const std::vector<Metric>& metrics() const { return metrics_; }
  [[nodiscard]] SceneModel model(const std::vector<double>& x) const;  // throws SceneError
  [[nodiscard]] SectionHeights heights(const SceneModel& model) const;

  // Each design once. Throws SceneError.
  [[nodiscard]] const std::vector<MetricValue>& values(const std::vector<double>& x);
  // The same; empty, and counted, where there is no scene or no linkage that turns.
  [[nodiscard]] const std::vector<MetricValue>* try_values(const std::vector<double>& x);
  // Of a design that was analysed, or nullptr.
  [[nodiscard]] const std::vector<MetricValue>* known(const std::vector<double>& x) const;
  // d metric_k/dx_i; empty as in metric_gradients, or where the speeds themselves vary.
  [[nodiscard]] std::optional<Eigen::MatrixXd> gradients(const std::vector<double>& x, const std::vector<double>& lower,
                                                         const std::vector<double>& upper);
  // On `times` the speeds of the search, complete with places and errors.
  [[nodiscard]] std::vector<MetricValue> values(const std::vector<double>& x, int times) const;
  // Further metrics, the worst of two analyses, the second on `times` the speeds, and its curves.
  struct Report {
    std::vector<MetricValue> values;
    std::vector<bool> confirmed;  // both analyses agree to `tolerance`, relative
    DesignCurves curves;
    std::vector<MetricValue> margins;  // of every elastic link, asked for or not
  };
  [[nodiscard]] Report report(const std::vector<double>& x, const std::vector<Metric>& metrics, int times,
                              double tolerance) const;

  // From now on every design on so many times more speeds.
  void refine(int times);
  // Forgets what was computed: the settings have changed.
  void forget() { known_.clear(); }

 private:
  SpeedSpan span(const std::vector<double>& x, int times) const;

  const SceneFamily& family_;
  const Settings& settings_;
  SectionHeights given_heights_;
  At numbers_;
  SpanAt span_;
  std::vector<Metric> metrics_;
  std::vector<RequiredDecay> required_;
  TuneCounts& counts_;
  const Work& work_;
  int times_ = 1;
  std::map<std::vector<double>, std::vector<MetricValue>> known_;
};

// A condition on the worst of several rods or joints has a kink where another becomes the worst: one each is smooth.
struct ConditionPart {
  Keep keep;
  std::size_t of;  // place among the conditions asked for
};

class DesignAims {
 public:
  // `model`: any design; for names. Keeps a reference to the goal.
  DesignAims(const Goal& goal, const std::vector<Keep>& keeps, const SceneModel& model);

  const std::vector<Metric>& metrics() const { return metrics_; }
  const std::vector<ConditionPart>& parts() const { return parts_; }
  // A goal that is the worst of several rods, one each; else empty.
  const std::vector<Metric>& goal_parts() const { return goal_parts_; }
  std::vector<RequiredDecay> required() const;

  // Values of the metrics at the start: units of weighted terms and of margins. Throws RequestError where a weighted
  // sum has none.
  void scale_by(std::vector<double> start);
  // Kept free of every part, in its unit: for errors of values.
  Eigen::VectorXd allowance;

  double value_of(const Metric& metric, const std::vector<double>& values) const;
  double goal(const std::vector<double>& values) const;  // as asked for, not as minimised
  double goal_error(const std::vector<MetricValue>& values) const;  // of a weighted sum
  double sign() const { return goal_.maximise ? -1 : 1; }
  double unit_of(const Keep& keep) const;
  double excess(const Keep& keep, double value) const;  // beyond the bound, in units

  // As minimised, allowance included; empty where something is not finite.
  [[nodiscard]] std::optional<DesignValues> design_values(const std::vector<double>& values) const;
  // Rows of `slopes` are the metrics'.
  [[nodiscard]] DesignGradient design_gradient(const Eigen::MatrixXd& slopes, const std::vector<double>& values) const;
  // What the errors of the values ask for.
  [[nodiscard]] Eigen::VectorXd allowance_for(const std::vector<MetricValue>& values) const;

 private:
  std::size_t place_of(const Metric& metric) const;
  double factor(const GoalTerm& term) const;

  const Goal& goal_;
  std::vector<Metric> metrics_, goal_parts_;
  std::vector<ConditionPart> parts_;
  std::vector<double> start_;
};

}  // namespace hb
