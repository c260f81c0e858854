#include "tools/python/python_work.hpp"

#include "tools/work/parallel_for.hpp"

namespace hb::python {

PythonWork::PythonWork(int num_threads, py::object progress)
    : num_threads_(num_threads), progress_(std::move(progress)), last_(std::chrono::steady_clock::now()) {}

bool PythonWork::stopped() const {
  if (!stopped_ && std::this_thread::get_id() == caller_) poll();
  return stopped_;
}

void PythonWork::poll() const {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(50)) return;
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
  const auto now = std::chrono::steady_clock::now();
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
  if (!tools::parallel_for(count, num_threads_, task, [this] { return stopped(); })) throw Stopped();
}

void PythonWork::step(const std::string& what, const Parts& parts) {
  what_ = what;
  done_ = 0;
  total_ = parts.count;
  for_each(parts.count, [&](std::size_t k) {
    parts.compute(k);
    ++done_;
  });
  total_ = 0;
}

}  // namespace hb::python
