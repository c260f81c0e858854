#include "tools/work/progress.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace hb::tools {
namespace {

constexpr std::chrono::milliseconds quiet_start(400), refresh(100);

std::string duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A forecast by the first parts, and one by which parts of every kind have been seen, after so many seconds.
constexpr double looks[] = {1, 5}, worth_saying = 10;

}  // namespace

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

namespace {

// Of a file of /proc the number behind a word; infinite where there is none.
double number_behind(const char* file, const std::string& word) {
  std::ifstream lines(file);
  for (std::string name; lines >> name;) {
    double value = 0;
    if (name == word && lines >> value) return value;
  }
  return HUGE_VAL;
}

double bytes_left() {
  constexpr double kilobyte = 1024;
  double left = kilobyte * number_behind("/proc/meminfo", "MemAvailable:");
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    const double held = kilobyte * number_behind("/proc/self/status", "VmSize:");
    left = std::min(left, static_cast<double>(limit.rlim_cur) - (std::isfinite(held) ? held : 0));
  }
  return std::max(left, 0.0);
}

}  // namespace

void say_memory(const std::string& what, double bytes) {
  constexpr double gigabyte = 1e9;
  const double left = bytes_left();
  if (!(bytes > left)) return;
  fmt::print(stderr, "hb: {} needs about {:.2g} GB of memory, {:.2g} GB are left\n", what, bytes / gigabyte,
             left / gigabyte);
}

void say_expected(const std::string& what, double seconds, const std::string& change, bool at_most) {
  if (!(seconds >= worth_saying)) return;
  fmt::print(stderr, "hb: {} takes {} {}; {} change that\n", what, at_most ? "at most about" : "about",
             duration(seconds), change);
}

Forecast::Forecast(std::string what, std::size_t total, int num_threads, bool at_most)
    : what_(std::move(what)),
      total_(total),
      num_threads_(num_threads),
      at_most_(at_most),
      start_(std::chrono::steady_clock::now()) {}

void Forecast::advance(std::size_t steps) {
  const std::lock_guard lock(mutex_);
  done_ += steps;
  if (looks_ == std::size(looks)) return;
  const double spent = seconds_since(start_);
  if (spent < looks[looks_]) return;
  while (looks_ < std::size(looks) && spent >= looks[looks_]) ++looks_;
  look(spent);
}

void Forecast::end_early() {
  const std::lock_guard lock(mutex_);
  if (said_ == 0) look(seconds_since(start_));
}

void Forecast::look(double spent) {
  if (done_ == 0 || done_ >= total_) return;
  const double all = spent * static_cast<double>(total_) / static_cast<double>(done_);
  const bool news = said_ == 0 ? all >= worth_saying : all > 2 * said_ || all < said_ / 2;
  if (!news) return;
  fmt::print(stderr, "hb: {} takes {} {}{} ({} parts, {} {}); --threads and --time-limit change that\n", what_,
             at_most_ ? "at most" : "about", duration(all), said_ > 0 ? ", as later parts show" : "", total_,
             num_threads_, num_threads_ == 1 ? "thread" : "threads");
  said_ = all;
}

}  // namespace hb::tools
