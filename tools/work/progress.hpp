// How long work is, on standard error if that is a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace hb::tools {

// "40 s", "2.5 min", "3.1 h".
[[nodiscard]] std::string duration(double seconds);

// "sweep: 30 of 120 (25 %), 6 s left"; `before` the step others took so many seconds, then what is left is the step's.
[[nodiscard]] std::string progress_line(const std::string& what, std::size_t done, std::size_t total, double seconds,
                                        double before);

class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  // `begun`: the work that this is a step of.
  Progress(std::string what, std::size_t total, Clock::time_point begun = Clock::now());
  ~Progress();  // clears its line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::size_t steps = 1);  // from any thread

 private:
  std::string what_;
  std::size_t total_, done_ = 0;
  bool shown_, dirty_ = false;
  Clock::time_point begun_, start_, last_;
  std::mutex mutex_;
};

}  // namespace hb::tools
