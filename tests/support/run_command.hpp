// Runs the built `hb` command in a folder of its own and catches what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

struct CommandResult {
  int status = -1;  // exit status; 128 + signal when killed
  std::string out, err;
};

class CommandTest : public testing::Test {
 protected:
  CommandTest() {
    std::string name = (std::filesystem::temp_directory_path() / "hb-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
  }
  ~CommandTest() override { std::filesystem::remove_all(folder_); }

  // `arguments` as typed in a shell; `before` stands in front of the command (VARIABLE=value, ulimit ...;).
  CommandResult hb(const std::string& arguments, const std::string& before = "") const {
    const std::filesystem::path out = folder_ / ".out", err = folder_ / ".err";
    const std::string line = "cd '" + folder_.string() + "' && " + before + " '" HB_COMMAND "' " + arguments + " >'" +
                             out.string() + "' 2>'" + err.string() + "' </dev/null";
    const int status = std::system(line.c_str());
    CommandResult result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read(out), read(err)};
    std::filesystem::remove(out);
    std::filesystem::remove(err);
    return result;
  }

  // Status of the command after a signal (its short name) sent as soon as `file` holds more than its head.
  int stopped_by(const std::string& signal, const std::string& arguments, const std::string& file) const {
    const std::string line =
        "cd '" + folder_.string() + "' && { '" HB_COMMAND "' " + arguments +
        " >/dev/null 2>&1 </dev/null & child=$!; while kill -0 $child 2>/dev/null && [ $(stat -c %s " + file +
        " 2>/dev/null || echo 0) -lt 100 ]; do :; done; kill -" + signal + " $child; wait $child; }";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  static std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  std::size_t num_entries(const std::filesystem::path& folder) const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
    return count;
  }

  static std::string scene(const std::string& name) { return "'" HB_SOURCE_DIR "/tests/scenes/" + name + ".toml'"; }

  std::filesystem::path folder_;
};
