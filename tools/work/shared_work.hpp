// Long work in parts: spread over threads, shown on the terminal, kept in a file as it goes, ended early on request.
// The answer has the same bits whatever the number of threads and of interruptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hb/engine/boundaries/part.hpp"
#include "tools/work/checkpoint.hpp"

namespace hb::tools {

constexpr int exit_interrupted = 130;  // as shells report Ctrl-C

// Thrown by SharedWork when `stop` said so: what is finished has been kept.
struct WorkStopped {};

class SharedWork {
 public:
  // `kept`, if given, holds what an earlier run finished of the same steps in the same order.
  explicit SharedWork(int num_threads, Checkpoint* kept = nullptr, std::function<bool()> stop = {})
      : num_threads_(num_threads), kept_(kept), stop_(std::move(stop)) {}

  // One step: part(0) .. part(count - 1).
  std::vector<Part> parts(const std::string& what, std::size_t count, const std::function<Part(std::size_t)>& part);

  // The same for results that visit(visitor, result) writes and reads as numbers.
  template <class Result, class Visit>
  std::vector<Result> results(const std::string& what, std::size_t count,
                              const std::function<Result(std::size_t)>& compute, const Visit& visit) {
    return computed_parts<Result>(of(what), count, compute, visit);
  }

  // For those who only know steps.
  PartsOf of(std::string what) {
    return [this, what = std::move(what)](std::size_t count, const std::function<Part(std::size_t)>& part) {
      return parts(what, count, part);
    };
  }

 private:
  int num_threads_;
  Checkpoint* kept_;
  std::function<bool()> stop_;
  std::uint64_t step_ = 0;
};

// Runs `work`, a subcommand's, with what it finishes kept in a file beside the folder `out` until all of it is done;
// `resume`: goes on with what an interrupted run of the same `key` left there. No folder: nothing is kept. False if
// Ctrl-C or SIGTERM ended it early.
bool run_kept(const std::string& command, const std::optional<std::filesystem::path>& out, bool resume,
              std::uint64_t key, int num_threads, const std::function<void(SharedWork&)>& work);

}  // namespace hb::tools
