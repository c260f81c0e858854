// hb compare: two steady answers or two sweeps side by side, of scenes or of folders that hb wrote.
#include "tools/command/compare.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/compare_sides.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/version.hpp"
#include "tools/output/compare_along.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/compare_figures.hpp"

namespace hb::tools {
namespace {

std::vector<Figure> steady_files(const ComparedSide& a, const ComparedSide& b, OutputFolder& place) {
  std::vector<Figure> figures;
  for (const CsvFile& file : compare_csvs(a, b)) {
    place.write(file.name, csv_text(file));
    figures.push_back(compare_response_figure(a, b, file));
  }
  return figures;
}

std::vector<Figure> along_files(const ComparedSide& a, const ComparedSide& b, OutputFolder& place) {
  std::vector<Figure> figures;
  for (const AlongCurves& curves : along_curves(a, b)) {
    place.write(curves.a.name, csv_text(curves.a));
    place.write(curves.b.name, csv_text(curves.b));
    figures.push_back(compare_along_figure(a, b, curves));
  }
  return figures;
}

int run_compare(const CompareFlags& flags) {
  const Output out = output(flags);
  const auto [a, b, texts] = compared_sides(flags, out.threads);
  std::optional<OutputFolder> folder;
  if (out.folder)
    folder.emplace(
        *out.folder, "compare",
        Provenance{fmt::format("hb {}", version()), flags.line, flags.scene_file + ", " + flags.other, texts});
  const Json document = is_along(a) ? compare_along_json(a, b) : compare_json(a, b);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : is_along(a) ? compare_along_table(a, b) : compare_table(a, b);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("compare.json", json_file_text(document));
    return is_along(a) ? along_files(a, b, place) : steady_files(a, b, place);
  };
  const auto reached = [](const ComparedSide& one) { return one.document.value("status", "reached") == "reached"; };
  return deliver(folder ? &*folder : nullptr, out.pictures, reached(a) && reached(b) ? exit_ok : exit_not_reached,
                 delivery);
}

}  // namespace

void add_compare_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "two designs side by side at one speed or along speeds: scenes, or folders that hb steady --out or "
      "hb sweep --out wrote");
  const auto flags = std::make_shared<CompareFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  command->get_option("--rpm")->description("speed of the crank in revolutions per minute, or a range: then sweeps");
  command->get_option("SCENE")->description(
      "a scene file (TOML), or a folder that hb steady --out or hb sweep --out wrote");
  command->add_option("B", flags->other, "the other scene, or folder")->required();
  command->add_option("--set-b", flags->set_b, "a number of the second scene alone, as in AB.J=60; repeatable")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->callback([flags, &status] { status = run_compare(*flags); });
}

}  // namespace hb::tools
