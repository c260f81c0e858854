// Header of the table: what ran, on what. The rows are registered by the other files of this folder.
#include <benchmark/benchmark.h>

#include "timing.hpp"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("cpu", hb::benchmarks::cpu_model());
  benchmark::AddCustomContext("build", HB_BUILD);
  benchmark::AddCustomContext("eigen", hb::benchmarks::eigen_version());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
