// Long work started from Python: spread over threads without the interpreter's lock, ended by Ctrl-C, telling a
// function how far it is. The answer has the same bits whatever the number of threads.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "hb/analysis/work.hpp"
#include "tools/python/errors.hpp"

namespace hb::python {

class PythonWork : public Work {
 public:
  // `progress`: None, or a function of (what, done, total). Made and used by the calling thread, which holds the lock.
  PythonWork(int num_threads, py::object progress);

  // Both throw Stopped.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task) const override;
  void step(const std::string& what, const Parts& parts) override;

  // True once Ctrl-C was pressed; looks at most every 50 ms, and from the calling thread alone.
  [[nodiscard]] bool stopped() const;

  // Tells `progress` now and then, from the calling thread alone; an exception of it as Stopped.
  void tell(const py::object& progress, const std::string& what, std::size_t done, std::size_t total) const;

  // What `answer` gives, without the lock; an interruption as its Python exception.
  template <class Answer>
  auto run(Answer&& answer) {
    try {
      const py::gil_scoped_release release;
      return answer();
    } catch (...) {
      // Whatever became of Stopped on its way.
      if (!stopped_) throw;
    }
    std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void poll() const;

  int num_threads_;
  py::object progress_;
  std::thread::id caller_ = std::this_thread::get_id();
  mutable std::chrono::steady_clock::time_point last_, told_;
  mutable std::atomic<bool> stopped_ = false;
  mutable std::exception_ptr error_;
  std::string what_;
  std::atomic<std::size_t> done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace hb::python
