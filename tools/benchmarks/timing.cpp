#include "timing.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <ctime>
#include <fstream>
#include <vector>

namespace hb::benchmarks {

namespace {

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Timing timed(const std::function<void()>& run, std::size_t fewest) {
  std::vector<double> seconds;
  double sum = 0;
  int at_once = 1;
  while (seconds.size() < fewest || (sum < 0.2 && seconds.size() < 200)) {
    const double start = processor_seconds();
    for (int k = 0; k < at_once; ++k) run();
    const double all = processor_seconds() - start;
    sum += all;
    // The clock's own half microsecond is not to count: short runs are timed together.
    const bool first = at_once == 1 && all < 2e-5;
    if (first) at_once = static_cast<int>(std::clamp(5e-5 / all, 2.0, 100.0));
    if (!first) seconds.push_back(all / at_once);
    if (sum > 10 && !seconds.empty()) break;
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds.front(), seconds[seconds.size() / 2]};
}

double dgemm_rate() {
  constexpr Eigen::Index n = 512;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n), B = Eigen::MatrixXd::Random(n, n);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  const Timing timing = timed([&] { C.noalias() += A * B; });
  return 2.0 * n * n * n / timing.best;
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string eigen_version() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION) + ", " + Eigen::SimdInstructionSetsInUse();
}

std::string header() {
  return "# CPU " + cpu_model() + "; " + HB_BUILD + "; Eigen " + eigen_version() +
         "; one thread; seconds: of the processor, smallest and median of repeated runs";
}

}  // namespace hb::benchmarks
