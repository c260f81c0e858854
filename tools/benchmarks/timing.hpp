// Time of a piece of work, and what it ran on.
#pragma once

#include <functional>
#include <string>

namespace hb::benchmarks {

struct Timing {
  double best, median;  // seconds of the processor, of all threads: other programs do not count
};

// At least `fewest` and at most 200 runs, about 0.2 s; no more than 10 s.
[[nodiscard]] Timing timed(const std::function<void()>& run, std::size_t fewest = 3);

// Flops per second of Eigen's C += A B, 512 x 512.
[[nodiscard]] double dgemm_rate();

[[nodiscard]] std::string cpu_model();
[[nodiscard]] std::string eigen_version();

// First line of a CSV file: CPU, compiler, flags, Eigen.
[[nodiscard]] std::string header();

}  // namespace hb::benchmarks
