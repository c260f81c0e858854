// What Ctrl-C (SIGINT), SIGTERM and SIGHUP do: they end the program with status 130 after what is unfinished is
// removed, or, during long work, raise a flag first. The only file that handles signals.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <filesystem>

namespace hb::tools {

constexpr int exit_interrupted = 130;  // as shells report Ctrl-C

// Once, at the start of the program. SIGHUP that is ignored (nohup) stays so; SIGINT does not, which shells ignore for
// what they run in the background and which is then sent on purpose.
void end_cleanly_on_signals();

// Something on the disk that goes when a signal ends the program while this object lives.
class Unfinished {
 public:
  enum class Kind { tree, empty_folder, file };
  // At most 16 at a time, of paths up to 4095 characters; further ones are left behind by a signal.
  Unfinished(const std::filesystem::path& path, Kind kind);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  int slot_ = -1;
};

// A process group that is killed when a signal ends the program while this object lives.
class RunningChild {
 public:
  explicit RunningChild(pid_t group);
  ~RunningChild();
  RunningChild(const RunningChild&) = delete;
  RunningChild& operator=(const RunningChild&) = delete;
};

// While it lives, no signal comes between: for a few renames that belong together.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

// While it lives, the first Ctrl-C or SIGTERM only raises a flag; the second acts as it would without.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};
[[nodiscard]] bool interrupted();

}  // namespace hb::tools
