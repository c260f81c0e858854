// One rod along a sweep, as functions of x.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <optional>

#include "hb/analysis/sweep/sweep_scene.hpp"
#include "hb/engine/steady/response_peak.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// Refers to its arguments; counts every place that it is asked for.
class RodAlong {
 public:
  RodAlong(const SweepScene& scene, std::size_t rod, std::atomic<std::size_t>& evaluations)
      : scene_(scene), rod_(rod), evaluations_(evaluations) {}

  const Settings& settings() const { return scene_.settings(); }

  // Empty where there is no linkage.
  [[nodiscard]] std::optional<ScaledSystem> system(double x) const;

  // Of the averaged system, ascending, over the speed: NaN where negative. Empty where there is no linkage.
  [[nodiscard]] Eigen::VectorXd mean_frequencies(double x) const;

  // To a few digits; empty also where it is singular.
  [[nodiscard]] std::optional<FourierSeries> rough_response(double x) const;

  // q_i alone, i = component + 1, near a place; empty where there is none there.
  [[nodiscard]] std::optional<PeakResponses> responses(int component, double about) const;

 private:
  [[nodiscard]] std::optional<SteadyState> solved(double x, const SteadyOptions& options) const;

  const SweepScene& scene_;
  std::size_t rod_;
  std::atomic<std::size_t>& evaluations_;
};

}  // namespace hb
