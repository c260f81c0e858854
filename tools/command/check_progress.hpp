// How far a cross-check is, on standard error if that is a terminal; how long it will take, wherever standard error
// goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "hb/engine/time/time_integration.hpp"
#include "tools/work/forecast.hpp"

namespace hb::tools {

// Speeds done, and the integration under way if it takes long. From any thread.
class CheckProgress {
 public:
  CheckProgress(std::size_t num_speeds, int num_threads);
  ~CheckProgress();  // clears its line
  CheckProgress(const CheckProgress&) = delete;
  CheckProgress& operator=(const CheckProgress&) = delete;

  void begin(const std::string& rod, const std::string& speed, Integrator integrator, double seconds);
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  std::size_t num_speeds_, num_done_ = 0;
  bool shown_, dirty_ = false;
  Clock::time_point start_ = Clock::now();
  Forecast forecast_;
  std::mutex mutex_;
};

}  // namespace hb::tools
