#include "tools/python/python_work.hpp"

#include <fmt/core.h>
#include <time.h>

#include "tools/python/arguments.hpp"
#include "tools/work/parallel_for.hpp"

namespace hb::python {
namespace {

std::optional<double> read_time_limit(const py::dict& arguments) {
  const auto limit = given(arguments, "time_limit");
  if (!limit) return std::nullopt;
  const double seconds = number("time_limit", *limit);
  if (!(seconds >= 1e-3 && seconds <= 1e8))
    throw RequestError("time_limit", fmt::format("{}", seconds), "seconds from 0.001 to 1e8");
  return seconds;
}

// Looks come by the hundred in one steady state: the coarse clock of Linux costs a quarter of Clock.
std::int64_t milliseconds() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
  return std::int64_t{1000} * now.tv_sec + now.tv_nsec / 1000000;
}

}  // namespace

PythonWork::PythonWork(const py::dict& arguments, py::object progress)
    : num_threads_(read_threads(arguments)),
      time_limit_(read_time_limit(arguments)),
      progress_(std::move(progress)),
      last_(milliseconds()) {}

PythonWork::PythonWork(int num_threads) : num_threads_(num_threads), progress_(py::none()), last_(milliseconds()) {}

bool PythonWork::stopped() const {
  if (stopped_ || std::this_thread::get_id() != caller_) return stopped_;
  if (to_pass_ > 0)
    --to_pass_;
  else
    poll();
  return stopped_;
}

bool PythonWork::late() const {
  return time_limit_ && std::chrono::duration<double>(Clock::now() - start_).count() > *time_limit_;
}

std::function<bool()> PythonWork::stop() const {
  return [this] { return stopped() || late(); };
}

void PythonWork::say_time_limit(std::vector<std::string>& shortfalls) const {
  if (late()) shortfalls.push_back(fmt::format("ended by time_limit={} before the answer was complete", *time_limit_));
}

void PythonWork::throw_timeout() const {
  PyErr_SetString(PyExc_TimeoutError,
                  fmt::format("the time limit of {:g} s was reached before there was an answer", *time_limit_).c_str());
  throw py::error_already_set();
}

void PythonWork::poll() const {
  const std::int64_t now = milliseconds();
  // Looks within one tick of the clock are many: the next three pass unseen.
  if (std::exchange(last_look_, now) == now) to_pass_ = 3;
  if (now - last_ < 50) return;
  last_ = now;
  const py::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress_.is_none() && total_ > 0) progress_(what_, done_.load(), total_);
  } catch (py::error_already_set&) {
    error_ = std::current_exception();
    stopped_ = true;
  }
}

void PythonWork::tell(const py::object& progress, const std::string& what, std::size_t done, std::size_t total) const {
  const auto now = Clock::now();
  if (now - told_ < std::chrono::milliseconds(50) || std::this_thread::get_id() != caller_) return;
  told_ = now;
  const py::gil_scoped_acquire acquire;
  if (progress.is_none()) return;
  try {
    progress(what, done, total);
  } catch (py::error_already_set&) {
    error_ = std::current_exception();
    stopped_ = true;
  }
  if (stopped_) throw Stopped();
}

void PythonWork::for_each(std::size_t count, const std::function<void(std::size_t)>& task) const {
  const auto wished = [&](std::size_t k) {
    const StopWish wish([this] { return stopped(); });
    task(k);
  };
  if (!tools::parallel_for(count, num_threads_, wished, [this] { return stopped(); })) throw Stopped();
}

void PythonWork::step(const std::string& what, const Parts& parts) {
  what_ = what;
  done_ = 0;
  total_ = parts.count;
  for_each(parts.count, [&](std::size_t k) {
    try {
      const StopWish wish(stop());
      parts.compute(k);
    } catch (const Stopped&) {
      if (stopped()) throw;
      parts.compute(k);  // which says that the time is over
    }
    ++done_;
  });
  total_ = 0;
}

}  // namespace hb::python
