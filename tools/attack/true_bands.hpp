// Unstable bands along a line from single verdicts alone: a fine grid, points where two exponents come nearest or the
// growth is extreme, and bisection.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "tools/attack/lines.hpp"

namespace hb::attack {

struct TrueBand {
  double from = 0, to = 0;
  double error_from = 0, error_to = 0;  // of the bisection: what is left, or where no verdict is given
  double fastest = 0, fastest_x = 0;  // of the points evaluated, 1/time
  bool open_from = false, open_to = false;  // the line ends inside
};

class SingleVerdicts {
 public:
  SingleVerdicts(const std::function<SystemOnLine(double)>& system, double from, double to);

  void grid(int points);  // and what lies between them
  const Stability& at(double x);
  double speed(double x) const { return system_(x).speed; }
  // Of all points evaluated, the changes of verdict bisected.
  [[nodiscard]] std::vector<TrueBand> bands();
  [[nodiscard]] std::size_t evaluations() const { return known_.size(); }

 private:
  void follow_meetings(double a, double b);
  void follow_growth(double a, double b, bool upward);

  std::function<SystemOnLine(double)> system_;
  double from_, to_;
  std::map<double, Stability> known_;
};

}  // namespace hb::attack
