// The same scene by two paths that share nothing but the kinematics: harmonic balance on Fourier series, and time
// integration of equations taken from the kinematics at the integrator's own times. Differences beside error bars.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/shooting.hpp"
#include "tools/linkage_analysis.hpp"

namespace hb::tools {

struct CheckOptions {
  Integrator integrator = Integrator::automatic;
  double time_limit = 60;  // seconds for each rod and speed
  bool march = false;  // also march from rest where the motion is stable
};

// A difference and what the error bars of both paths allow.
struct Comparison {
  double difference = 0, allowed = 0;
  bool agrees() const { return difference <= allowed; }
};

struct RodCheck {
  std::string name;
  SteadyState steady;
  Stability stability;
  ShootingResult shooting;
  std::optional<MarchingResult> marching;
  bool compared = false;  // false: one path has no result, `agrees` says nothing then
  Comparison q, q1;  // over turn and modes, relative to max |q|, max |q'|
  std::optional<Comparison> deflection;  // of w(x, tau) with the kept modes, relative to max |w|
  Comparison exponents;  // largest distance of the exponents that both paths resolve, 1/time
  std::optional<Comparison> marched;  // q by marching, relative to max |q|
  bool verdicts_agree = false;  // not opposite; undecided contradicts nothing
  bool agrees = false;  // all of the above
  std::vector<std::string> disagreements;  // one sentence each
};

struct JointCheck {
  Comparison forces, torque;  // relative to the largest
  std::string worst;  // joint with the largest difference
};

struct SpeedCheck {
  double speed = 0;  // rad per unit time
  std::vector<RodCheck> rods;
  std::optional<JointCheck> joints;
  double seconds_harmonic_balance = 0, seconds_shooting = 0, seconds_marching = 0;
  std::vector<std::string> shortfalls;  // what missed its tolerance, or could not be compared
  bool agrees() const;
};

// Forces and torque of the Fourier path against one global system per crank angle fed with the shooting path's states;
// links[r] is the body number of rods[r].
[[nodiscard]] JointCheck compare_joints(const Linkage& linkage, const JointForces& series,
                                        const std::vector<RodCheck>& rods, const std::vector<int>& links, double speed);

[[nodiscard]] SpeedCheck cross_check(const SceneModel& model, double speed, const Settings& settings,
                                     const CheckOptions& options);

}  // namespace hb::tools
