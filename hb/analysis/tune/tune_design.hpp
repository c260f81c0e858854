// One design of a scene over a speed range: the worst case of every metric, found between the speeds sampled.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/tune/tune_growth.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "hb/analysis/tune/tune_quantities.hpp"
#include "hb/analysis/work.hpp"

namespace hb {

// Response and margin over the speeds sampled, for pictures.
struct DesignCurves {
  std::vector<double> speed;
  std::vector<std::string> rods;
  Eigen::MatrixXd deflection;  // speeds x rods
  Eigen::VectorXd growth;  // largest over the rods
};

class DesignAnalysis {
 public:
  // Keeps references to model, settings and work. Bands of instability, and those that decay slower than required, are
  // looked for also where narrow.
  DesignAnalysis(const SceneModel& model, const Settings& settings, SpeedSpan span, SectionHeights heights,
                 const Work& work, std::vector<RequiredDecay> required = {});
  ~DesignAnalysis();

  // Throws RequestError for a name that the scene does not have.
  [[nodiscard]] MetricValue value(const Metric& metric);
  // Of every elastic link, asked for or not: the decay rate of its slowest disturbance, 1/time.
  [[nodiscard]] std::vector<MetricValue> margins();
  [[nodiscard]] DesignCurves curves();

 private:
  struct Sample;
  struct Curve;
  std::vector<Curve> curves_of(const Metric& metric);
  double at(const Curve& curve, double speed);
  double at_node(const Curve& curve, std::size_t node);
  MetricValue worst(const Metric& metric, const std::vector<Curve>& curves);
  MetricValue clearance(const Metric& metric);
  void place_nodes();  // new ones on resonances
  // At all nodes that do not have it yet.
  void respond();
  void need_forces();
  void need_theory();
  void need_whole_stress(const std::vector<Curve>& curves);
  double whole_stress(const Curve& curve, double speed, const FourierSeries& q) const;
  void find_instabilities();  // adds nodes in narrow bands

  const SceneModel& model_;
  const Settings& settings_;
  SpeedSpan span_;
  SectionHeights heights_;
  const Work& work_;
  std::vector<RequiredDecay> required_;  // begins with none at all
  std::vector<std::unique_ptr<Sample>> nodes_;  // ascending speed
  bool placed_ = false;
};

}  // namespace hb
