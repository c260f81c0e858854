#include "tools/command/scene_input.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <set>
#include <vector>

#include "lib/scene/scene_reader.hpp"
#include "tools/command/version.hpp"

namespace hb::tools {
namespace {

std::string standard_input() {
  constexpr std::size_t most = 16u << 20;
  std::string text;
  std::vector<char> block(1u << 16);
  while (std::cin.read(block.data(), static_cast<std::streamsize>(block.size())), std::cin.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(std::cin.gcount()));
    if (text.size() > most)
      throw SceneError("standard input: found more than 16 MiB, allowed a scene of at most 16 MiB");
  }
  return text;
}

std::string for_shell(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 ||
           std::string("-_./:=,+@%").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace

SceneInput scene_input(const std::string& file) {
  const bool standard = file == "-";
  const std::string name = standard ? "standard input" : file;
  const std::filesystem::path folder = standard ? "." : std::filesystem::path(file).parent_path();
  std::string text = standard ? standard_input() : read_text_file(file);
  SceneSource source(text, name, folder);
  return {name, std::move(text), folder, std::move(source)};
}

std::string command_line(const CLI::App& command) {
  const std::set<std::string> neutral = {"--out",    "--html",      "--json",      "--no-plots", "--format",
                                         "--size",   "--no-titles", "--label",     "--stats",    "--threads",
                                         "--resume", "--restart",   "--time-limit"};
  std::string line = "hb " + command.get_name();
  std::set<const CLI::Option*> seen;
  for (const CLI::Option* option : command.parse_order()) {
    const std::string name = option->get_name();
    if (neutral.count(name) > 0 || !seen.insert(option).second) continue;
    const bool flag = option->get_expected_max() == 0;
    if (flag) line += " " + name;
    for (const std::string& value : flag ? std::vector<std::string>() : option->results())
      line += (option->get_positional() ? " " : " " + name + " ") + for_shell(value);
  }
  return line;
}

Provenance provenance(const std::string& command_line, const SceneInput& scene) {
  return {fmt::format("hb {}", version()), command_line, scene.name, scene.text};
}

}  // namespace hb::tools
