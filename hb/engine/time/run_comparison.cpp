#include "hb/engine/time/run_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

namespace {

// Distance of exponents (times a turn) whose imaginary parts count modulo 2 pi.
double folded_distance(std::complex<double> a, std::complex<double> b) {
  return std::hypot(a.real() - b.real(), std::remainder(a.imag() - b.imag(), two_pi));
}

// Exponents on which two accuracies disagree grossly are those of modes that were not resolved. Their growth, which
// comes before their phase, is compared rank by rank; of one that dies within a segment only that is known.
void drop_unresolved(const ComparedRuns& runs, ShootingResult& result) {
  const double Omega = runs.speed;
  const auto resolved = [&](const Exponent& e) { return e.error <= 1e-3 * (Omega + std::abs(e.value.real())); };
  while (result.exponents.size() > 1 && !resolved(result.exponents.back())) {
    const std::size_t rank = result.exponents.size() - 1;
    const LogMultiplier& last = runs.fine.values[rank];
    const double other = rank < runs.coarse->values.size() ? runs.coarse->values[rank].value.real() : last.value.real();
    const double slower = std::max(last.value.real(), other);
    const bool dies = slower < -2.0 * runs.num_segments;
    const double growth = dies ? slower / 2
                               : last.value.real() + difference_factor * std::abs(last.value.real() - other) +
                                     runs.map_error * last.amplification;
    result.complete_above = std::max(result.complete_above, growth * Omega / two_pi);
    result.exponents.pop_back();
    result.some_below = true;
  }
}

}  // namespace

std::vector<Exponent> exponents_of(const ComparedRuns& runs) {
  std::vector<Exponent> exponents;
  for (const auto& [log_mu, amplification] : runs.fine.values) {
    double error = 0;
    if (runs.coarse != nullptr) {
      error = INFINITY;
      for (const LogMultiplier& other : runs.coarse->values)
        error = std::min(error, difference_factor * folded_distance(log_mu, other.value));
      error += runs.map_error * amplification + 1e-14 * std::max(1.0, std::abs(log_mu.real())) +
               1e-16 * static_cast<double>(runs.steps);
    }
    exponents.push_back({log_mu * runs.speed / two_pi, error * runs.speed / two_pi});
  }
  return exponents;
}

bool judge_exponents(const ComparedRuns& runs, ShootingResult& result) {
  result.exponents = exponents_of(runs);
  result.some_below = runs.fine.some_below;
  if (result.some_below && !result.exponents.empty()) result.complete_above = result.exponents.back().value.real();
  if (runs.coarse != nullptr) drop_unresolved(runs, result);
  if (result.exponents.empty()) {
    result.status = ShootingStatus::not_reached;
    result.message = "every mode decays below the integrator's noise within a segment";
    result.growth_error = INFINITY;
    return false;
  }
  result.growth_rate = result.exponents.front().value.real();
  result.growth_error = result.exponents.front().error;
  for (const Exponent& e : result.exponents)
    if (e.value.real() + e.error > result.growth_rate)
      result.growth_error = std::max(result.growth_error, e.value.real() + e.error - result.growth_rate);
  // One that was not resolved may be the leading one.
  if (result.complete_above > result.growth_rate)
    result.growth_error = std::max(result.growth_error, result.complete_above - result.growth_rate);
  result.verdict = result.growth_rate - result.growth_error > 0   ? Verdict::unstable
                   : result.growth_rate + result.growth_error < 0 ? Verdict::stable
                                                                  : Verdict::undecided;
  return true;
}

}  // namespace hb
