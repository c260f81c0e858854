// The scene that a subcommand was given: a file, or standard input.
#pragma once

#include <filesystem>
#include <string>

#include "lib/scene/scene.hpp"
#include "tools/output/provenance.hpp"

namespace CLI {
class App;
}

namespace hb::tools {

struct SceneInput {
  std::string name;  // as written; "standard input" for -
  std::string text;
  std::filesystem::path folder;  // of further files that it names
  SceneSource source;
};

// Read once, as from a pipe it has to be. Throws SceneError.
[[nodiscard]] SceneInput scene_input(const std::string& file);

// What was given of a subcommand, in its order, as a line for a shell; without what leaves the numbers as they are
// (where they go, how many threads, ...).
[[nodiscard]] std::string command_line(const CLI::App& command);

[[nodiscard]] Provenance provenance(const std::string& command_line, const SceneInput& scene);

}  // namespace hb::tools
