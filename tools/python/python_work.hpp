// Work started from Python: spread over threads without the interpreter's lock, ended by Ctrl-C or by a time limit,
// telling a function how far it is. The answer has the same bits whatever the number of threads.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hb/analysis/work.hpp"
#include "lib/stop_wish.hpp"
#include "tools/python/errors.hpp"

namespace hb::python {

class PythonWork : public Work {
 public:
  // `arguments`: threads, time_limit (seconds from now). `progress`: None, or a function of (what, done, total). Made
  // and used by the calling thread, which holds the lock.
  PythonWork(const py::dict& arguments, py::object progress);
  explicit PythonWork(int num_threads = 1);

  // Both throw Stopped at Ctrl-C. A part of a step that the time limit finds under way is given up.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task) const override;
  void step(const std::string& what, const Parts& parts) override;
  [[nodiscard]] bool ends_early() const override { return late(); }

  // True once Ctrl-C was pressed; looks at most every 50 ms, and from the calling thread alone.
  [[nodiscard]] bool stopped() const;
  // True once the time limit has passed.
  [[nodiscard]] bool late() const;
  // Either, for work that then ends with what is there, and says that it was the time.
  [[nodiscard]] std::function<bool()> stop() const;
  void say_time_limit(std::vector<std::string>& shortfalls) const;

  // Tells `progress` now and then, from the calling thread alone; an exception of it as Stopped.
  void tell(const py::object& progress, const std::string& what, std::size_t done, std::size_t total) const;

  // What `answer` gives, without the lock; an interruption as its Python exception, a TimeoutError where the time limit
  // ends what is no step. `whole`: where it ends anything, as there is no answer in part.
  template <class Answer>
  auto run(Answer&& answer, bool whole = false) {
    try {
      const StopWish wish([this, whole] { return stopped() || (whole && late()); });
      const py::gil_scoped_release release;
      return answer();
    } catch (const Stopped&) {
      if (!stopped_) throw_timeout();
    } catch (...) {
      // Whatever became of Stopped on its way.
      if (!stopped_) throw;
    }
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
  // TimeoutError: there was no answer in time.
  [[noreturn]] void throw_timeout() const;

 private:
  using Clock = std::chrono::steady_clock;
  void poll() const;

  int num_threads_;
  std::optional<double> time_limit_;
  Clock::time_point start_ = Clock::now();
  py::object progress_;
  std::thread::id caller_ = std::this_thread::get_id();
  mutable std::int64_t last_, last_look_ = 0;  // at signals, and at the clock; in milliseconds
  mutable int to_pass_ = 0;
  mutable Clock::time_point told_;
  mutable std::atomic<bool> stopped_ = false;
  mutable std::exception_ptr error_;
  std::string what_;
  std::atomic<std::size_t> done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace hb::python
