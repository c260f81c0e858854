// Floquet exponents with error bars and a verdict. Methods differ, the result does not.
#pragma once

#include <cmath>
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "hb/engine/exponents/slaving.hpp"
#include "hb/engine/exponents/verdict.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "lib/hill_system.hpp"

namespace hb {

enum class StabilityMethod {
  automatic,
  hill,  // each exponent by Hill iteration in a window centred on its mode
  slaving,  // fast modes slaved to the slow ones exactly; the slow ones propagated over a turn
  propagation,  // the whole system propagated by Radau IIA
  bound,  // no exponent: closed-form bounds on the growth rate, which prove stability where damping dominates
  determinant,  // zeros of Hill's determinant near the leading exponent, their number checked by its winding
};

struct StabilityOptions {
  double tolerance = 1e-9;  // wanted error of the growth rate, relative to max(|growth|, Omega)
  StabilityMethod method = StabilityMethod::automatic;
  // Growth rate and verdict only: exponents that a bound shows to lie below the leading ones are not computed.
  bool leading_only = false;
  // The verdict alone: where closed-form bounds prove stability, growth_rate is the upper one of them.
  bool verdict_only = false;
  // A growth rate within the tolerance is enough, also where its error leaves the verdict open.
  bool growth_suffices = false;
  // With leading_only: the leading exponents with the error that they come with, however large; no second method.
  bool as_found = false;
  // Of all exponents those of the first method that accounts for them, with the error that they come with.
  bool one_method = false;
  // With leading_only: modes to keep together at the first try, as a neighbouring point's result says in `kept`.
  std::vector<int> keep = {};
  // Where all exponents are looked for: what slaving came to in a neighbouring system, Stability::solved.
  std::span<const SlavingStart> starts = {};
  bool keeps_solved = false;
};

// One Floquet exponent lambda: solutions e^{lambda t} p(t), p of period 2 pi/Omega.
struct Exponent {
  std::complex<double> value;  // 1/time; imaginary part folded to (-Omega/2, Omega/2]
  double error = 0;  // of |value|, see Stability
  // Which mode it belongs to (index of the scaled coordinates, ascending mean frequency for rods): the mode that the
  // others were slaved to; inside a group of strongly coupled modes the nearest in frequency and damping.
  int mode = 0;
  // Frequency unfolded, >= 0: |Im lambda + k Omega| with the harmonic k that carries the motion.
  double frequency = 0;

  // e^{lambda 2 pi/Omega}: what a turn at the speed Omega does to the disturbance.
  [[nodiscard]] std::complex<double> multiplier(double speed) const;
};

// Errors of exponents are bounds, in floating-point arithmetic, only where coefficients are constant and for Mathieu's
// equation by Hill's determinant. All others are a-posteriori estimates, larger than what they estimate by a margin
// that tests/engine/stress_stability.cpp and tools/attack put to the test; each is derived in hb/engine/README.md.
struct Stability {
  std::vector<Exponent> exponents;  // real part descending, then imaginary part ascending; those resolved (up to 2I)
  std::vector<Exponent> uncertain;  // the others that were found, their bars beyond 1e-6 of themselves or of Omega
  double growth_rate = 0;  // max Re lambda, 1/time; of bounds the upper one, infinite where there is none
  double growth_error = 0;  // the larger of growth_high - growth_rate and growth_rate - growth_low; may be infinite
  double growth_low = 0, growth_high = 0;  // the growth rate lies between them: what the verdict rests on
  // Upper bound on Re lambda of exponents that are in neither list; infinite: unknown which there are.
  double others_below = HUGE_VAL;
  Verdict verdict = Verdict::undecided;
  bool converged = false;  // growth_error within what was asked; for bounds: they decide
  StabilityMethod method = StabilityMethod::automatic;  // the one that gave the growth rate
  std::vector<int> kept;  // modes that the leading exponents were found with, the others slaved to them
  std::string evidence;  // one sentence: what was done
  std::vector<SlavingStart> solved = {};  // what slaving came to, if it was to be kept
};

[[nodiscard]] Stability analyse_stability(const HillSystem& system, double speed, const StabilityOptions& options = {});
[[nodiscard]] Stability analyse_stability(const ScaledSystem& system, const StabilityOptions& options = {});

[[nodiscard]] const char* to_string(StabilityMethod method);

}  // namespace hb
