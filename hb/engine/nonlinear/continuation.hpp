// Branches of periodic motions along the parameter by pseudo-arclength: through folds, with what lies on them located
// (H. B. Keller, in Applications of Bifurcation Theory, Academic Press 1977, 359-384).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"

namespace hb {

struct ContinuationOptions {
  // Tolerance, turns and harmonics of every motion. On a branch its error leaves the parameter free to differ by
  // PeriodicMotion::parameter_error, or it would be infinite at folds.
  MotionOptions motion = {.tolerance = 1e-8};
  double low = 0, high = 0;  // the parameter's range: the branch ends where it leaves it
  int direction = 1;  // of the parameter at the start: +1 or -1
  std::vector<double> stops = {};  // parameters at which a point is wanted whenever the branch passes
  bool end_at_stop = false;  // the first passage of one ends the branch, as the end of the range does
  // Lengths along the branch: sqrt((d parameter/parameter_scale)^2 + (rms of dq/size)^2), size the rms of q itself (or
  // motion_scale where that is larger). parameter_scale 0: larger modulus of the range's ends.
  double first_step = 0.01, most_step = 0.1, least_step = 1e-7;
  double parameter_scale = 0, motion_scale = 0;
  double most_parameter_step = 0;  // 0: a fortieth of the range
  int max_points = 5000;
  bool stability = true;  // exponents at every point; without them only folds are found
  StabilityOptions exponents = {};
  double location_tolerance = 1e-8;  // of a fold's or bifurcation's parameter, relative
  std::function<bool()> stop = {};  // true ends the work
  std::function<void(double parameter)> reached = {};  // told where each point of the branch is, as soon as it is found
};

// A motion and the branch's direction through it.
struct BranchPoint {
  PeriodicMotion motion;
  double arc = 0;  // length from the start
  FourierSeries tangent;  // dq/ds
  double parameter_tangent = 0;  // dp/ds
  std::optional<Stability> stability;
  bool stop = false;  // one of the stops, or an end of the range
};

enum class BifurcationKind {
  fold,  // the parameter turns back; a real multiplier passes +1
  branch_point,  // a real multiplier passes +1 without a fold: another branch of as many turns crosses
  period_doubling,  // a real multiplier passes -1: a branch of twice as many turns begins
  neimark_sacker,  // a pair of complex multipliers passes the unit circle
};

struct Bifurcation {
  BifurcationKind kind = BifurcationKind::fold;
  double parameter_error = 0;  // estimate, of point.motion.parameter
  BranchPoint point;  // at or, within the error, beside it
  std::size_t after = 0;  // it lies behind this point of the branch
};

enum class BranchEnd {
  range,  // the parameter left its range
  closed,  // the branch came back to its start
  joined,  // it came to a motion of half as many turns, where the same motions half a period later begin
  no_residual,  // the equations end here; see failure
  no_convergence,  // steps below least_step
  points,  // max_points reached
  stopped,
};

struct Branch {
  std::vector<BranchPoint> points;  // along the arc, stops among them
  std::vector<Bifurcation> bifurcations;  // along the arc
  BranchEnd end = BranchEnd::range;
  std::optional<EvaluationFailure> failure;
  int turns = 1;
  long evaluations = 0;  // samples of r
  int factorisations = 0;
};

// From a motion at its parameter in the given direction. Without a motion to start from the branch is empty.
[[nodiscard]] Branch follow_branch(const NonlinearSystem& system, const PeriodicMotion& start,
                                   const ContinuationOptions& options);
// Along the tangent of a point, of this or an earlier branch; options.direction is not used.
[[nodiscard]] Branch follow_branch(const NonlinearSystem& system, const BranchPoint& start,
                                   const ContinuationOptions& options);

// The same point looked at the other way.
[[nodiscard]] BranchPoint reversed(BranchPoint point);

// First points of the branches that begin or cross at a bifurcation, their tangents leading away: of twice as many
// turns at a period doubling (one: the other half is the same motion a turn later), on both sides at a branch point;
// none at folds and Neimark-Sacker points, or where none is found.
[[nodiscard]] std::vector<BranchPoint> branches_at(const NonlinearSystem& system, const Bifurcation& bifurcation,
                                                   const ContinuationOptions& options);

[[nodiscard]] const char* to_string(BifurcationKind kind);
[[nodiscard]] const char* to_string(BranchEnd end);

}  // namespace hb
