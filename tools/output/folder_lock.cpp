#include "tools/output/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <sstream>

#include "tools/output/speaker.hpp"
#include "tools/work/errors.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

constexpr const char* lock_mark = "hb";  // of a lock file; then command, process, start, temporary folder

std::string now() {
  const std::time_t time = std::time(nullptr);
  std::tm parts{};
  localtime_r(&time, &parts);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts)};
}

std::string contents(int descriptor) {
  char text[8192];
  const ssize_t size = pread(descriptor, text, sizeof text, 0);
  return {text, size > 0 ? static_cast<std::size_t>(size) : 0};
}

struct Holder {
  std::string command, process, start, scratch;
};

std::optional<Holder> holder(const std::string& text) {
  std::istringstream lines(text);
  std::string first;
  Holder result;
  if (!std::getline(lines, first) || first != lock_mark || !std::getline(lines, result.command) ||
      !std::getline(lines, result.process) || !std::getline(lines, result.start))
    return std::nullopt;
  std::getline(lines, result.scratch);
  return result;
}

bool same_file(int descriptor, const fs::path& path) {
  struct stat open_one {
  }, named{};
  return fstat(descriptor, &open_one) == 0 && lstat(path.c_str(), &named) == 0 && open_one.st_ino == named.st_ino &&
         open_one.st_dev == named.st_dev;
}

}  // namespace

fs::path beside(const fs::path& folder, const std::string& suffix) {
  std::error_code error;
  const fs::path absolute = fs::absolute(folder, error);
  // One name for the same folder, however it is written; as written where that is the same.
  fs::path place = fs::weakly_canonical(absolute, error);
  if (error) place = absolute;
  if (place == absolute.lexically_normal() && folder.has_filename() && folder.filename() != "." &&
      folder.filename() != "..")
    place = folder;
  const fs::path parent = place.has_parent_path() ? place.parent_path() : fs::path(".");
  if (fs::is_directory(place, error) && access(parent.c_str(), W_OK) != 0) return place / (".hb" + suffix);
  return place.string() + suffix;
}

FolderLock::FolderLock(const fs::path& folder, const std::string& command)
    : file_(beside(folder, ".lock")), command_(command) {
  for (;;) {
    descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0) refuse_output(folder, fmt::format("{}: {}", file_.string(), std::strerror(errno)));
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::optional<Holder> other = holder(contents(descriptor_));
      close(descriptor_);
      throw OutputError(fmt::format(
          "--out: {} is in use by {}; allowed: another place, or this one when that run has ended", folder.string(),
          other ? fmt::format("{}, process {}, started {}", other->command, other->process, other->start)
                : "another run"));
    }
    // Whoever held it may have removed the file between the two calls: then another one has that name, or none.
    if (same_file(descriptor_, file_)) break;
    close(descriptor_);
  }
  try {
    take_over(folder);
    removed_on_signal_.emplace(file_, Unfinished::Kind::file);
    write();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

FolderLock::~FolderLock() {
  unlink(file_.c_str());
  close(descriptor_);
}

void FolderLock::take_over(const fs::path& folder) {
  const std::string text = contents(descriptor_);
  if (text.empty()) return;
  const std::optional<Holder> killed = holder(text);
  if (!killed) refuse_output(folder, fmt::format("{} was not written by hb; allowed: to move it away", file_.string()));
  fmt::print(stderr, "{}: {} (process {}, started {}) did not end by itself; its lock on {} is taken\n", speaker(),
             killed->command, killed->process, killed->start, folder.string());
  // Only what this run would have made itself, whatever the file says.
  const fs::path scratch = killed->scratch;
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(scratch, ignored);
  const bool own =
      scratch.filename().string().starts_with(".hb-") && (fs::is_directory(status) || fs::is_regular_file(status)) &&
      (fs::equivalent(scratch.parent_path(), folder, ignored) ||
       fs::equivalent(scratch.parent_path(), file_.parent_path().empty() ? "." : file_.parent_path(), ignored));
  if (own) fs::remove_all(scratch, ignored);
}

void FolderLock::note_scratch(const fs::path& scratch) {
  scratch_ = scratch;
  write();
}

void FolderLock::write() {
  static const std::string start = now();
  const std::string text = fmt::format("{}\n{}\n{}\n{}\n{}\n", lock_mark, command_, getpid(), start, scratch_.string());
  // On a full disk the lock holds all the same; only its words are missing.
  if (ftruncate(descriptor_, 0) == 0) [[maybe_unused]]
    const ssize_t size = pwrite(descriptor_, text.data(), text.size(), 0);
}

}  // namespace hb::tools
