#include "timing.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

namespace hb::benchmarks {

Timing timed(const std::function<void()>& run, std::size_t fewest) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  double sum = 0;
  while (seconds.size() < fewest || (sum < 0.2 && seconds.size() < 200)) {
    const auto start = Clock::now();
    run();
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    sum += seconds.back();
    if (sum > 10) break;
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds.front(), seconds[seconds.size() / 2]};
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
         "; one thread; seconds: smallest and median of repeated runs";
}

}  // namespace hb::benchmarks
