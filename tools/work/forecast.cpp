#include "tools/work/forecast.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <utility>

#include "tools/output/speaker.hpp"
#include "tools/work/progress.hpp"

namespace hb::tools {
namespace {

constexpr double worth_saying = 10;  // seconds

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

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void say_memory(const std::string& what, double bytes) {
  constexpr double gigabyte = 1e9;
  const double left = bytes_left();
  if (!(bytes > left)) return;
  fmt::print(stderr, "{}: {} needs about {:.2g} GB of memory, {:.2g} GB are left\n", speaker(), what, bytes / gigabyte,
             left / gigabyte);
}

void say_expected(const std::string& what, double seconds, const std::string& change, bool at_most) {
  if (!(seconds >= worth_saying)) return;
  fmt::print(stderr, "{}: {} takes {} {}; {} change that\n", speaker(), what, at_most ? "at most about" : "about",
             duration(seconds), change);
}

Forecast::Forecast(std::string what, int num_threads, bool at_most, Clock clock)
    : what_(std::move(what)),
      num_threads_(num_threads),
      at_most_(at_most),
      clock_(std::move(clock)),
      start_(clock_()),
      step_start_(start_) {}

void Forecast::begin(std::size_t parts, std::size_t known, const std::string& kind, PartsAhead ahead) {
  const std::lock_guard lock(mutex_);
  end_step();
  kind_ = kind;
  ahead_ = std::move(ahead);
  left_ = parts - std::min(known, parts);
}

// What was spent on parts of no kind tells nothing of others.
void Forecast::end_step() {
  const Spent all = spent_on(kind_);
  if (!kind_.empty()) spent_[kind_] = all;
  done_ = 0;
  step_start_ = clock_();
}

Forecast::Spent Forecast::spent_on(const std::string& kind) const {
  Spent spent;
  if (const auto before = spent_.find(kind); before != spent_.end()) spent = before->second;
  if (kind == kind_ && done_ > 0) {
    spent.seconds += clock_() - step_start_;
    spent.parts += done_;
  }
  return spent;
}

void Forecast::advance(std::size_t parts) {
  const std::lock_guard lock(mutex_);
  done_ += parts;
  left_ -= std::min(left_, parts);
  const double spent = clock_() - start_;
  if (spent < next_look_) return;
  constexpr double interval = 2;  // a factor
  while (spent >= next_look_) next_look_ *= interval;
  look();
}

void Forecast::end_early() {
  const std::lock_guard lock(mutex_);
  if (said_ == 0) look();
}

// all = seconds so far + sum over the kinds that are left of parts times seconds of a part
void Forecast::look() {
  const auto of = [this](const std::string& kind, double parts) {
    const Spent spent = spent_on(kind);
    return spent.parts == 0 ? 0 : parts * spent.seconds / static_cast<double>(spent.parts);
  };
  double left = of(kind_, static_cast<double>(left_));
  for (const auto& [kind, parts] : ahead_) left += of(kind, parts);
  const double all = clock_() - start_ + left;
  constexpr double other = 1.5;
  const bool news = said_ == 0 ? left > 0 && all >= worth_saying : all > other * said_ || all < said_ / other;
  if (!news) return;
  const std::string change = num_threads_ == 0 ? "; --time-limit changes that"
                                               : fmt::format(" ({} {}); --threads and --time-limit change that",
                                                             num_threads_, num_threads_ == 1 ? "thread" : "threads");
  fmt::print(stderr, "{}: {} takes {} {}{}{}\n", speaker(), what_, at_most_ ? "at most" : "about", duration(all),
             said_ > 0 ? ", as later parts show" : "", change);
  said_ = all;
}

}  // namespace hb::tools
