// The motion without linearisation by two paths: harmonic balance, and integration of the same equations in time by
// shooting. Differences beside error bars.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/cross_check.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

namespace hb {

struct NonlinearRodCheck {
  std::string name;
  Comparison q, q1;  // over the motion and modes, relative to the rod's max |q|, max |q'|
  bool agrees() const { return q.agrees() && q1.agrees(); }
};

struct NonlinearCheck {
  double speed = 0;  // rad per unit time
  NonlinearResult series;
  ShootingResult shooting;  // all rods together
  std::vector<NonlinearRodCheck> rods;  // those reported; empty if not compared
  // Of the exponents that both paths resolve, the one that uses most of its allowance, 1/time.
  std::optional<Comparison> exponents;
  std::string not_compared;  // why; empty: compared
  double seconds_harmonic_balance = 0, seconds_shooting = 0;
  std::vector<std::string> shortfalls;
  bool opposite_verdicts() const;
  bool agrees() const;  // in everything that could be compared
};

// Exponents for settings.only.stability.
[[nodiscard]] NonlinearCheck nonlinear_check(const SceneModel& model, double speed, const Settings& settings,
                                             const CheckOptions& check, const NonlinearOptions& options = {});

}  // namespace hb
