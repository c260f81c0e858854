// The same scene by two paths that share nothing but the kinematics: harmonic balance on Fourier series, and time
// integration of equations taken from the kinematics at the integrator's own times. Differences beside error bars.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/engine/time/marching.hpp"

namespace hb {

struct CheckOptions {
  Integrator integrator = Integrator::automatic;
  double time_limit = 60;  // seconds for each rod and speed
  bool march = false;  // also march from rest where the motion is stable
  // Told before each integration of a rod, with the seconds it will take.
  std::function<void(const std::string& rod, Integrator, double seconds)> begin = {};
};

// A difference and what the error bars of both paths allow.
struct Comparison {
  std::string what;  // "q / max |q|"
  double difference = 0, allowed = 0;
  bool agrees() const { return difference <= allowed; }
};

struct RodCheck {
  std::string name;
  SteadyState steady;
  std::optional<double> theory_error;  // TheoryErrors::Rod::q
  std::optional<Stability> stability;  // if asked for
  ShootingResult shooting;
  std::optional<MarchingResult> marching;  // if asked for
  std::string not_compared;  // why a path has no result; empty if compared
  bool both_singular = false;  // not compared because neither path finds a unique periodic solution: they agree
  Comparison q, q1;  // over turn and modes, relative to max |q|, max |q'|
  std::optional<Comparison> deflection;  // of w(x, tau) with the kept modes, relative to max |w|
  std::optional<Comparison> marched;  // q by marching, relative to max |q|
  std::optional<Comparison> exponents;  // largest distance of the exponents that both paths resolve, 1/time
  bool compared() const { return not_compared.empty(); }
  std::vector<Comparison> comparisons() const;  // those that were made
  bool opposite_verdicts() const;  // one path says stable, the other unstable; undecided contradicts nothing
  bool agrees() const;  // in everything that could be compared
};

struct JointCheck {
  Comparison forces, torque;  // relative to the largest
  std::string worst;  // joint whose force comes nearest to what is allowed
  bool agrees() const { return forces.agrees() && torque.agrees(); }
};

struct SpeedCheck {
  double speed = 0;  // rad per unit time
  std::vector<RodCheck> rods;
  std::optional<JointCheck> joints;
  // What neither path sees: both compute the linear theory. Of all elastic links, asked for or not, by name; empty for
  // a [hill] scene.
  std::optional<TheoryErrors> theory;
  std::vector<std::string> theory_rods;
  // Of harmonic balance, of all elastic links, asked for or not, by name; empty where stability was not asked for.
  std::vector<std::pair<std::string, std::optional<Verdict>>> verdicts;
  double seconds_harmonic_balance = 0, seconds_shooting = 0, seconds_marching = 0;
  std::vector<std::string> shortfalls;  // what missed its tolerance, or could not be compared
  bool agrees() const;
};

// The comparison that uses most of what it is allowed.
struct WorstComparison {
  double speed = 0;
  std::string where;  // rod, or joint
  Comparison comparison;
};
[[nodiscard]] std::optional<WorstComparison> worst_comparison(const std::vector<SpeedCheck>& checks);

// Forces and torque of the Fourier path against one global system per crank angle fed with the shooting path's states;
// links[r] is the body number of rods[r].
[[nodiscard]] JointCheck compare_joints(const Linkage& linkage, const JointForces& series,
                                        const std::vector<RodCheck>& rods, const std::vector<int>& links, double speed);

// settings.only: q is always compared, exponents for `stability`, joint forces for `reactions`, w for `shape`.
[[nodiscard]] SpeedCheck cross_check(const SceneModel& model, double speed, const Settings& settings,
                                     const CheckOptions& options);

}  // namespace hb
