// The two exponents that give the growth rate where they are a pair: conjugates, or real multipliers of one sign. What
// is analytic along a parameter, also where the two meet: hb/engine/README.md (B11).
#pragma once

#include <optional>

#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

struct LeadingPair {
  double mean = 0;  // (Re s_1 + Re s_2)/2, per radian of crank angle
  double half_trace = 0;  // cosh pi (s_1 - s_2): beyond +-1 the two are locked, to multipliers of that sign
  double mean_error = 0, half_trace_error = 0;
  double lower = 0;  // Re s of the one that decays faster
  double others = 0;  // upper bound on Re s of all other exponents
};

// The leading exponent and the slowest of those that may be its partner. Empty if there is none, or if it is not known
// which exponents there are.
[[nodiscard]] std::optional<LeadingPair> leading_pair(const StabilitySample& sample);

// The leading exponent alone, where its multiplier is real: both exponents of the pair are that one.
[[nodiscard]] std::optional<LeadingPair> leading_alone(const StabilitySample& sample);

// Sign of the leading multiplier if it is real, else 0.
[[nodiscard]] double lock_of(const StabilitySample& sample);

}  // namespace hb
