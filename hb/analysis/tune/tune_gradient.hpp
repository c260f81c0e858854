// Derivatives of a design's metrics with respect to its variables. The worst speed, place and crank angle of a metric
// do not move to first order, so each is differentiated where it is worst, and only the scene's coefficients are
// computed for neighbouring designs (their differences), never a response or an exponent:
//   deflection, stresses, safety   adjoint solution of the rod's Hill system (hill_sensitivity.hpp)
//   margin                 right and left Floquet vectors
//   joint force, torque    derivative of q by one linear solution per variable, through the linear force map
//   mass, frequency, clearance   closed form of the coefficients
//   theory error           none: the whole analysis is differenced
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hb/analysis/tune/tune_design.hpp"
#include "hb/analysis/tune/tune_metric.hpp"

namespace hb {

struct DesignFamily {
  std::function<SceneModel(const std::vector<double>& x)> model;  // may throw SceneError
  std::function<SectionHeights(const SceneModel& model)> heights;
  std::vector<double> lower, upper;  // of the variables
  const Settings& settings;
};

// d metric_k/dx_i at x, where `values` are the metrics' own. Empty where a neighbour does not exist, two exponents
// meet, or a metric has no value.
[[nodiscard]] std::optional<Eigen::MatrixXd> metric_gradients(const DesignFamily& family, const std::vector<double>& x,
                                                              const std::vector<Metric>& metrics,
                                                              const std::vector<MetricValue>& values);

}  // namespace hb
