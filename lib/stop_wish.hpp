// Long work may be wished to end from outside: Ctrl-C, a limit of time. The wish is of the thread that works and not of
// the question that it works on: no answer depends on it, and loops of lib, engine and analyses ask here.
#pragma once

#include <functional>

namespace hb {

// Thrown where the wish has come true: there is no answer.
struct Stopped {};

// While it lives, long work of this thread asks `wished`, which may take a microsecond; the innermost counts.
class StopWish {
 public:
  explicit StopWish(std::function<bool()> wished);
  ~StopWish();
  StopWish(const StopWish&) = delete;
  StopWish& operator=(const StopWish&) = delete;

 private:
  friend bool stop_wished();
  std::function<bool()> wished_;
  const StopWish* outer_;
};

// While it lives, end_if_wished() does nothing in this thread: no exception passes through a library in C.
class StopHeld {
 public:
  StopHeld();
  ~StopHeld();
  StopHeld(const StopHeld&) = delete;
  StopHeld& operator=(const StopHeld&) = delete;
};

[[nodiscard]] bool stop_wished();
// Throws Stopped. Loops call it every few milliseconds.
void end_if_wished();

}  // namespace hb
