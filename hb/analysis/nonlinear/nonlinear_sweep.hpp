// Branches of the motion without linearisation along the speed or any other number of the scene: through folds, with
// stability, bifurcations and the speeds at which the motion jumps.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/rod_peaks.hpp"
#include "hb/analysis/rod_stress.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "hb/engine/nonlinear/continuation.hpp"

namespace hb {

// Of a bent rod over the motion, as NonlinearRod has them.
struct BentLoads {
  double deflection = 0, bending_moment = 0;
  std::optional<PeakErrors> errors;  // of both; empty: no motion with more modes was found
  RodStress stress;
  std::optional<StressCycle> cycle;  // with a section
};

struct NonlinearPoint {
  double x = 0, speed = 0;  // along the axis; rad per unit time
  bool asked = false;  // at a value of the axis; else a step of the continuation
  RodPeaks max_abs;
  double error_bound = 0;  // estimate of max |error of q| / max |q|, where x may differ by x_error
  double x_error = 0;
  std::optional<Stability> stability;  // of all rods together
  std::shared_ptr<const PeriodicMotion> motion = nullptr;  // where asked; for nonlinear_answer
  std::vector<BentLoads> loads = {};  // by rod; where asked, with settings().only.shape
  std::optional<MachinePoint> machine = std::nullopt;  // where asked, with settings().only.reactions
};

struct NonlinearBranch {
  int turns = 1;  // T: motions of period 2 pi T/Omega
  std::vector<NonlinearPoint> points;  // along the arc
  BranchEnd end = BranchEnd::range;
  std::string why;  // where the equations end: rod, crank angle
};

struct NonlinearEvent {
  BifurcationKind kind = BifurcationKind::fold;
  double x = 0, speed = 0, error = 0;  // error: estimate, of x
  int turns = 1;
  std::size_t branch = 0, after = 0;  // behind this point of this branch
  RodPeaks max_abs;
};

// A stable motion ends at a fold when x is moved slowly in one direction.
struct Jump {
  double x = 0, speed = 0, error = 0;
  bool upward = true;  // x rises
  RodPeaks from;
  std::vector<RodPeaks> to;  // stable motions of other parts of the branches there, interpolated between their points
};

// A point of a branch.
struct BranchPlace {
  std::size_t branch = 0, point = 0;
};

struct NonlinearSweep {
  double tolerance = 0;  // that motions were solved to: the one asked for, at least 1e-8
  std::vector<std::string> rods;
  std::vector<bool> reported;
  std::vector<std::string> joints;  // of MachinePoint::bearings
  std::vector<NonlinearBranch> branches;
  std::vector<NonlinearEvent> folds, bifurcations;
  std::vector<Jump> jumps;
  // At each value of the axis the first passage of the branch followed from its first value; empty: it does not come
  // there.
  std::vector<std::optional<BranchPlace>> followed;
  bool stopped = false;
  std::vector<std::string> shortfalls;
  std::vector<Stage> stages;
};

// A motion near one of the system, from which a branch is followed both ways.
struct BranchStart {
  double x = 0;  // along the axis, within its values
  int turns = 1;
  FourierSeries q;  // of all rods, one above the other; harmonic k is k Omega/turns
};

struct NonlinearSweepOptions {
  int turns = 1;  // motions of up to this many turns, a power of two: from period doublings
  std::vector<BranchStart> starts = {};  // beside the motions that are looked for
  std::function<bool()> stop = {};  // true ends the work with what is there
  // Told how many more of the axis' values the branch from the first one has come to.
  std::function<void(std::size_t values)> advanced = {};
};

// Throws RequestError for a [hill] scene, one without elastic links or with shear, turns that are no power of two, and
// a start that is none.
void require_nonlinear(const SweepScene& scene, const NonlinearSweepOptions& options);

// From the motion at the axis' first value (nonlinear_steady) upward, and from its last value downward where the motion
// there is another one; with every branch that leaves these at a bifurcation of as many turns, or of twice as many.
// Branches from `starts` follow where no other passes there. Without settings().only.stability only folds are found.
// Throws as require_nonlinear does.
[[nodiscard]] NonlinearSweep nonlinear_sweep(const SweepScene& scene, const NonlinearSweepOptions& options = {});

}  // namespace hb
