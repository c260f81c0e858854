#include "hb/analysis/safety.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

FatigueLine fatigue_line(const Strength& strength) {
  if (!(strength.endurance > 0)) return FatigueLine::none;
  if (strength.tensile > 0) return FatigueLine::goodman;
  return strength.yield > 0 ? FatigueLine::soderberg : FatigueLine::none;
}

const char* to_string(FatigueLine line) {
  switch (line) {
    case FatigueLine::goodman:
      return "Goodman";
    case FatigueLine::soderberg:
      return "Soderberg";
    case FatigueLine::none:
      break;
  }
  return "none";
}

double fatigue_usage(const Strength& strength, double mean, double amplitude) {
  const double most = fatigue_line(strength) == FatigueLine::goodman ? strength.tensile : strength.yield;
  return amplitude / strength.endurance + std::max(mean, 0.0) / most;
}

SafetyFactor safety_factor(double usage, double error) {
  if (!(usage > 0)) return {HUGE_VAL, 0};
  return {1 / usage, usage > error ? 1 / (usage - error) - 1 / usage : HUGE_VAL};
}

}  // namespace hb
