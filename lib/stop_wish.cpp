#include "lib/stop_wish.hpp"

#include <utility>

namespace hb {
namespace {

thread_local const StopWish* innermost = nullptr;
thread_local int held = 0;

}  // namespace

StopWish::StopWish(std::function<bool()> wished) : wished_(std::move(wished)), outer_(std::exchange(innermost, this)) {}
StopWish::~StopWish() { innermost = outer_; }

StopHeld::StopHeld() { ++held; }
StopHeld::~StopHeld() { --held; }

bool stop_wished() { return innermost != nullptr && innermost->wished_(); }

void end_if_wished() {
  if (held == 0 && stop_wished()) throw Stopped();
}

}  // namespace hb
