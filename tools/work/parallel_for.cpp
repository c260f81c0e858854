#include "tools/work/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
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
    std::size_t at_work = 0;
    std::condition_variable one_less;
    const auto help = [&] {
      run();
      const std::lock_guard lock(mutex);
      --at_work;
      one_less.notify_one();
    };
    std::vector<std::jthread> threads;
    const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(num_threads), count) - 1;
    threads.reserve(helpers);
    try {
      for (std::size_t t = 0; t < helpers; ++t) {
        {
          const std::lock_guard lock(mutex);
          ++at_work;
        }
        threads.emplace_back(help);
      }
    } catch (const std::system_error&) {  // no more threads to be had: those that are there do it
      const std::lock_guard lock(mutex);
      --at_work;
    }
    run();
    // Who has nothing left to do here still looks whether the others are to end.
    std::unique_lock lock(mutex);
    while (at_work > 0) {
      one_less.wait_for(lock, std::chrono::milliseconds(20));
      if (!stop || ended) continue;
      lock.unlock();
      if (stop()) stopped = ended = true;
      lock.lock();
    }
  }
  if (error) std::rethrow_exception(error);
  return !stopped;
}

}  // namespace hb::tools
