// Independent work spread over threads. Results belong into places of their own, by index: then the answer has the same
// bits whatever the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace hb::tools {

// Calls work(0) .. work(count - 1), each once, in any order, from `num_threads` threads (1: from this one, in order).
// An exception ends the rest; the one of the smallest index among those thrown is thrown on. `stop`, if given and true
// between two calls, ends it early without one; returns false then.
bool parallel_for(std::size_t count, int num_threads, const std::function<void(std::size_t)>& work,
                  const std::function<bool()>& stop = {});

}  // namespace hb::tools
