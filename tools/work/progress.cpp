#include "tools/work/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

namespace hb::tools {
namespace {

constexpr std::chrono::milliseconds quiet_start(400), refresh(100);

}  // namespace

std::string duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 600) return fmt::format("{:.1f} min", seconds / 60);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string progress_line(const std::string& what, std::size_t done, std::size_t total, double seconds, double before) {
  constexpr double at_once = 1;
  const double left = seconds * static_cast<double>(total - done) / static_cast<double>(done);
  return fmt::format("{}: {} of {} ({:.0f} %), {} left{}", what, done, total,
                     100.0 * static_cast<double>(done) / static_cast<double>(total), duration(left),
                     before < at_once ? "" : " of this step; " + duration(before + seconds) + " so far");
}

Progress::Progress(std::string what, std::size_t total, Clock::time_point begun)
    : what_(std::move(what)),
      total_(total),
      shown_(isatty(STDERR_FILENO) != 0),
      begun_(begun),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (dirty_) fmt::print(stderr, "\r\033[K");
}

void Progress::advance(std::size_t steps) {
  if (!shown_) return;
  const std::lock_guard lock(mutex_);
  done_ += steps;
  const Clock::time_point now = Clock::now();
  if (now - start_ < quiet_start || now - last_ < refresh || done_ == 0) return;
  last_ = now;
  dirty_ = true;
  const double spent = std::chrono::duration<double>(now - start_).count();
  const double before = std::chrono::duration<double>(start_ - begun_).count();
  fmt::print(stderr, "\r\033[K{}", progress_line(what_, done_, total_, spent, before));
}

}  // namespace hb::tools
