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

enum class EarlierParts {
  none,  // a fresh start; finished parts that are there are not touched
  resume,  // go on with them
  restart,  // throw them away
};

class Checkpoint {
 public:
  // Throws UsageError where finished parts are in the way of a fresh start, where those to go on with belong to another
  // task or to another version of hb, and where `file` is not of hb; OutputError when it cannot be written. A part cut
  // short by a kill is dropped.
  Checkpoint(std::filesystem::path file, std::uint64_t key, EarlierParts earlier);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  std::size_t num_finished() const { return num_finished_; }  // of both runs
  // Of the earlier run.
  [[nodiscard]] const std::vector<double>* find(std::uint64_t index) const;
  // From any thread; on its way to the disk when this returns. Where the disk is full the part is not kept, and the
  // first such time said on standard error.
  void store(std::uint64_t index, const std::vector<double>& numbers);
  // The work is complete and delivered: the file goes away.
  void remove();
  const std::filesystem::path& file() const { return file_; }

 private:
  void read(const std::string& bytes);
  void start_anew(std::uint64_t key);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::map<std::uint64_t, std::vector<double>> parts_;
  std::size_t num_finished_ = 0;
  std::size_t good_bytes_ = 0;  // of the file, up to the end of the last whole part
  bool complained_ = false;
  std::mutex mutex_;
};

}  // namespace hb::tools
