// hb compare: two steady answers side by side, of scenes or of folders that hb steady wrote.
#include "tools/command/compare.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include "hb/analysis/steady.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/version.hpp"
#include "tools/output/compare_output.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

namespace fs = std::filesystem;

struct CompareFlags : CommonFlags {
  std::string other;
  std::vector<std::string> set_b;
};

bool is_document(const fs::path& place) { return fs::is_directory(place) || place.extension() == ".json"; }

// What hb steady left in a folder, or in a file.
ComparedSide from_files(const std::string& given) {
  const fs::path file = fs::is_directory(given) ? fs::path(given) / "steady.json" : fs::path(given);
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  const Json document = stream ? Json::parse(text.str(), nullptr, false) : Json();
  const bool usable = document.is_object() && document.contains("rods") && document["rods"].is_object() &&
                      document.contains("units") && document.contains("omega") && document["omega"].is_number();
  if (!usable)
    throw UsageError(fmt::format("{}: found {}, allowed a scene, or a folder or file that `hb steady --out` wrote",
                                 given, stream ? "no answer of hb steady in " + file.string() : "no " + file.string()));
  return {given, document};
}

ComparedSide computed(const CompareFlags& flags, const SceneInput& input, const std::vector<std::string>& more) {
  CommonFlags own = flags;
  own.set.insert(own.set.end(), more.begin(), more.end());
  const Scene scene = input.source.with(overrides(own));
  Request request = asked_request(own, scene);
  set_speed(request, first_speed(own, scene));
  const SteadyResult result = steady(scene, request);
  std::string source = input.name;
  for (const std::string& set : more) source += " --set " + set;
  return {source, steady_json(*result.model, result, result.settings, false)};
}

Figure response_figure(const ComparedSide& a, const ComparedSide& b, const CsvFile& csv) {
  Figure figure;
  figure.name = csv.name.substr(0, csv.name.size() - std::string(".csv").size());
  figure.commands = fmt::format(
      "set title {}\nset xrange [0:360]\nset xtics 0,60,360\nset xlabel 'crank angle [deg]'\nset ylabel {}\n"
      "set key outside right top Left reverse samplen 2\nplot '{}' using 1:2 with lines lt 1 title 'A', '' using 1:3 "
      "with lines lt 2 title 'B'\nunset title\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset xtics autofreq\nset "
      "key "
      "default\n",
      two_lines(figure.name.substr(std::string("compare_").size()) + ", response over the turn",
                literal(fmt::format("A: {}, {}", a.source, side_verdict(a))) + "\n" +
                    literal(fmt::format("B: {}, {}", b.source, side_verdict(b)))),
      quoted(csv.columns[1].substr(0, 3) + csv.columns[1].substr(5)), csv.name);
  return figure;
}

int run_compare(const CompareFlags& flags) {
  const Output out = output(flags);
  std::string texts;
  const auto side = [&](const std::string& given, const std::vector<std::string>& more) {
    if (is_document(given)) {
      if (!more.empty()) throw UsageError("--set-b: found beside a folder of results, allowed: beside a scene");
      return from_files(given);
    }
    const SceneInput input = scene_input(given);
    texts += input.text;
    return computed(flags, input, more);
  };
  const ComparedSide a = side(flags.scene_file, {}), b = side(flags.other, flags.set_b);
  if (a.document["rods"].contains("system") != b.document["rods"].contains("system"))
    throw UsageError("compare: found a mechanism and a [hill] scene, allowed: two of one kind");
  std::optional<OutputFolder> folder;
  if (out.folder)
    folder.emplace(
        *out.folder, "compare",
        Provenance{fmt::format("hb {}", version()), flags.line, flags.scene_file + ", " + flags.other, texts});
  const Json document = compare_json(a, b);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : compare_table(a, b);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("compare.json", json_file_text(document));
    std::vector<Figure> figures;
    for (const CsvFile& file : compare_csvs(a, b)) {
      place.write(file.name, csv_text(file));
      figures.push_back(response_figure(a, b, file));
    }
    return figures;
  };
  const auto reached = [](const ComparedSide& one) { return one.document.value("status", "reached") == "reached"; };
  return deliver(folder ? &*folder : nullptr, out.pictures, reached(a) && reached(b) ? exit_ok : exit_not_reached,
                 delivery);
}

}  // namespace

void add_compare_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("compare", "two designs side by side: scenes, or folders that hb steady --out wrote");
  const auto flags = std::make_shared<CompareFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags, SpeedsTaken::one);
  command->get_option("SCENE")->description("a scene file (TOML), or a folder that hb steady --out wrote");
  command->add_option("B", flags->other, "the other scene, or folder")->required();
  command->add_option("--set-b", flags->set_b, "a number of the second scene alone, as in AB.J=60; repeatable")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->callback([flags, &status] { status = run_compare(*flags); });
}

}  // namespace hb::tools
