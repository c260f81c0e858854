#include "tools/work/shared_work.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <span>
#include <stdexcept>

#include "lib/stop_wish.hpp"
#include "tools/command/command.hpp"
#include "tools/output/folder_lock.hpp"
#include "tools/output/speaker.hpp"
#include "tools/work/parallel_for.hpp"
#include "tools/work/progress.hpp"
#include "tools/work/ranks.hpp"

namespace hb::tools {
namespace {

// Parts that are kept together: often enough for a kill to lose little, seldom enough not to wait for the disk. Those
// that share work stay together where that leaves enough chunks for many threads. The same with any number of threads
// and processes, or --resume would take parts for others.
std::size_t parts_per_chunk(const Parts& parts) {
  constexpr std::size_t most = 64, enough_groups = 32;
  const std::size_t size = std::clamp<std::size_t>(parts.count / 100, 1, most);
  if (parts.count < enough_groups * parts.together) return size;
  return std::max<std::size_t>(size / parts.together, 1) * parts.together;
}

// Each part after its length.
Part joined(const Parts& parts, std::size_t from, std::size_t to) {
  Part numbers;
  for (std::size_t k = from; k < to; ++k) {
    const Part part = parts.numbers(k);
    numbers.push_back(static_cast<double>(part.size()));
    numbers.insert(numbers.end(), part.begin(), part.end());
  }
  return numbers;
}

void split(const Part& numbers, const Parts& parts, std::size_t from, std::size_t to) {
  auto next = numbers.begin();
  for (std::size_t k = from; k < to; ++k) {
    if (next == numbers.end() || !(*next >= 0) || *next > static_cast<double>(numbers.end() - next - 1)) {
      throw std::out_of_range("part of a result: of another kind");
    }
    const auto size = static_cast<std::ptrdiff_t>(*next++);
    parts.take(k, Part(next, next + size));
    next += size;
  }
  if (next != numbers.end()) throw std::out_of_range("part of a result: of more parts");
}

}  // namespace

void SharedWork::for_each(std::size_t count, const std::function<void(std::size_t)>& task) const {
  parallel_for(count, num_threads_, [&](std::size_t k) {
    if (early_)
      compute_or_leave(task, k);
    else
      task(k);
  });
}

// A part under way is given up where the work is to end; where it ends early, what takes its place says so.
void SharedWork::compute_or_leave(const std::function<void(std::size_t)>& compute, std::size_t k) const {
  if ((!stop_ && !early_) || ranks().size() > 1) return compute(k);  // of several processes all end together
  try {
    const StopWish wish([this] { return (stop_ && stop_()) || ends_early(); });
    compute(k);
  } catch (const Stopped&) {
    if (!ends_early()) throw WorkStopped();
    compute(k);
  }
}

// Chunks in an order in which those that are done are spread over all, whenever one looks: 0, s, 2s, .. modulo the
// count, with s its golden section, made prime to it.
class SpreadOrder {
 public:
  explicit SpreadOrder(std::size_t count) : count_(count) {
    constexpr double golden = 0.6180339887498949;
    stride_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(golden * static_cast<double>(count))));
    while (std::gcd(stride_, count) > 1) ++stride_;
  }
  std::size_t operator()(std::size_t k) const { return k * stride_ % count_; }

 private:
  std::size_t count_, stride_ = 1;
};

// A step in chunks of parts: what is kept or sent at once.
class SharedWork::Chunks {
 public:
  Chunks(SharedWork& work, const std::string& what, const Parts& parts)
      : work_(work),
        parts_(parts),
        step_(work.step_++ << 32),
        size_(parts_per_chunk(parts)),
        count_((parts.count + size_ - 1) / size_),
        what_(what),
        progress_(what, parts.count, work.begun_) {}

  void run_alone() {
    Forecast& forecast = begun_forecast();
    const SpreadOrder order(count_);
    const bool complete = parallel_for(
        count_, work_.num_threads_,
        [&](std::size_t k) {
          const std::size_t chunk = order(k);
          if (const Part* earlier = kept(chunk)) {
            split(*earlier, parts_, from(chunk), to(chunk));
          } else {
            forecast.advance(compute(chunk));
            if (!work_.ends_early()) keep(chunk);
          }
          progress_.advance(to(chunk) - from(chunk));
        },
        work_.stop_);
    if (!complete) throw WorkStopped();
    if (work_.ends_early()) forecast.end_early();
  }

