// The motion that the mechanism really makes at one speed: periodic motion of the exact model (lib/exact), all rods
// together, with its stability, joint forces and errors; section "Motion without linearisation" of
// hb/analysis/README.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/nonlinear/rod_peaks.hpp"
#include "hb/analysis/slider_motion.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"

namespace hb {

struct NonlinearOptions {
  int turns = 1;  // T: motions of period 2 pi T/Omega
  std::function<bool()> stop = {};  // true ends the work with what is there
  double least_cut = 2e-8;  // with automatic modes: the error of the cut wanted, where the tolerance is below this
};

struct NonlinearRod {
  std::string name;
  int link = -1;
  bool reported = true;
  FourierSeries q = {};  // harmonic k is k Omega/T
  std::vector<Extremum> max_abs = {};  // of each q_i; crank angles over the T turns
  double error_bound = 0;  // estimate of max |error of q_i| / max |q_i|, for the number of modes kept
  std::optional<CutError> cut = std::nullopt;  // the motion once more with more modes
  std::optional<PeakErrors> peak_errors = std::nullopt;  // of the shape, beside `cut`
  std::optional<RodShape> shape = std::nullopt;  // the moment EJ kappa, kappa = w''/cos psi
  std::optional<RodStress> stress = std::nullopt;  // beside it, with the axial force along the bent rod
  std::optional<StressCycle> cycle =
      std::nullopt;  // with a section; its error infinite where no better motion is known
  std::optional<StressEnvelope> envelope = std::nullopt;  // beside it
};

// Another motion of as many turns at the same speed.
struct OtherMotion {
  RodPeaks max_abs;  // by rod and mode
  std::optional<Verdict> verdict;
};

// Estimates of the errors of shaking force (its length) and moment, in their units.
struct FrameErrors {
  double force = 0, moment = 0;
};

enum class MotionSearch {
  found,
  none,  // no motion; see `why`, and last_speed if the branch was followed
  stopped,
};

struct NonlinearResult {
  double speed = 0;  // rad per unit time
  int turns = 1;
  double tolerance = 0;  // that the motion was solved to: the one asked for, at least 1e-9
  // With modes = "auto": what cut->deflection was to come below, the tolerance asked for, at least 2e-8.
  std::optional<double> cut_tolerance;
  Only computed;
  MotionSearch search = MotionSearch::none;
  std::string why;  // no motion: in words
  // No motion: the last one on the way, its speed and largest |q_i| by rod and mode.
  std::optional<double> last_speed;
  std::vector<std::vector<double>> last_max_abs;
  // By continuation from this speed, weakly bent; empty: the linear theory holds at all lower speeds that were looked
  // at, and Newton's method started from its answer.
  std::optional<double> followed_from;
  int folds = 0;  // passed on the way
  PeriodicMotion motion;  // of all rods
  std::vector<NonlinearRod> rods;
  std::optional<Stability> stability;  // of all rods together
  std::optional<JointForces> forces;
  std::optional<ForceErrors> force_errors;
  std::optional<FrameErrors> frame_errors;
  std::vector<SliderMotion> sliders;  // of the bent mechanism; beside the forces
  std::vector<OtherMotion> others;
  std::vector<std::string> shortfalls;
  std::vector<Stage> stages;
};

// Throws RequestError for what the theory does not know: a [hill] scene, one without elastic links or with shear, and a
// number of turns that is no power of two.
void require_nonlinear(const SceneModel& model, int turns);

// The branch followed in speed from the weakly bent motion at low speed, at its first passage of this speed; of T > 1
// turns the first motion found on a branch that leaves it by period doubling. With modes = "auto" each rod has as many
// as the error of the cut takes. Throws RequestError as require_nonlinear does.
[[nodiscard]] NonlinearResult nonlinear_steady(const SceneModel& model, double speed, const Settings& settings,
                                               const NonlinearOptions& options = {});

// A motion that is known already, solved to `tolerance` at its speed, as such an answer; other motions, which take
// further searches, are left out. `stop`: as of NonlinearOptions; without the motion with more modes errors of the cut
// are missing.
[[nodiscard]] NonlinearResult nonlinear_answer(const SceneModel& model, const PeriodicMotion& motion,
                                               const std::optional<Stability>& stability, double tolerance,
                                               const Settings& settings, const std::function<bool()>& stop = {});

}  // namespace hb
