// Error against run time of the periodic state of one rod, for every method.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/engine/time/shooting.hpp"

namespace hb {

struct BenchRow {
  std::string rod, method;
  double asked = 0;  // tolerance; 0: none
  long size = 0;  // harmonics, or steps
  double error = 0;  // max |q - reference| / max |reference|
  double seconds = 0, median_seconds = 0;
  bool harmonic_balance = false;
};

struct RodBench {
  std::string name;
  Integrator reference = Integrator::collocation;
  double reference_error = 0;
  Verdict verdict = Verdict::undecided;
  std::vector<BenchRow> rows;
  std::vector<std::string> notes;  // what was left out, and why
};

struct BenchOptions {
  SteadyMethod method = SteadyMethod::automatic;
  double time_limit = 5;  // seconds for each case
  std::function<void()> done = [] {};  // told after each case
};

// Cases of one rod, at most.
[[nodiscard]] std::size_t bench_cases();

[[nodiscard]] RodBench bench_rod(const RodModel& rod, const TimeDomainSystem& system, const BenchOptions& options);

// Harmonic balance and the fastest integration at equal accuracy, in words.
[[nodiscard]] std::string ratio_sentence(const RodBench& bench, double error);

}  // namespace hb