  // Rounds of the chunks that are not known, each shared among the ranks: often enough for a kill to lose little.
  void run_with_other_ranks() {
    known_.assign(count_, false);
    take_kept();
    std::vector<std::size_t> pending;
    for (std::size_t chunk = 0; chunk < count_; ++chunk)
      if (!known_[chunk]) pending.push_back(chunk);
    const std::size_t per_round =
        static_cast<std::size_t>(ranks().size()) * static_cast<std::size_t>(work_.num_threads_) * 2;
    for (std::size_t first = 0; first < pending.size(); first += per_round)
      round(std::span(pending).subspan(first, std::min(per_round, pending.size() - first)));
  }

 private:
  // Messages between the ranks: a state, then chunk, length and numbers of each chunk.
  static constexpr double running = 0, stopped = 1, failed = 2;

  [[nodiscard]] std::size_t from(std::size_t chunk) const { return chunk * size_; }
  [[nodiscard]] std::size_t to(std::size_t chunk) const { return std::min(from(chunk) + size_, parts_.count); }

  Forecast& begun_forecast() const {
    if (!work_.forecast_) work_.forecast_.emplace(work_.what_.empty() ? what_ : work_.what_, work_.num_threads_);
    std::size_t known = 0;
    for (std::size_t chunk = 0; chunk < count_; ++chunk)
      if (kept(chunk) != nullptr) known += to(chunk) - from(chunk);
    work_.forecast_->begin(parts_.count, known, parts_.kind, parts_.ahead);
    return *work_.forecast_;
  }
  // How many parts were not left because the work ends early.
  std::size_t compute(std::size_t chunk) const {
    std::size_t in_time = 0;
    for (std::size_t k = from(chunk); k < to(chunk); ++k) {
      work_.compute_or_leave(parts_.compute, k);
      if (!work_.ends_early()) ++in_time;
    }
    return in_time;
  }
  [[nodiscard]] const Part* kept(std::size_t chunk) const {
    return work_.kept_ != nullptr ? work_.kept_->find(step_ + chunk) : nullptr;
  }
  void keep(std::size_t chunk) const {
    if (work_.kept_ != nullptr) work_.kept_->store(step_ + chunk, joined(parts_, from(chunk), to(chunk)));
  }

  void add(Part& message, std::size_t chunk) const {
    const Part numbers = joined(parts_, from(chunk), to(chunk));
    message.push_back(static_cast<double>(chunk));
    message.push_back(static_cast<double>(numbers.size()));
    message.insert(message.end(), numbers.begin(), numbers.end());
  }
  void take(const Part& message) {
    for (std::size_t next = 1; next < message.size();) {
      const auto chunk = static_cast<std::size_t>(message[next]), length = static_cast<std::size_t>(message[next + 1]);
      const auto start = message.begin() + static_cast<std::ptrdiff_t>(next) + 2;
      split(Part(start, start + static_cast<std::ptrdiff_t>(length)), parts_, from(chunk), to(chunk));
      known_[chunk] = true;
      progress_.advance(to(chunk) - from(chunk));
      next += 2 + length;
    }
  }

  // What an earlier run finished, from the first rank to all.
  void take_kept() {
    Part earlier = {running};
    for (std::size_t chunk = 0; chunk < count_; ++chunk)
      if (const Part* found = kept(chunk)) {
        split(*found, parts_, from(chunk), to(chunk));
        add(earlier, chunk);
      }
    take(ranks().gathered(earlier).front());
  }

