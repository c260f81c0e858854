// Long work in parts: spread over threads, shown on the terminal, kept in a file as it goes, ended early on request.
// The answer has the same bits whatever the number of threads and of interruptions.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/work.hpp"
#include "tools/work/checkpoint.hpp"
#include "tools/work/forecast.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {

// Thrown by SharedWork when `stop` said so: what is finished has been kept.
struct WorkStopped {};

class SharedWork : public Work {
 public:
  // `kept`, if given, holds what an earlier run finished of the same steps in the same order. `stop` ends a step with
  // WorkStopped; `early` lets it go on to its end without computing what is left, of which nothing is kept. `what`
  // names all steps together where a sentence says how long they take; empty: by the first of them.
  explicit SharedWork(int num_threads, Checkpoint* kept = nullptr, std::function<bool()> stop = {},
                      std::function<bool()> early = {}, std::string what = {})
      : num_threads_(num_threads),
        kept_(kept),
        stop_(std::move(stop)),
        early_(std::move(early)),
        what_(std::move(what)) {}

  void for_each(std::size_t count, const std::function<void(std::size_t)>& task) const override;
  void step(const std::string& what, const Parts& parts) override;
  [[nodiscard]] bool ends_early() const override { return early_ && early_(); }

 private:
  class Chunks;
  void compute_or_leave(const std::function<void(std::size_t)>& compute, std::size_t k) const;

  int num_threads_;
  Checkpoint* kept_;
  std::function<bool()> stop_, early_;
  std::string what_;
  std::optional<Forecast> forecast_;
  std::uint64_t step_ = 0;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

// A subcommand's long work, with what it finishes kept in a file beside the folder `out` until the answer is delivered.
class KeptRun {
 public:
  // Throws as Checkpoint does. No folder: nothing is kept.
  KeptRun(std::string command, const std::optional<std::filesystem::path>& out, EarlierParts earlier, std::uint64_t key,
          int num_threads);
  // Says where finished parts are, unless they were delivered.
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // False if it was stopped before there was an answer: by Ctrl-C or SIGTERM where finished parts are kept, or in one
  // of several processes. Else the answer may lack what was not computed before Ctrl-C or the end of the time.
  [[nodiscard]] bool run(const std::function<void(SharedWork&)>& work);
  // The answer is in its place: the parts go.
  void delivered();

 private:
  std::string command_;
  int num_threads_;
  std::optional<Checkpoint> checkpoint_;
};

// What ends work on the way to an answer that has to be given as far as it is there; with `folder` only the time: then
// what is finished is kept at Ctrl-C.
[[nodiscard]] std::function<bool()> early_end(bool folder);
// Exit status of work that was stopped, after the words that belong to it; `json`: as a document too.
[[nodiscard]] int stopped_status(bool json);
// Status of an answer: 130 after Ctrl-C, else `status`.
[[nodiscard]] int ended_status(int status);

// --resume and --restart.
[[nodiscard]] EarlierParts earlier_parts_flag(bool resume, bool restart, bool out);

}  // namespace hb::tools
