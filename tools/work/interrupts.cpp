#include "tools/work/interrupts.hpp"

#include <sys/time.h>
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
  char path[4096] = {};
};
constinit Slot slots[16];  // no page of it is touched before it is needed
std::atomic<pid_t> child_group = 0;
static_assert(std::atomic<int>::is_always_lock_free);

enum Phase { computing, guarded, delivering, drawing };

volatile std::sig_atomic_t interrupt_seen = 0, time_up = 0, phase = computing;
volatile std::sig_atomic_t status_at_end = exit_interrupted;
std::string time_message, time_document;  // read by a signal handler, not changed once the timer runs
constexpr unsigned grace = 5, short_grace = 1;  // seconds in which work, asked to end or not, may end by itself
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

void write_message(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(descriptor, text.data() + done, text.size() - done);
    if (written <= 0) return;
    done += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void remove_unfinished_and_exit(int status) {
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
  _exit(status);
}

void remove_unfinished_and_end(int) { remove_unfinished_and_exit(exit_interrupted); }

// The time limit, or the end of the grace that long work was given.
void on_alarm(int) {
  if (phase == delivering || (phase != drawing && interrupt_seen == 0 && time_up == 0)) {
    time_up = 1;
    alarm(phase == computing ? short_grace : grace);
    return;
  }
  if (interrupt_seen != 0) remove_unfinished_and_exit(exit_interrupted);
  if (phase != drawing) {
    write_message(STDERR_FILENO, time_message);
    write_message(STDOUT_FILENO, time_document);
  }
  remove_unfinished_and_exit(status_at_end);
}

void raise_flag(int signal) {
  interrupt_seen = 1;
  alarm(grace);
  sigaction(signal, &before_guard[signal == SIGINT ? 0 : 1], nullptr);
}

struct sigaction action(void (*handler)(int)) {
  struct sigaction result {};
  result.sa_handler = handler;
  sigemptyset(&result.sa_mask);
  for (const int signal : signals) sigaddset(&result.sa_mask, signal);
  sigaddset(&result.sa_mask, SIGALRM);
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
  const struct sigaction alarmed = action(on_alarm);
  sigaction(SIGALRM, &alarmed, nullptr);
}

void end_after(double seconds, int status, const std::string& message, const std::string& document) {
  time_message = message;
  time_document = document;
  status_at_end = status;
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - static_cast<double>(timer.it_value.tv_sec)));
  setitimer(ITIMER_REAL, &timer, nullptr);
}

bool time_is_up() { return time_up != 0; }

void begin_delivery() { phase = delivering; }

void begin_pictures(int status) {
  status_at_end = status;
  phase = drawing;
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
  sigaddset(&held, SIGALRM);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

InterruptGuard::InterruptGuard(bool signals) {
  phase = guarded;
  if (!signals) {
    sigaction(SIGINT, nullptr, &before_guard[0]);
    sigaction(SIGTERM, nullptr, &before_guard[1]);
    return;
  }
  const struct sigaction flag = action(raise_flag);
  sigaction(SIGINT, &flag, &before_guard[0]);
  sigaction(SIGTERM, &flag, &before_guard[1]);
}

InterruptGuard::~InterruptGuard() {
  phase = computing;
  if (asked_to_end()) alarm(0);  // it ended by itself
  sigaction(SIGINT, &before_guard[0], nullptr);
  sigaction(SIGTERM, &before_guard[1], nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

bool asked_to_end() { return interrupted() || time_is_up(); }

}  // namespace hb::tools
