// How far long work is, on standard error if that is a terminal; how long it will take, wherever standard error goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace hb::tools {

class Progress {
 public:
  Progress(std::string what, std::size_t total);
  ~Progress();  // clears its line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::size_t steps = 1);  // from any thread

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  std::size_t total_, done_ = 0;
  bool shown_, dirty_ = false;
  Clock::time_point start_, last_;
  std::mutex mutex_;
};

// Says once on standard error what a step will take, where that is more than ten seconds and it has just begun.
class Forecast {
 public:
  Forecast(std::string what, std::size_t total, int num_threads);
  void advance(std::size_t steps);  // from any thread

 private:
  std::string what_;
  std::size_t total_, done_ = 0;
  int num_threads_;
  bool said_ = false;
  std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
};

}  // namespace hb::tools
