#include "tools/output/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "tools/work/errors.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
OutputFile::OutputFile(fs::path path, const std::string& command) : path_(std::move(path)) {
  std::error_code error;
  if (fs::is_directory(path_, error)) refuse_output(path_, "it is a folder");
  if (!path_.has_filename()) refuse_output(path_, "it names no file");
  lock_.emplace(path_, command);
  std::string name = (fs::absolute(path_).parent_path() / (".hb-" + path_.filename().string() + "-XXXXXX")).string();
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) refuse_output(path_, std::strerror(errno));
  scratch_ = name;
  removed_on_signal_.emplace(scratch_, Unfinished::Kind::file);
  lock_->note_scratch(scratch_);
  // mkostemp's file is for its owner alone; a usual new file is not.
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(file_, 0666 & ~mask);
}

OutputFile::~OutputFile() {
  if (file_ >= 0) close(file_);
  std::error_code ignored;
  if (!scratch_.empty()) fs::remove(scratch_, ignored);
}

void OutputFile::commit(const std::string& text) {
  const char* next = text.data();
  for (std::size_t left = text.size(); left > 0;) {
    const ssize_t written = ::write(file_, next, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse_output(path_, std::strerror(errno));
    next += written;
    left -= static_cast<std::size_t>(written);
  }
  const int closed = close(file_);
  file_ = -1;
  if (closed != 0) refuse_output(path_, std::strerror(errno));
  std::error_code error;
  fs::rename(scratch_, path_, error);
  if (error) refuse_output(path_, error.message());
  removed_on_signal_.reset();
  scratch_.clear();
}

}  // namespace hb::tools
