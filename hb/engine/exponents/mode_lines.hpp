// The growth rate of modes that feel little of each other, and what a small change of the system makes of it, to a few
// digits: order by order in what couples the modes, hb/engine/README.md (E22)-(E24), without propagation.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "hb/engine/exponents/rough_growth.hpp"
#include "hb/engine/system/periodic_system.hpp"

namespace hb {

// Largest real parts of exponents, ' = d/dtau.
struct GrowthChange {
  double linear = 0;  // of the system as it was
  double change = 0;
  double by_half = 0;  // the change that every second angle tells
};

// How well a change has to be known: to a part of itself, or to a part of the growth rate or of a hundredth of the
// speed.
struct GrowthAccuracy {
  double of_change = 0, of_rate = 0;

  [[nodiscard]] double allowed(double change, double rate) const;
};

// Several systems that do not feel each other, their modes one after the other, at M angles.
class UncoupledSystems {
 public:
  // M of fast_length, 16 at least.
  UncoupledSystems(std::span<const PeriodicCoefficients> parts, Eigen::Index num_angles);
  ~UncoupledSystems();

  // What `change` of alpha and beta, at N <= M angles, makes of the largest growth rate. Modes whose damping is at
  // least twice that of the least damped one are not taken to lead. Empty where the orders do not settle: next to a
  // resonance of modes with each other or with themselves, or where a mode does not oscillate all over the turn.
  [[nodiscard]] std::optional<GrowthChange> growth(const NormalForm& change, const GrowthAccuracy& accuracy);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hb
