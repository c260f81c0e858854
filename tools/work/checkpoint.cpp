#include "tools/work/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tools/command/version.hpp"
#include "tools/output/speaker.hpp"
#include "tools/work/errors.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

constexpr char magic[8] = {'h', 'b', 'p', 'a', 'r', 't', 's', '2'};

// The program that wrote it: its results may differ from those of another version.
const std::string& program() {
  static const std::string name = fmt::format("hb {}", version());
  return name;
}

// One part: index, count, numbers, hash of all before.
struct Head {
  std::uint64_t index, count;
};

std::uint64_t hash_of(const std::string& bytes) { return TaskKey().add(bytes).value(); }

[[noreturn]] void refuse_foreign(const fs::path& file) {
  throw UsageError(
      fmt::format("--out: {} was not written by hb, which keeps finished parts there; allowed: to move it away, or "
                  "another folder",
                  file.string()));
}

// 0 or the reason why not.
int write_all(int descriptor, const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    done += static_cast<std::size_t>(written);
  }
  return 0;
}

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw OutputError(fmt::format("--out: {} cannot be read", file.string()));
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

template <class Value>
Value value_at(const std::string& bytes, std::size_t at) {
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof(Value));
  return value;
}

// Magic, length and name of the program, key of the task.
struct Header {
  std::string program;
  std::uint64_t key = 0;
  std::size_t size = 0;
};

std::optional<Header> header_of(const std::string& bytes) {
  constexpr std::size_t number = sizeof(std::uint64_t), most = 200;
  if (bytes.size() < sizeof magic + 2 * number || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
    return std::nullopt;
  const auto length = value_at<std::uint64_t>(bytes, sizeof magic);
  if (length > most || bytes.size() < sizeof magic + 2 * number + length) return std::nullopt;
  Header header;
  header.program = bytes.substr(sizeof magic + number, length);
  header.key = value_at<std::uint64_t>(bytes, sizeof magic + number + length);
  header.size = sizeof magic + 2 * number + length;
  return header;
}

}  // namespace

void TaskKey::mix(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ull;
}

TaskKey& TaskKey::add(const std::string& text) {
  add(static_cast<double>(text.size()));
  mix(text.data(), text.size());
  return *this;
}

TaskKey& TaskKey::add(double number) {
  mix(&number, sizeof(number));
  return *this;
}

Checkpoint::Checkpoint(fs::path file, std::uint64_t key, EarlierParts earlier) : file_(std::move(file)) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file_, error);
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) refuse_foreign(file_);
    const std::string bytes = contents(file_);
    const std::optional<Header> header = header_of(bytes);
    if (!header) refuse_foreign(file_);
    read(bytes);
    if (earlier == EarlierParts::none && num_finished_ > 0) {
      throw UsageError(
          fmt::format("--out: {} holds {} finished parts of an interrupted run; allowed: --resume to go on with them, "
                      "--restart to throw them away, or another folder",
                      file_.string(), num_finished_));
    }
    if (earlier == EarlierParts::resume) {
      if (header->program != program()) {
        throw UsageError(fmt::format("--resume: {} was left by {}, allowed: parts of {}; --restart throws them away",
                                     file_.string(), header->program, program()));
      }
      if (header->key != key) {
        throw UsageError(
            fmt::format("--resume: {} belongs to another task, allowed: parts of the same scene and flags; "
                        "--restart throws them away",
                        file_.string()));
      }
      // Goes on in the same file: what is there stays whatever happens, and no room for a copy is needed.
      descriptor_ = open(file_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
      if (descriptor_ < 0) refuse_output(file_, std::strerror(errno));
      if (ftruncate(descriptor_, static_cast<off_t>(good_bytes_)) != 0 || lseek(descriptor_, 0, SEEK_END) < 0) {
        const int reason = errno;
        close(descriptor_);
        refuse_output(file_, std::strerror(reason));
      }
      return;
    }
  }
  parts_.clear();
  num_finished_ = 0;
  start_anew(key);
}

// Whole before it takes the old one's place.
void Checkpoint::start_anew(std::uint64_t key) {
  std::string bytes(magic, sizeof magic);
  append(bytes, static_cast<std::uint64_t>(program().size()));
  bytes += program();
  append(bytes, key);
  std::string fresh = file_.string() + "-XXXXXX";
  descriptor_ = mkostemp(fresh.data(), O_CLOEXEC);
  if (descriptor_ < 0) refuse_output(file_, std::strerror(errno));
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(descriptor_, 0666 & ~mask);
  const int written = write_all(descriptor_, bytes);
  if (written != 0 || std::rename(fresh.c_str(), file_.c_str()) != 0) {
    const int reason = written != 0 ? written : errno;
    close(descriptor_);
    unlink(fresh.c_str());
    refuse_output(file_, std::strerror(reason));
  }
  good_bytes_ = bytes.size();
}

void Checkpoint::read(const std::string& bytes) {
  std::size_t at = header_of(bytes)->size;
  while (bytes.size() - at >= sizeof(Head)) {
    const auto head = value_at<Head>(bytes, at);
    const std::size_t left = bytes.size() - at - sizeof(Head);
    if (head.count > left / sizeof(double)) break;
    const std::size_t length = sizeof(Head) + head.count * sizeof(double);
    if (left < head.count * sizeof(double) + sizeof(std::uint64_t)) break;
    if (value_at<std::uint64_t>(bytes, at + length) != hash_of(bytes.substr(at, length))) break;
    std::vector<double> numbers(head.count);
    std::memcpy(numbers.data(), bytes.data() + at + sizeof(Head), head.count * sizeof(double));
    parts_[head.index] = std::move(numbers);
    at += length + sizeof(std::uint64_t);
  }
  num_finished_ = parts_.size();
  good_bytes_ = at;
}

Checkpoint::~Checkpoint() {
  if (descriptor_ >= 0) close(descriptor_);
}

const std::vector<double>* Checkpoint::find(std::uint64_t index) const {
  const auto part = parts_.find(index);
  return part == parts_.end() ? nullptr : &part->second;
}

void Checkpoint::store(std::uint64_t index, const std::vector<double>& numbers) {
  std::string bytes;
  append(bytes, Head{index, numbers.size()});
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  append(bytes, hash_of(bytes));
  const std::lock_guard lock(mutex_);
  const int reason = write_all(descriptor_, bytes);
  if (reason == 0) {
    good_bytes_ += bytes.size();
    ++num_finished_;
    return;
  }
  // The next one follows the last whole one.
  const bool back =
      ftruncate(descriptor_, static_cast<off_t>(good_bytes_)) == 0 && lseek(descriptor_, 0, SEEK_END) >= 0;
  if (!complained_) {
    fmt::print(stderr, "{}: {} cannot be written: {}; the work goes on, parts from here on are not kept\n", speaker(),
               file_.string(), std::strerror(reason));
  }
  complained_ = true;
  if (!back) refuse_output(file_, std::strerror(errno));
}

void Checkpoint::remove() {
  close(descriptor_);
  descriptor_ = -1;
  std::error_code ignored;
  fs::remove(file_, ignored);
}

}  // namespace hb::tools
