#include "tools/work/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace hb::tools {

bool parallel_for(std::size_t count, int num_threads, const std::function<void(std::size_t)>& work,
                  const std::function<bool()>& stop) {
  if (num_threads <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) {
      if (stop && stop()) return false;
      work(i);
    }
    return true;
  }
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> ended = false, stopped = false;
  std::mutex mutex;
  std::exception_ptr error;
  std::size_t error_index = count;
  const auto run = [&] {
    while (!ended) {
      if (stop && stop()) {
        stopped = ended = true;
        return;
      }
      const std::size_t i = next++;
      if (i >= count) return;
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i < error_index) {
          error_index = i;
          error = std::current_exception();
        }
        ended = true;
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(num_threads), count) - 1;
    threads.reserve(helpers);
    try {
      for (std::size_t t = 0; t < helpers; ++t) threads.emplace_back(run);
    } catch (const std::system_error&) {  // no more threads to be had: those that are there do it
    }
    run();
  }
  if (error) std::rethrow_exception(error);
  return !stopped;
}

}  // namespace hb::tools
