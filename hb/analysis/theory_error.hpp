// By how much the linear theory itself is off: what the first correction by the exact model (lib/exact) would change.
// With the linear answer q inserted into the exact residual r of all rods together and the linear Hill system of each
// rod, M dq'' + B dq' + C dq = -(r - r_linear); section "Theory error" of README.md here.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hb/engine/system/scaled_system.hpp"
#include "lib/exact/exact_model.hpp"

namespace hb {

// A relative change above this, or none computable, is beyond the linear theory.
constexpr double theory_error_limit = 0.05;
[[nodiscard]] inline bool beyond_theory(const std::optional<double>& error) {
  return !(error && *error <= theory_error_limit);
}

// The linear answer of one rod, in the order of the exact model's.
struct LinearRod {
  const HillSystem* system = nullptr;  // that q solves
  const FourierSeries* q = nullptr;  // empty: no periodic solution
  const ScaledSystem* scaled = nullptr;  // of the system at the speed, where at hand
};

struct TheoryErrors {
  struct Rod {
    // max over i and t of |dq_i| over max over i and t of |q_i|. Empty where the exact model has no value.
    std::optional<double> q;
    std::optional<double> deflection;  // max over x and t of |dw| over max |w|, of the modes kept
    FourierSeries correction;  // dq
    std::optional<double> axial_share;  // where asked for: axial_shares() of this rod
  };
  std::vector<Rod> rods;
  // Largest change over the turn of any joint force's component, and of the driving torque, over the largest of each;
  // only where linear forces are given. Empty also where q + dq breaks the exact model.
  std::optional<double> force, torque;
  // Change of the driving torque's mean over the turn, as it is: the mean is small where little but damping takes
  // power.
  std::optional<double> mean_torque;
  // Change of the mechanism's growth rate, per unit time, where asked for: growth_theory_error().
  std::optional<double> growth;
  double steepest = 0;  // largest slope |w'| of the linear answer that the exact model met; 0: none
  std::string reason;  // why there is no value: a rod folds, the bent linkage opens, no periodic solution
};

// The exact model of all elastic links with as many modes; points along the rods enough for 1e-3 of errors above
// 1e-5.
[[nodiscard]] ExactModel theory_model(const Linkage& linkage, const std::vector<Eigen::Index>& num_modes,
                                      Eigen::Index points_beside_modes = 8);

// `forces`: of the same linear answer, or nullptr.
[[nodiscard]] TheoryErrors theory_errors(const ExactModel& model, double speed, std::span<const LinearRod> rods,
                                         const JointForces* forces = nullptr);

// Of the change that bending makes, for each rod the share that its axial elasticity would take from it, which the
// exact model leaves out: (2 omega_1/omega_axial)^2 with omega_1 the rod's first bending frequency and omega_axial that
// of EA/l against a third of its own mass and the mass it drives along itself, the largest over the turn. An estimate.
[[nodiscard]] std::vector<double> axial_shares(const ExactModel& model);

}  // namespace hb
