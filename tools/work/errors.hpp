// Errors that end a command with a sentence.
#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace hb::tools {

// A wrong flag: what() names the flag, what was found and what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Output that cannot be written: what() names the path and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] inline void refuse_output(const std::filesystem::path& path, const std::string& reason) {
  throw OutputError(fmt::format("--out: {} cannot be written: {}", path.string(), reason));
}

}  // namespace hb::tools