  void round(std::span<const std::size_t> chunks) {
    const auto size = static_cast<std::size_t>(ranks().size()), rank = static_cast<std::size_t>(ranks().rank());
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < chunks.size(); ++i)
      if (i % size == rank) own.push_back(chunks[i]);
    Part message = {running};
    std::exception_ptr failure;
    try {
      const bool complete = parallel_for(
          own.size(), work_.num_threads_, [&](std::size_t i) { compute(own[i]); }, work_.stop_);
      if (!complete) message[0] = stopped;
      if (complete)
        for (const std::size_t chunk : own) add(message, chunk);
    } catch (...) {
      message = {failed};
      failure = std::current_exception();
    }
    bool stop = false;
    const std::vector<Part> all = ranks().gathered(message);
    for (const Part& numbers : all) {
      take(numbers);
      stop = stop || numbers[0] == stopped;
    }
    end_if_failed(all, failure);
    // The first rank keeps what all have done; should that fail, the others have to know.
    Part state = {running};
    try {
      for (const std::size_t chunk : chunks)
        if (known_[chunk]) keep(chunk);
    } catch (...) {
      state = {failed};
      failure = std::current_exception();
    }
    end_if_failed(ranks().gathered(state), failure);
    if (stop) throw WorkStopped();
  }

  static void end_if_failed(const std::vector<Part>& states, const std::exception_ptr& failure) {
    if (failure) std::rethrow_exception(failure);
    for (const Part& numbers : states)
      if (numbers[0] == failed) throw OtherRankFailed();
  }

  SharedWork& work_;
  const Parts& parts_;
  std::uint64_t step_;
  std::size_t size_, count_;
  std::string what_;
  Progress progress_;
  std::vector<bool> known_;
};

void SharedWork::step(const std::string& what, const Parts& parts) {
  Chunks chunks(*this, what, parts);
  if (ranks().size() == 1)
    chunks.run_alone();
  else
    chunks.run_with_other_ranks();
}

KeptRun::KeptRun(std::string command, const std::optional<std::filesystem::path>& out, EarlierParts earlier,
                 std::uint64_t key, int num_threads)
    : command_(std::move(command)), num_threads_(num_threads) {
  if (!out || !ranks().first()) return;
  checkpoint_.emplace(beside(*out, ".part"), key, earlier);
  if (earlier == EarlierParts::resume)
    fmt::print(stderr, "hb {}: {} finished parts found\n", command_, checkpoint_->num_finished());
}

KeptRun::~KeptRun() {
  if (!checkpoint_) return;
  if (checkpoint_->num_finished() == 0) {
    checkpoint_->remove();
    return;
  }
  fmt::print(stderr, "hb {}: {} finished parts are kept in {}: the same command with --resume goes on\n", command_,
             checkpoint_->num_finished(), checkpoint_->file().string());
}

bool KeptRun::run(const std::function<void(SharedWork&)>& work) {
  if (!ranks().first()) {
    const InterruptGuard guard;
    SharedWork share(num_threads_, nullptr, asked_to_end);
    work(share);
    throw ShareDone();
  }
  const InterruptGuard guard;
  const bool alone = ranks().size() == 1;
  SharedWork shared(num_threads_, checkpoint_ ? &*checkpoint_ : nullptr,
                    alone && !checkpoint_ ? std::function<bool()>()
                    : alone               ? interrupted
                                          : asked_to_end,
                    alone ? early_end(checkpoint_.has_value()) : std::function<bool()>(), "the " + command_);
  try {
    work(shared);
  } catch (const WorkStopped&) {
    return false;
  } catch (const std::out_of_range& error) {
    throw UsageError(fmt::format("--resume: {} cannot be read ({}), allowed: what the same version of hb left",
                                 checkpoint_->file().string(), error.what()));
  }
  return true;
}

void KeptRun::delivered() {
  if (asked_to_end()) return;  // what is finished serves --resume
  if (checkpoint_) checkpoint_->remove();
  checkpoint_.reset();
}

std::function<bool()> early_end(bool folder) { return folder ? time_is_up : asked_to_end; }

int stopped_status(bool json) {
  if (interrupted()) return exit_interrupted;
  constexpr const char* note = "the time limit was reached before there was an answer";
  fmt::print(stderr, "{}: {}\n", speaker(), note);
  if (json) fmt::print("{{\"status\":\"tolerance not reached\",\"notes\":[\"{}\"]}}\n", note);
  return exit_not_reached;
}

int ended_status(int status) { return interrupted() ? exit_interrupted : status; }

EarlierParts earlier_parts_flag(bool resume, bool restart, bool out) {
  if (resume && restart) throw UsageError("--restart: found beside --resume, allowed: one of the two");
  if ((resume || restart) && !out) {
    throw UsageError(fmt::format("--{}: found no --out, allowed: beside the folder of the interrupted run",
                                 resume ? "resume" : "restart"));
  }
  return resume ? EarlierParts::resume : restart ? EarlierParts::restart : EarlierParts::none;
}

}  // namespace hb::tools
