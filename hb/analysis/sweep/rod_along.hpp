// One rod along a sweep, as functions of x.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>

#include "hb/analysis/sweep/sweep_scene.hpp"
#include "hb/engine/steady/response_peak.hpp"
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

  // Empty also where it is singular. `tolerance` is relative to the largest |q|.
  [[nodiscard]] std::optional<FourierSeries> response(double x, double tolerance) const;

  // max |q_i| over the turn, i = component + 1.
  [[nodiscard]] ResponseAt largest(int component, double tolerance) const;

 private:
  const SweepScene& scene_;
  std::size_t rod_;
  std::atomic<std::size_t>& evaluations_;
};

}  // namespace hb
