// How far long work is, on standard error if that is a terminal; how long it will take, wherever standard error goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace hb::tools {

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

// Says on standard error what a step will take, where that is more than ten seconds: by its first parts, and once more
// where later ones show that it takes twice or half as long. Of a step that ends early, what it would have taken.
class Forecast {
 public:
  // `at_most`: the step may end before all parts.
  Forecast(std::string what, std::size_t total, int num_threads, bool at_most = false);
  void advance(std::size_t steps = 1);  // from any thread
  void end_early();  // where nothing was said: by the parts so far

 private:
  void look(double spent);

  std::string what_;
  std::size_t total_, done_ = 0;
  int num_threads_;
  bool at_most_;
  std::size_t looks_ = 0;
  double said_ = 0;  // seconds; 0: nothing
  std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
};

// Says so where something will take more than ten seconds; `change`: the flags that change that.
void say_expected(const std::string& what, double seconds, const std::string& change, bool at_most = false);

// Says so where something will hold more bytes than the machine, or a limit on this process, has left.
void say_memory(const std::string& what, double bytes);

}  // namespace hb::tools
