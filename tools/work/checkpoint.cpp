#include "tools/work/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tools/command/command.hpp"

namespace hb::tools {
namespace {

constexpr char magic[8] = {'h', 'b', 'p', 'a', 'r', 't', 's', '1'};

// One part: index, count, numbers, hash of all before.
struct Head {
  std::uint64_t index, count;
};

std::uint64_t hash_of(const std::string& bytes) { return TaskKey().add(bytes).value(); }

[[noreturn]] void fail(const std::filesystem::path& file, int reason) {
  throw OutputError(fmt::format("{} cannot be written: {}", file.string(), std::strerror(reason)));
}

void write_all(int descriptor, const std::string& bytes, const std::filesystem::path& file) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file, errno);
    done += static_cast<std::size_t>(written);
  }
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

volatile std::sig_atomic_t interrupt_seen = 0;

void on_interrupt(int signal) {
  interrupt_seen = 1;
  std::signal(signal, SIG_DFL);
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

Checkpoint::Checkpoint(std::filesystem::path file, std::uint64_t key, bool resume, const std::string& what)
    : file_(std::move(file)) {
  std::string kept;
  if (resume) {
    std::ifstream stream(file_, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    constexpr std::size_t header = sizeof(magic) + sizeof(key);
    if (!bytes.empty()) {
      if (bytes.size() < header || std::memcmp(bytes.data(), magic, sizeof(magic)) != 0 ||
          value_at<std::uint64_t>(bytes, sizeof(magic)) != key) {
        throw UsageError(
            fmt::format("--resume: {} belongs to another task, allowed: parts of {}", file_.string(), what));
      }
      std::size_t at = header;
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
      kept = bytes.substr(0, at);
    }
  }
  if (kept.empty()) {
    kept.assign(magic, sizeof(magic));
    append(kept, key);
  }
  // Whole before it takes the old one's place.
  const std::filesystem::path fresh = file_.string() + ".new";
  descriptor_ = open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(file_, errno);
  try {
    write_all(descriptor_, kept, file_);
    if (std::rename(fresh.c_str(), file_.c_str()) != 0) fail(file_, errno);
  } catch (...) {
    close(descriptor_);
    std::remove(fresh.c_str());
    throw;
  }
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
  write_all(descriptor_, bytes, file_);
}

void Checkpoint::remove() {
  close(descriptor_);
  descriptor_ = -1;
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

InterruptGuard::InterruptGuard() {
  interrupt_seen = 0;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace hb::tools
