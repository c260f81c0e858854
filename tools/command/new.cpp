// hb new: writes a commented scene that runs at once.
#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "lib/scene/scene_keys.hpp"
#include "lib/scene/scene_reader.hpp"
#include "tools/command/command.hpp"
#include "tools/output/standard_output.hpp"
#include "tools/templates/scene_templates.hpp"

namespace hb::tools {
namespace {

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const SceneTemplate& one : scene_templates()) names.emplace_back(one.name);
  return names;
}

const SceneTemplate& template_of(const std::string& kind) {
  for (const SceneTemplate& one : scene_templates()) {
    if (one.name == kind) return one;
  }
  const std::string near = nearest_name(kind, kinds());
  throw UsageError(fmt::format("KIND: found \"{}\"{}, allowed: {}", hb::printable(kind, 60),
                               near.empty() ? "" : " (" + near + " meant?)", fmt::join(kinds(), ", ")));
}

// A file that is there stays as it is.
void write_new_file(const std::string& name, std::string_view text) {
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST)
    throw UsageError(fmt::format("FILE: found {}, which is there already, allowed: a new file", hb::printable(name)));
  if (file < 0) throw OutputError(fmt::format("{} cannot be written: {}", hb::printable(name), std::strerror(errno)));
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(file, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    written += static_cast<std::size_t>(count);
  }
  const bool closed = close(file) == 0;
  if (written == text.size() && closed) return;
  const std::string why = std::strerror(errno);
  unlink(name.c_str());
  throw OutputError(fmt::format("{} cannot be written: {}", hb::printable(name), why));
}

int run_new(const std::string& kind, const std::string& file) {
  const SceneTemplate& scene = template_of(kind);
  if (file == "-") {
    print_out(std::string(scene.text));
    return exit_ok;
  }
  const std::string name = file.empty() ? kind + ".toml" : file;
  write_new_file(name, scene.text);
  fmt::print("{0} written. Next: hb scene {0}, hb steady {0}\n", hb::printable(name));
  return exit_ok;
}

}  // namespace

void add_new_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("new", "writes a commented scene that runs at once");
  const auto kind = std::make_shared<std::string>(), file = std::make_shared<std::string>();
  command->add_option("KIND", *kind, fmt::format("{}", fmt::join(kinds(), ", ")))->required();
  command->add_option("FILE", *file, "the new file; default KIND.toml; -: standard output");
  command->callback([kind, file, &status] { status = run_new(*kind, *file); });
}

}  // namespace hb::tools
