// The designs that `hb tune` chooses from: from the variables' values to metrics, worst over the speeds, and their
// derivatives.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/tune_design.hpp"
#include "tools/tune_gradient.hpp"
#include "tools/tune_metric.hpp"

namespace hb::tools {

// What was done, for --stats and for the report.
struct TuneCounts {
  int analyses = 0, gradients = 0, gradients_by_differences = 0;
  double analyses_seconds = 0, gradients_seconds = 0;
  int not_closing = 0, refused = 0;  // designs tried that were none
};

class DesignSpace {
 public:
  using At = std::function<std::vector<Override>(const std::vector<double>& x)>;
  using SpanAt = std::function<SpeedSpan(const std::vector<double>& x)>;

  // Keeps references to source, settings and counts. `margin` as in DesignAnalysis.
  DesignSpace(const SceneSource& source, const Settings& settings, SectionHeights given_heights, At overrides,
              SpanAt span, std::vector<Metric> metrics, double margin, bool per_turn, TuneCounts& counts);

  const std::vector<Metric>& metrics() const { return metrics_; }
  [[nodiscard]] SceneModel model(const std::vector<double>& x) const;  // throws SceneError
  [[nodiscard]] SectionHeights heights(const SceneModel& model) const;

  // Each design once. Throws SceneError.
  [[nodiscard]] const std::vector<MetricValue>& values(const std::vector<double>& x);
  // The same; empty, and counted, where there is no scene or no linkage that turns.
  [[nodiscard]] const std::vector<MetricValue>* try_values(const std::vector<double>& x);
  // d metric_k/dx_i; empty as in metric_gradients, or where the speeds themselves vary.
  [[nodiscard]] std::optional<Eigen::MatrixXd> gradients(const std::vector<double>& x, const std::vector<double>& lower,
                                                         const std::vector<double>& upper);
  // Anew, with further metrics and curves, on `times` the speeds.
  struct Report {
    std::vector<MetricValue> values;
    DesignCurves curves;
  };
  [[nodiscard]] Report report(const std::vector<double>& x, const std::vector<Metric>& metrics, int times) const;
  [[nodiscard]] std::vector<MetricValue> values(const std::vector<double>& x, int times) const;

  // From now on every design on so many times more speeds.
  void refine(int times);

 private:
  SpeedSpan span(const std::vector<double>& x, int times) const;

  const SceneSource& source_;
  const Settings& settings_;
  SectionHeights given_heights_;
  At overrides_;
  SpanAt span_;
  std::vector<Metric> metrics_;
  double margin_;
  bool per_turn_;
  TuneCounts& counts_;
  std::set<std::string> numbers_;  // paths that the scene gives
  int times_ = 1;
  std::map<std::vector<double>, std::vector<MetricValue>> known_;
};

}  // namespace hb::tools
