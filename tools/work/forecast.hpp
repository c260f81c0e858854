// How long work will take and what it will hold, said on standard error before it is done.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "hb/engine/boundaries/part.hpp"

namespace hb::tools {

[[nodiscard]] double steady_seconds();

// Says what work of one or several steps takes, where that is more than ten seconds: after a second by the parts that
// are done, and again at growing intervals where later ones show that it takes half as long again or two thirds. Parts
// of one kind are taken to take alike, whichever step they belong to; of kinds that were not seen yet nothing is known.
// Of work that ends early it says what it would have taken.
class Forecast {
 public:
  // Seconds since some moment.
  using Clock = std::function<double()>;

  // `what`: the work in words; num_threads 0: one, however many there are; `at_most`: it may end before all parts.
  Forecast(std::string what, int num_threads, bool at_most = false, Clock clock = steady_seconds);
  // A step of so many parts, of which `known` take no time.
  void begin(std::size_t parts, std::size_t known = 0, const std::string& kind = {}, PartsAhead ahead = {});
  void advance(std::size_t parts = 1);  // of the step; from any thread
  void end_early();  // where nothing was said: by the parts so far

 private:
  struct Spent {
    double seconds = 0;
    std::size_t parts = 0;
  };
  void end_step();
  [[nodiscard]] Spent spent_on(const std::string& kind) const;
  void look();

  std::string what_;
  int num_threads_;
  bool at_most_;
  std::size_t left_ = 0, done_ = 0;  // of the step
  std::string kind_;
  PartsAhead ahead_;
  std::map<std::string, Spent> spent_;  // in steps before
  double next_look_ = 1, said_ = 0;  // seconds; said_ 0: nothing
  Clock clock_;
  double start_, step_start_;
  std::mutex mutex_;
};

// Says so where something will take more than ten seconds; `change`: the flags that change that.
void say_expected(const std::string& what, double seconds, const std::string& change, bool at_most = false);

// Says so where something will hold more bytes than the machine, or a limit on this process, has left.
void say_memory(const std::string& what, double bytes);

}  // namespace hb::tools
