#include "tools/command/dispatch.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <exception>
#include <iterator>
#include <new>
#include <nlohmann/json.hpp>
#include <regex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/compare.hpp"
#include "tools/command/version.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/speaker.hpp"
#include "tools/work/ranks.hpp"

namespace hb::tools {
namespace {

std::string unknown_command(const CLI::App& app, const std::string& found) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  const std::string near = nearest_name(found, names);
  return fmt::format("found the command \"{}\"{}, allowed {}", found, near.empty() ? "" : " (" + near + " meant?)",
                     fmt::join(names, ", "));
}

// "--rmp 300": names each flag that is none, with the nearest one.
std::string unknown_flags(const CLI::App& command, const std::vector<std::string>& words) {
  std::vector<std::string> names, sentences;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string& found : words) {
    const bool single = found.size() > 2 && found[0] == '-' && std::isalpha(static_cast<unsigned char>(found[1]));
    if (!single && !found.starts_with("--")) continue;
    const std::string flag = found.substr(0, found.find('='));
    if (std::ranges::find(names, flag) != names.end()) continue;
    const std::string near = nearest_name((single ? "-" : "") + flag, names);
    sentences.push_back(fmt::format("found the unknown flag {}{}", flag, near.empty() ? "" : " (" + near + " meant?)"));
  }
  return fmt::format("{}", fmt::join(sentences, ", "));
}

// CLI11's sentences on a flag's number of values, in words that say what is allowed.
std::string plain(const std::string& sentence) {
  std::smatch part;
  if (std::regex_match(sentence, part, std::regex("(\\S+): At Most 1 required but received (\\d+)")))
    return fmt::format("{}: found {} times, allowed once", part[1].str(), part[2].str());
  if (std::regex_match(sentence, part, std::regex("(\\S+): (\\d+) required (\\S+) missing")))
    return fmt::format("{}: found nothing behind it, allowed {}", part[1].str(), part[3].str());
  return sentence;
}

struct Command {
  std::string_view name;
  void (*add)(CLI::App& app, int& status);
};
constexpr Command commands[] = {
    {"new", add_new_command},         {"scene", add_scene_command}, {"steady", add_steady_command},
    {"sweep", add_sweep_command},     {"map", add_map_command},     {"check", add_check_command},
    {"bench", add_bench_command},     {"tune", add_tune_command},   {"report", add_report_command},
    {"compare", add_compare_command}, {"fit", add_fit_command},
};

// The one that is asked for, which speaks from here on; the flags of all others would take longer to set up than many
// an answer. All where none of them is.
void add_commands(CLI::App& app, const std::string& asked, int& status) {
  const bool known = std::ranges::find(commands, asked, &Command::name) != std::end(commands);
  speak_as(known ? asked : "");
  for (const Command& command : commands)
    if (!known || command.name == asked) command.add(app, status);
}

}  // namespace

int say(int status, const std::string& what) {
  fmt::print(stderr, "{}: {}\n", speaker(), printable(what));
  return status;
}

int run(int argc, char** argv) {
  CLI::App app{
      "Periodic vibration and dynamic stability of linkages with elastic links, by harmonic balance.\n\n"
      "To begin:\n"
      "  hb new slider-crank crank.toml       a first scene, with comments\n"
      "  hb sweep crank.toml --out first      vibration, resonances and unstable speeds, pictures in the folder "
      "first\n\n"
      "Exit status: 0 done, 1 disagreement found by a check or internal error, 2 wrong input or output that cannot be\n"
      "written, 3 a tolerance asked for not reached, 4 data complete but pictures missing, 130 interrupted.",
      "hb"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version());
  int status = exit_ok;
  add_commands(app, argc > 1 ? argv[1] : "", status);
  if (argc == 1) {  // nothing asked
    fmt::print(stderr, "{}", app.help());
    return exit_wrong_input;
  }
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() > 1 && (words[0] == "help" || words[0] == "--help")) words = {words[1], "--help"};
    std::ranges::reverse(words);  // as CLI11 takes them
    app.parse(std::move(words));
    return status;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc > 1 && app.get_subcommands().empty()) {
      return say(exit_wrong_input, unknown_command(app, argv[1]));
    }
    constexpr int extras = static_cast<int>(CLI::ExitCodes::ExtrasError);
    const auto chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "hb" : "hb " + chosen.front()->get_name();
    std::string what = error.get_exit_code() == extras && !chosen.empty()
                           ? unknown_flags(*chosen.front(), {argv + 1, argv + argc})
                           : "";
    if (what.empty()) what = plain(error.what());
    fmt::print(stderr, "{}: {} (`{} --help` lists what is allowed)\n", command, printable(what), command);
    return exit_wrong_input;
  } catch (const UnresolvedLinkage& error) {
    const bool as_json = std::ranges::any_of(std::span(argv, static_cast<std::size_t>(argc)),
                                             [](const char* word) { return std::string_view(word) == "--json"; });
    if (as_json)
      fmt::print("{}\n", json_text({{"status", "tolerance not reached"}, {"notes", {printable(error.what())}}}));
    return say(exit_not_reached, error.what());
  } catch (const SceneError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const RequestError& error) {
    return say(exit_wrong_input, in_flags(error));
  } catch (const UsageError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const OutputError& error) {
    return say(exit_wrong_input, error.what());
  } catch (const ShareDone&) {
    return exit_ok;
  } catch (const OtherRankFailed&) {
    return exit_failed;
  } catch (const std::bad_alloc&) {
    return say(exit_failed, "out of memory");
  } catch (const std::exception& error) {
    return say(exit_failed, fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace hb::tools
