#include "tools/output/output_folder.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "tools/output/printable.hpp"
#include "tools/work/errors.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

// A new empty folder `parent`/.hb-XXXXXX.
fs::path make_temporary(const fs::path& parent, const fs::path& wanted) {
  std::string name = (parent / ".hb-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) refuse_output(wanted, std::strerror(errno));
  // mkdtemp gives 0700; the folder is to have what mkdir would have given.
  const mode_t mask = umask(0);
  umask(mask);
  std::error_code ignored;
  fs::permissions(name, static_cast<fs::perms>(0777 & ~mask), ignored);
  return name;
}

class WrittenFile {
 public:
  WrittenFile(const fs::path& path, fs::path wanted)
      : wanted_(std::move(wanted)), file_(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (file_ < 0) refuse_output(wanted_, std::strerror(errno));
  }
  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;
  ~WrittenFile() {
    if (file_ >= 0) close(file_);
  }

  void write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t written = ::write(file_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) refuse_output(wanted_, std::strerror(errno));
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void finish() {
    if (close(std::exchange(file_, -1)) != 0) refuse_output(wanted_, std::strerror(errno));
  }

 private:
  fs::path wanted_;
  int file_;
};

void write_file(const fs::path& path, std::string_view text, const fs::path& wanted) {
  WrittenFile file(path, wanted);
  file.write(text);
  file.finish();
}

bool is_plain(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(path, ignored));
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

// As `cp --backup=numbered` names what it keeps.
fs::path free_name_beside(const fs::path& path) {
  for (int number = 1;; ++number) {
    const fs::path name = fmt::format("{}.~{}~", path.string(), number);
    if (!is_there(name)) return name;
  }
}

std::string files(std::size_t count) { return fmt::format("{} file{}", count, count == 1 ? "" : "s"); }

}  // namespace

std::string file_name(const std::string& text) {
  std::string name;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = code_point_at(text, at);
    const auto byte = static_cast<unsigned char>(text[at]);
    const bool plain =
        byte < 0x80 ? std::isalnum(byte) != 0 || byte == '-' || byte == '_' || byte == '.' : point.visible;
    for (std::size_t k = at; k < at + point.length; ++k)
      name += plain ? std::string(1, text[k]) : fmt::format("%{:02X}", static_cast<unsigned char>(text[k]));
    at += point.length;
  }
  return name;
}

OutputFolder::Scratch::Scratch(const fs::path& made) : path(made), removed_on_signal(made, Unfinished::Kind::tree) {}

OutputFolder::Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

OutputFolder::OutputFolder(fs::path folder, const std::string& command, Provenance origin)
    : folder_(std::move(folder)), command_(command), list_(".hb-" + command), origin_(std::move(origin)) {
  std::error_code error;
  // "out/" is out.
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  absolute_ = fs::absolute(folder_, error);
  if (error) refuse_output(folder_, error.message());
  const fs::file_status status = fs::status(absolute_, error);
  if (error && status.type() != fs::file_type::not_found) refuse_output(folder_, error.message());
  if (fs::exists(status) && !fs::is_directory(status)) refuse_output(folder_, "it exists and is not a folder");
  if (!fs::exists(status) && is_there(absolute_)) {
    refuse_output(folder_,
                  fmt::format("it is a link to {}, which does not exist", fs::read_symlink(absolute_, error).string()));
  }
  std::vector<fs::path> missing;  // parents to make, innermost first
  for (fs::path parent = absolute_.parent_path(); !fs::exists(parent, error); parent = parent.parent_path()) {
    if (error) refuse_output(folder_, error.message());
    missing.push_back(parent);
  }
  try {
    for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
      if (!fs::create_directory(*parent, error) && error) refuse_output(folder_, error.message());
      made_parents_.push_back(*parent);
      parents_on_signal_.push_back(std::make_unique<Unfinished>(*parent, Unfinished::Kind::empty_folder));
    }
    lock_.emplace(folder_, "hb " + command_);
    make_scratch();
  } catch (...) {
    lock_.reset();
    for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) fs::remove(*parent, error);
    throw;
  }
}

OutputFolder::~OutputFolder() {
  scratch_.reset();
  lock_.reset();
  std::error_code ignored;  // of folders that are not empty
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) fs::remove(*parent, ignored);
}

void OutputFolder::make_scratch() {
  std::error_code error;
  const bool there = fs::is_directory(absolute_, error);
  const SignalsHeld held;  // until it is registered
  scratch_.emplace(make_temporary(there ? absolute_ : absolute_.parent_path(), folder_));
  lock_->note_scratch(scratch_->path);
}

