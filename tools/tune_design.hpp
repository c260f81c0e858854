// One design of a scene over a speed range: the worst case of every metric, found between the speeds sampled.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/linkage_analysis.hpp"
#include "tools/tune_metric.hpp"
#include "tools/tune_quantities.hpp"

namespace hb::tools {

struct MetricValue {
  double value = 0;  // in unit_of(kind); NaN where there is no periodic solution
  std::optional<double> speed;  // where it is worst, rad per unit time
  std::string where;  // rod or joint
  std::size_t index = 0;  // of that rod in SceneModel::rods, of that joint in JointForces::joints
  double factor = 1;  // from the scene's units
};

struct SpeedSpan {
  double from = 0, to = 0;  // rad per unit time; equal: one speed
  int num_nodes = 24;  // sampled before refinement
};

// Response and margin over the speeds sampled, for pictures.
struct DesignCurves {
  std::vector<double> speed;
  std::vector<std::string> rods;
  Eigen::MatrixXd deflection;  // speeds x rods
  Eigen::VectorXd growth;  // largest over the rods
};

class DesignAnalysis {
 public:
  // Keeps references to both.
  // `margin`: bands are looked for that decay slower than this (1/time, or per turn), also where narrow.
  DesignAnalysis(const SceneModel& model, const Settings& settings, SpeedSpan span, SectionHeights heights,
                 double margin = 0, bool per_turn = false);
  ~DesignAnalysis();

  // Throws UsageError for a name that the scene does not have.
  [[nodiscard]] MetricValue value(const Metric& metric);
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
  void find_instabilities();  // adds nodes in narrow bands

  const SceneModel& model_;
  const Settings& settings_;
  SpeedSpan span_;
  SectionHeights heights_;
  double margin_;
  bool per_turn_;
  std::vector<std::unique_ptr<Sample>> nodes_;  // ascending speed
  bool placed_ = false;
};

}  // namespace hb::tools
