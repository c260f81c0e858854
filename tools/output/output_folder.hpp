// A folder whose files appear whole: they are written into a temporary folder beside their place and renamed into it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/output/folder_lock.hpp"
#include "tools/output/long_text.hpp"
#include "tools/output/provenance.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {

// A name of the scene as part of a file name: what is not ASCII letters, digits, '-', '_' and '.' or a visible
// character beyond ASCII as %XX, so that different names stay different.
[[nodiscard]] std::string file_name(const std::string& text);

// Held by one run at a time. A name in the folder that an earlier run of the same command did not write (it left its
// names in `.hb-COMMAND`) is never replaced: what has it is renamed to NAME.~1~.
class OutputFolder {
 public:
  // Throws OutputError naming the folder and the reason; nothing is left behind then.
  OutputFolder(std::filesystem::path folder, const std::string& command, Provenance origin = {});
  // Removes what was not committed; signals that end the program do so too.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  const std::string& command() const { return command_; }
  // With its provenance. Throws OutputError when it does not reach the disk.
  void write(const std::string& name, const std::string& text);
  // In pieces; the first one has the beginning that provenance is put into.
  void write_long(const std::string& name, const LongText& text);
  // Moves what was written into its place: at once where there was no folder; else file by file, none of them half,
  // with a line on standard error that says what was replaced, removed or renamed. The first time, files of the earlier
  // run that are not written again go. May be repeated: what is written after it is the next stage.
  void commit();

  // The temporary folder of this stage, with links to the files already committed: for programs that read these.
  [[nodiscard]] std::filesystem::path scratch_with_links();
  // Takes away from this stage what is not wanted.
  void drop(const std::string& name);

 private:
  struct Scratch {
    std::filesystem::path path;
    Unfinished removed_on_signal;
    explicit Scratch(const std::filesystem::path& made);
    ~Scratch();
  };

  void make_scratch();
  void refuse_folders(const std::filesystem::path& place, const std::vector<std::string>& names) const;
  void merge(const std::filesystem::path& place, const std::vector<std::string>& names);
  [[nodiscard]] std::set<std::string> listed(const std::filesystem::path& place) const;
  void write_list(const std::filesystem::path& place, const std::set<std::string>& names);

  std::filesystem::path folder_, absolute_;
  std::string command_, list_;
  Provenance origin_;
  std::vector<std::filesystem::path> made_parents_;  // innermost last
  std::vector<std::unique_ptr<Unfinished>> parents_on_signal_;
  std::optional<FolderLock> lock_;
  std::optional<Scratch> scratch_;
  std::set<std::string> committed_;  // by this run
  bool first_stage_ = true;
};

}  // namespace hb::tools
