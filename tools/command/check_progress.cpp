#include "tools/command/check_progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>

namespace hb::tools {

CheckProgress::CheckProgress(std::size_t num_speeds) : num_speeds_(num_speeds), shown_(isatty(STDERR_FILENO) != 0) {}

CheckProgress::~CheckProgress() {
  if (dirty_) fmt::print(stderr, "\r\033[K");
}

void CheckProgress::begin(const std::string& rod, const std::string& speed, Integrator integrator, double seconds) {
  const std::lock_guard lock(mutex_);
  if (!shown_ || (seconds < 1 && Clock::now() - start_ < std::chrono::milliseconds(400))) return;
  dirty_ = true;
  fmt::print(stderr, "\r\033[K{} of {} speeds done; {} at {}: {}, about {:.0f} s", num_done_, num_speeds_, rod, speed,
             to_string(integrator), std::ceil(seconds));
}

void CheckProgress::end() {
  const std::lock_guard lock(mutex_);
  ++num_done_;
}

}  // namespace hb::tools
