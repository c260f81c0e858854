// One run at a time in an output folder, or at an output file: a lock file beside it (inside, where nothing may be
// written beside it), held by the kernel until the process ends, however it ends.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/work/interrupts.hpp"

namespace hb::tools {

// A file of hb's that belongs to `folder` but stands beside it, so that it may exist before the folder does:
// `folder`SUFFIX; `folder`/.hbSUFFIX if the folder is there and its parent is not to be written.
[[nodiscard]] std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix);

class FolderLock {
 public:
  // Throws OutputError at once, naming its process and its start, if another run works in `folder`. What a run that was
  // killed left behind (its temporary folder) is removed, and said on standard error.
  FolderLock(const std::filesystem::path& folder, const std::string& command);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  // The temporary folder that the next run removes should this one be killed.
  void note_scratch(const std::filesystem::path& scratch);

 private:
  void take_over(const std::filesystem::path& folder);
  void write();

  std::filesystem::path file_, scratch_;
  std::string command_;
  int descriptor_ = -1;
  std::optional<Unfinished> removed_on_signal_;
};

}  // namespace hb::tools
