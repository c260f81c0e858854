// A file that appears whole or not at all: written beside its place and renamed into it, by one run at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/output/folder_lock.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {

class OutputFile {
 public:
  // Makes the file beside its place, empty; throws OutputError naming the path and the reason, or the run that writes
  // it now.
  OutputFile(std::filesystem::path path, const std::string& command);
  // Removes what was not committed; signals that end the program do so too.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Writes the whole text and moves it into its place; throws OutputError.
  void commit(const std::string& text);

 private:
  std::filesystem::path path_, scratch_;
  std::optional<FolderLock> lock_;
  std::optional<Unfinished> removed_on_signal_;
  int file_ = -1;
};

}  // namespace hb::tools
