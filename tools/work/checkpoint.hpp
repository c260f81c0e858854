// Finished parts of long work in a file, so that a kill loses nothing. Each part is a list of numbers under an index;
// the file belongs to one task, told by a key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hb::tools {

// FNV-1a over texts and numbers: the key of a task.
class TaskKey {
 public:
  TaskKey& add(const std::string& text);
  TaskKey& add(double number);
  std::uint64_t value() const { return hash_; }

 private:
  void mix(const void* data, std::size_t size);
  std::uint64_t hash_ = 14695981039346656037ull;
};

class Checkpoint {
 public:
  // `resume`: reads what an earlier run left, throws UsageError if it belongs to another task (`what` names it: "this
  // scene and these flags"); else starts anew. A part cut short by the kill is dropped. Throws OutputError when the
  // file cannot be written.
  Checkpoint(std::filesystem::path file, std::uint64_t key, bool resume, const std::string& what);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  std::size_t num_finished() const { return parts_.size(); }
  // Of the earlier run.
  [[nodiscard]] const std::vector<double>* find(std::uint64_t index) const;
  // From any thread; on its way to the disk when this returns.
  void store(std::uint64_t index, const std::vector<double>& numbers);
  // The work is complete: the file goes away.
  void remove();
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::map<std::uint64_t, std::vector<double>> parts_;
  std::mutex mutex_;
};

// While it lives, the first Ctrl-C or SIGTERM only raises a flag; the second ends the program as ever.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};
[[nodiscard]] bool interrupted();

}  // namespace hb::tools
