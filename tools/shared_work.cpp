#include "tools/shared_work.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "tools/command.hpp"
#include "tools/parallel_for.hpp"
#include "tools/progress.hpp"

namespace hb::tools {
namespace {

// Parts that are kept together: often enough for a kill to lose little, seldom enough not to wait for the disk.
std::size_t parts_per_chunk(std::size_t count) { return std::clamp<std::size_t>(count / 100, 1, 64); }

// Each part after its length.
Part joined(const std::vector<Part>& parts, std::size_t from, std::size_t to) {
  Part numbers;
  for (std::size_t k = from; k < to; ++k) {
    numbers.push_back(static_cast<double>(parts[k].size()));
    numbers.insert(numbers.end(), parts[k].begin(), parts[k].end());
  }
  return numbers;
}

void split(const Part& numbers, std::vector<Part>& parts, std::size_t from, std::size_t to) {
  auto next = numbers.begin();
  for (std::size_t k = from; k < to; ++k) {
    if (next == numbers.end() || !(*next >= 0) || *next > static_cast<double>(numbers.end() - next - 1)) {
      throw std::out_of_range("part of a result: of another kind");
    }
    const auto size = static_cast<std::ptrdiff_t>(*next++);
    parts[k].assign(next, next + size);
    next += size;
  }
}

std::filesystem::path part_file(std::filesystem::path folder) {
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.string() + ".part";
}

}  // namespace

std::vector<Part> SharedWork::parts(const std::string& what, std::size_t count,
                                    const std::function<Part(std::size_t)>& part) {
  const std::uint64_t step = step_++ << 32;
  const std::size_t chunk_size = parts_per_chunk(count);
  std::vector<Part> all(count);
  Progress progress(what, count);
  const bool complete =
      parallel_for((count + chunk_size - 1) / chunk_size, num_threads_,
                   [&](std::size_t chunk) {
                     const std::size_t from = chunk * chunk_size, to = std::min(from + chunk_size, count);
                     if (const Part* earlier = kept_ != nullptr ? kept_->find(step + chunk) : nullptr) {
                       split(*earlier, all, from, to);
                     } else {
                       for (std::size_t k = from; k < to; ++k) all[k] = part(k);
                       if (kept_ != nullptr) kept_->store(step + chunk, joined(all, from, to));
                     }
                     progress.advance(to - from);
                   },
                   stop_);
  if (!complete) throw WorkStopped();
  return all;
}

bool run_kept(const std::string& command, const std::optional<std::filesystem::path>& out, bool resume,
              std::uint64_t key, int num_threads, const std::function<void(SharedWork&)>& work) {
  if (!out) {
    if (resume) throw UsageError("--resume: found no --out, allowed: the folder of the run to go on with");
    SharedWork unkept(num_threads);
    work(unkept);
    return true;
  }
  Checkpoint checkpoint(part_file(*out), key, resume, "the same scene and flags");
  if (resume) fmt::print(stderr, "hb {}: {} finished parts found\n", command, checkpoint.num_finished());
  const InterruptGuard guard;
  SharedWork kept(num_threads, &checkpoint, interrupted);
  try {
    work(kept);
  } catch (const WorkStopped&) {
    fmt::print(stderr, "hb {}: stopped; what is finished is kept in {}: the same command with --resume goes on\n",
               command, checkpoint.file().string());
    return false;
  } catch (const std::out_of_range& error) {
    throw UsageError(fmt::format("--resume: {} cannot be read ({}), allowed: what the same version of hb left",
                                 checkpoint.file().string(), error.what()));
  } catch (...) {
    checkpoint.remove();
    throw;
  }
  checkpoint.remove();
  return true;
}

}  // namespace hb::tools
