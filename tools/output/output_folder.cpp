#include "tools/output/output_folder.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>

#include "tools/command/command.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw OutputError(fmt::format("--out: {} cannot be written: {}", path.string(), reason));
}

// A new empty folder `parent`/`prefix`XXXXXX.
fs::path make_temporary(const fs::path& parent, const std::string& prefix, const fs::path& wanted) {
  std::string name = (parent / (prefix + "XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) fail(wanted, std::strerror(errno));
  // mkdtemp gives 0700; the folder is to have what mkdir would have given.
  const mode_t mask = umask(0);
  umask(mask);
  fs::permissions(name, static_cast<fs::perms>(0777 & ~mask));
  return name;
}

// What Ctrl-C or SIGTERM removes before the program ends; empty: nothing.
char unfinished[4096];

// Only calls that a signal handler may make.
void remove_unfinished(int signal) {
  if (unfinished[0] != '\0') {
    const pid_t child = fork();
    if (child == 0) {
      execl("/bin/rm", "rm", "-rf", "--", unfinished, nullptr);
      _exit(1);
    }
    if (child > 0) waitpid(child, nullptr, 0);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void remove_when_interrupted(const std::string& path) {
  if (path.size() >= sizeof unfinished) return;
  std::strcpy(unfinished, path.c_str());
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(signal, remove_unfinished);
  }
}

}  // namespace

std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(byte) != 0 || c == '-' || c == '_' || c == '.' || byte >= 0x80;
    name += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
  }
  return name;
}

OutputFolder::OutputFolder(fs::path folder, const std::string& command)
    : folder_(std::move(folder)), list_(command.empty() ? "" : ".hb-" + command) {
  std::error_code error;
  // "out/" is out.
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  const fs::path absolute = fs::absolute(folder_, error);
  if (error) fail(folder_, error.message());
  const fs::file_status status = fs::status(absolute, error);
  if (error && status.type() != fs::file_type::not_found) fail(folder_, error.message());
  existed_ = fs::exists(status);
  if (existed_ && !fs::is_directory(status)) fail(folder_, "it exists and is not a folder");
  if (existed_) {
    scratch_ = make_temporary(absolute, ".hb-", folder_);
    remove_when_interrupted(scratch_.string());
    return;
  }
  std::vector<fs::path> missing;  // parents to make, innermost first
  for (fs::path parent = absolute.parent_path(); !fs::exists(parent, error); parent = parent.parent_path()) {
    if (error) fail(folder_, error.message());
    missing.push_back(parent);
  }
  try {
    for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
      if (!fs::create_directory(*parent, error) && error) fail(folder_, error.message());
      made_parents_.push_back(*parent);
    }
    scratch_ = make_temporary(absolute.parent_path(), fmt::format(".{}-", absolute.filename().string()), folder_);
  } catch (...) {
    for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) fs::remove(*parent, error);
    throw;
  }
  remove_when_interrupted((made_parents_.empty() ? scratch_ : made_parents_.front()).string());
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  unfinished[0] = '\0';
  std::error_code ignored;
  fs::remove_all(scratch_, ignored);
  for (auto parent = made_parents_.rbegin(); parent != made_parents_.rend(); ++parent) fs::remove(*parent, ignored);
}

void OutputFolder::write(const std::string& name, const std::string& text) {
  const fs::path path = scratch_ / name;
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(folder_ / name, std::strerror(errno));
  const char* next = text.data();
  std::size_t left = text.size();
  while (left > 0) {
    const ssize_t written = ::write(file, next, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      close(file);
      fail(folder_ / name, std::strerror(reason));
    }
    next += written;
    left -= static_cast<std::size_t>(written);
  }
  if (close(file) != 0) fail(folder_ / name, std::strerror(errno));
}

// Only plain files in the folder itself, whatever the list says.
void OutputFolder::remove_old(const fs::path& place, const std::vector<std::string>& written) const {
  std::ifstream list(place / list_);
  std::error_code ignored;
  for (std::string name; std::getline(list, name);) {
    const bool plain = !name.empty() && name.find('/') == std::string::npos;
    if (plain && std::find(written.begin(), written.end(), name) == written.end() &&
        fs::is_regular_file(fs::symlink_status(place / name, ignored)))
      fs::remove(place / name, ignored);
  }
}

void OutputFolder::commit() {
  std::error_code error;
  const fs::path place = fs::absolute(folder_);
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  if (!list_.empty()) {
    write(list_, fmt::format("{}\n", fmt::join(names, "\n")));
    names.push_back(list_);
  }
  unfinished[0] = '\0';
  if (!existed_) {
    fs::rename(scratch_, place, error);
    if (error) fail(folder_, error.message());
    committed_ = true;
    return;
  }
  for (const std::string& name : names) {
    if (fs::is_directory(place / name, error)) fail(folder_ / name, "a folder has that name");
  }
  if (!list_.empty()) remove_old(place, names);
  for (const std::string& name : names) {
    fs::rename(scratch_ / name, place / name, error);
    if (error) fail(folder_ / name, error.message());
  }
  fs::remove(scratch_, error);
  committed_ = true;
}

}  // namespace hb::tools
