// A folder whose files appear whole or not at all: they are written into a temporary folder beside their place and
// renamed into it at the end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hb::tools {

// A name of the scene as part of a file name: ASCII other than letters, digits, '-', '_' and '.' as %XX, so that
// different names stay different.
[[nodiscard]] std::string file_name(const std::string& text);

class OutputFolder {
 public:
  // Makes the temporary folder: inside `folder` if that exists, else beside it. Throws OutputError naming the folder
  // and the reason; nothing is left behind then.
  // Of an earlier run of the same `command` in that folder, files that are not written again go when the new ones
  // come: it left their names in `.hb-COMMAND`. With no command named, old files stay.
  explicit OutputFolder(std::filesystem::path folder, const std::string& command = "");
  // Removes what was not committed; Ctrl-C, SIGTERM and SIGHUP do so too. One folder at a time.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Where the files are until they are committed.
  const std::filesystem::path& scratch() const { return scratch_; }
  // Throws OutputError when the text does not reach the disk.
  void write(const std::string& name, const std::string& text);
  // Moves everything into its place.
  void commit();

 private:
  void remove_old(const std::filesystem::path& place, const std::vector<std::string>& written) const;

  std::filesystem::path folder_, scratch_;
  std::string list_;  // name of the file with the names of the others; may be empty
  std::vector<std::filesystem::path> made_parents_;  // innermost last
  bool existed_ = false;
  bool committed_ = false;
};

}  // namespace hb::tools