void OutputFolder::write(const std::string& name, const std::string& text) {
  if (!scratch_) make_scratch();
  write_file(scratch_->path / name, with_provenance(name, text, origin_), folder_ / name);
}

void OutputFolder::write_long(const std::string& name, const LongText& text) {
  if (!scratch_) make_scratch();
  WrittenFile file(scratch_->path / name, folder_ / name);
  bool begun = false;
  text([&](std::string_view piece) {
    begun ? file.write(piece) : file.write(with_provenance(name, std::string(piece), origin_));
    begun = true;
  });
  file.finish();
}

void OutputFolder::drop(const std::string& name) {
  std::error_code ignored;
  if (scratch_) fs::remove(scratch_->path / name, ignored);
}

fs::path OutputFolder::scratch_with_links() {
  if (!scratch_) make_scratch();
  std::error_code error;
  for (const std::string& name : committed_) {
    fs::create_symlink(absolute_ / name, scratch_->path / name, error);
    if (error) refuse_output(folder_, error.message());
  }
  return scratch_->path;
}

std::set<std::string> OutputFolder::listed(const fs::path& place) const {
  std::set<std::string> names;
  if (!is_plain(place / list_)) return names;
  std::ifstream list(place / list_);
  // Only files in the folder itself, whatever the list says.
  for (std::string name; std::getline(list, name);)
    if (!name.empty() && name.find('/') == std::string::npos && is_plain(place / name)) names.insert(name);
  return names;
}

void OutputFolder::write_list(const fs::path& place, const std::set<std::string>& names) {
  write_file(scratch_->path / list_, fmt::format("{}\n", fmt::join(names, "\n")), folder_ / list_);
  std::error_code error;
  fs::rename(scratch_->path / list_, place / list_, error);
  if (error) refuse_output(folder_ / list_, error.message());
}

void OutputFolder::refuse_folders(const fs::path& place, const std::vector<std::string>& names) const {
  std::error_code ignored;
  for (const std::string& name : names)
    if (fs::is_directory(fs::symlink_status(place / name, ignored)))
      refuse_output(folder_ / name, "a folder has that name");
  if (is_there(place / list_) && !is_plain(place / list_))
    refuse_output(folder_ / list_, "it exists and is not a file");
}

void OutputFolder::merge(const fs::path& place, const std::vector<std::string>& names) {
  refuse_folders(place, names);
  const std::set<std::string> before = listed(place);
  std::set<std::string> after = committed_, all = before;
  after.insert(names.begin(), names.end());
  all.insert(after.begin(), after.end());
  std::vector<std::string> said;
  if (first_stage_ && !before.empty())
    said.push_back(fmt::format("{} of an earlier run replaced", files(before.size())));
  // In this order a kill at any point leaves no file that the list does not know.
  write_list(place, all);
  std::error_code error;
  for (const std::string& name : names) {
    if (!before.contains(name) && is_there(place / name)) {
      const fs::path kept = free_name_beside(place / name);
      fs::rename(place / name, kept, error);
      if (error) refuse_output(folder_ / name, error.message());
      said.push_back(fmt::format("{} (not of hb {}) is now {}", name, command_, kept.filename().string()));
    }
    fs::rename(scratch_->path / name, place / name, error);
    if (error) refuse_output(folder_ / name, error.message());
  }
  if (first_stage_) {
    for (const std::string& name : before)
      if (!after.contains(name)) fs::remove(place / name, error);
  }
  write_list(place, after);
  if (!said.empty()) fmt::print(stderr, "hb {}: in {}: {}\n", command_, folder_.string(), fmt::join(said, "; "));
}

void OutputFolder::commit() {
  if (!scratch_) return;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch_->path))
    if (!entry.is_symlink()) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  const SignalsHeld held;
  bool moved = false;
  if (!is_there(absolute_)) {
    write_file(scratch_->path / list_, fmt::format("{}\n", fmt::join(names, "\n")), folder_ / list_);
    // Fails where somebody has made a folder there meanwhile.
    moved = std::rename(scratch_->path.c_str(), absolute_.c_str()) == 0;
    if (!moved) drop(list_);
  }
  if (!moved) {
    std::error_code error;
    if (!fs::is_directory(absolute_, error)) refuse_output(folder_, "it was made meanwhile and is not a folder");
    merge(absolute_, names);
  }
  committed_.insert(names.begin(), names.end());
  scratch_.reset();
  lock_->note_scratch({});
  first_stage_ = false;
}

}  // namespace hb::tools
