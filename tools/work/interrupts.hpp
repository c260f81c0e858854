// What Ctrl-C (SIGINT), SIGTERM and SIGHUP do: they end the program with status 130 after what is unfinished is
// removed, or, during long work, raise a flag first. The only file that handles signals.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <string>

namespace hb::tools {

constexpr int exit_interrupted = 130;  // as shells report Ctrl-C

// Once, at the start of the program. SIGHUP that is ignored (nohup) stays so; SIGINT does not, which shells ignore for
// what they run in the background and which is then sent on purpose.
void end_cleanly_on_signals();

// After `seconds` long work under an InterruptGuard is asked to end; what is not over five seconds later, and other
// work a second later, ends the program with `status`, `message` on standard error and `document` on standard output.
// Once at most.
void end_after(double seconds, int status, const std::string& message, const std::string& document);
[[nodiscard]] bool time_is_up();

// From the complete answer on. Files are put in their place and printed whatever the time; pictures that are not drawn
// when it is up are given up with `status`.
void begin_delivery();
void begin_pictures(int status);

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

// While it lives, the first Ctrl-C or SIGTERM, and the end of the time, only raise a flag. The second signal acts as it
// would without, and so does the first one where the work has not ended five seconds later.
class InterruptGuard {
 public:
  // Without `signals` it is about the time alone.
  explicit InterruptGuard(bool signals = true);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};
[[nodiscard]] bool interrupted();
// Either of both.
[[nodiscard]] bool asked_to_end();

}  // namespace hb::tools
