#include "tools/work/interrupts.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <iterator>

namespace hb::tools {
namespace {

constexpr int signals[] = {SIGINT, SIGTERM, SIGHUP};

struct Slot {
  std::atomic<int> state = 0;  // 0 free, 1 being filled, 2 + kind
  char path[4096];
};
Slot slots[16];
std::atomic<pid_t> child_group = 0;
static_assert(std::atomic<int>::is_always_lock_free);

volatile std::sig_atomic_t interrupt_seen = 0;
struct sigaction before_guard[2];  // of SIGINT and SIGTERM

// Only calls that a signal handler may make.
void remove_tree(const char* path) {
  const pid_t child = _Fork();
  if (child == 0) {
    execl("/bin/rm", "rm", "-rf", "--", path, nullptr);
    _exit(1);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

void remove_unfinished_and_end(int) {
  if (const pid_t group = child_group; group > 0 && kill(-group, SIGKILL) == 0) waitpid(group, nullptr, 0);
  for (Slot& slot : slots) {
    const int state = slot.state;
    if (state == 2 + static_cast<int>(Unfinished::Kind::tree)) remove_tree(slot.path);
  }
  // Parents are registered innermost last, after which nothing is in them.
  for (int s = std::size(slots) - 1; s >= 0; --s) {
    const int state = slots[s].state;
    if (state == 2 + static_cast<int>(Unfinished::Kind::empty_folder)) rmdir(slots[s].path);
    if (state == 2 + static_cast<int>(Unfinished::Kind::file)) unlink(slots[s].path);
  }
  _exit(exit_interrupted);
}

void raise_flag(int signal) {
  interrupt_seen = 1;
  sigaction(signal, &before_guard[signal == SIGINT ? 0 : 1], nullptr);
}

struct sigaction action(void (*handler)(int)) {
  struct sigaction result {};
  result.sa_handler = handler;
  sigemptyset(&result.sa_mask);
  for (const int signal : signals) sigaddset(&result.sa_mask, signal);
  result.sa_flags = SA_RESTART;
  return result;
}

}  // namespace

void end_cleanly_on_signals() {
  const struct sigaction ending = action(remove_unfinished_and_end);
  for (const int signal : signals) {
    struct sigaction now {};
    const bool ignored = sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
    if (signal != SIGHUP || !ignored) sigaction(signal, &ending, nullptr);
  }
}

Unfinished::Unfinished(const std::filesystem::path& path, Kind kind) {
  const std::string text = std::filesystem::absolute(path).string();
  if (text.size() >= sizeof slots[0].path) return;
  for (int s = 0; s < static_cast<int>(std::size(slots)); ++s) {
    int free = 0;
    if (!slots[s].state.compare_exchange_strong(free, 1)) continue;
    std::strcpy(slots[s].path, text.c_str());
    slots[s].state = 2 + static_cast<int>(kind);
    slot_ = s;
    return;
  }
}

Unfinished::~Unfinished() {
  if (slot_ >= 0) slots[slot_].state = 0;
}

RunningChild::RunningChild(pid_t group) { child_group = group; }
RunningChild::~RunningChild() { child_group = 0; }

SignalsHeld::SignalsHeld() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : signals) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

InterruptGuard::InterruptGuard() {
  interrupt_seen = 0;
  const struct sigaction flag = action(raise_flag);
  sigaction(SIGINT, &flag, &before_guard[0]);
  sigaction(SIGTERM, &flag, &before_guard[1]);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &before_guard[0], nullptr);
  sigaction(SIGTERM, &before_guard[1], nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace hb::tools
