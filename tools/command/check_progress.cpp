#include "tools/command/check_progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>

#include "tools/output/speaker.hpp"

namespace hb::tools {

CheckProgress::CheckProgress(std::size_t num_speeds, int num_threads)
    : num_speeds_(num_speeds), shown_(isatty(STDERR_FILENO) != 0), forecast_("the check", num_threads) {
  forecast_.begin(num_speeds);
}

CheckProgress::~CheckProgress() {
  if (dirty_) fmt::print(stderr, "\r\033[K");
}

void CheckProgress::begin(const std::string& rod, const std::string& speed, Integrator integrator, double seconds) {
  const std::lock_guard lock(mutex_);
  constexpr double worth_saying = 10;
  if (num_speeds_ == 1 && seconds > worth_saying)
    fmt::print(stderr, "{}: {}, integration in time takes about {:.0f} s; --case-limit and --time-limit change that\n",
               speaker(), rod, std::ceil(seconds));
  if (!shown_ || (seconds < 1 && Clock::now() - start_ < std::chrono::milliseconds(400))) return;
  dirty_ = true;
  fmt::print(stderr, "\r\033[K{} of {} speeds done; {} at {}: {}, about {:.0f} s", num_done_, num_speeds_, rod, speed,
             to_string(integrator), std::ceil(seconds));
}

void CheckProgress::end() {
  const std::lock_guard lock(mutex_);
  ++num_done_;
  forecast_.advance();
}

}  // namespace hb::tools
