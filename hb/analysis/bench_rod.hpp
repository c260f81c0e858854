// Error against run time of the periodic state of one rod, for every method.
#pragma once

#include <string>
#include <vector>

#include "hb/engine/time/shooting.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "tools/work/progress.hpp"

namespace hb::tools {

struct Row {
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
  std::vector<Row> rows;
  std::vector<std::string> notes;  // what was left out, and why
};

struct BenchOptions {
  SteadyMethod method = SteadyMethod::automatic;
  double time_limit = 5;  // seconds for each case
};

// Steps of `progress` that one rod takes, at most.
[[nodiscard]] std::size_t bench_cases();

[[nodiscard]] RodBench bench_rod(const RodModel& rod, const TimeDomainSystem& system, const BenchOptions& options,
                                 Progress& progress);

// Harmonic balance and the fastest integration at equal accuracy, in words.
[[nodiscard]] std::string ratio_sentence(const RodBench& bench, double error);

}  // namespace hb::tools
