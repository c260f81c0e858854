// hb fit: the damping of one mode of an elastic link from a measured decay or resonance peak.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "hb/analysis/damping_fit.hpp"
#include "lib/scene/quantity.hpp"
#include "lib/scene/scene_reader.hpp"
#include "lib/scene/table_file.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/fit_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

struct FitFlags : CommonFlags {
  std::string decay, peak, rod, column, mode = "1";
};

// The link that --rod names, or the only elastic one.
const Body& fitted_link(const Scene& scene, const std::string& name) {
  const auto* linkage = std::get_if<Linkage>(&scene.model);
  if (linkage == nullptr) throw UsageError("fit: found a [hill] scene, allowed a linkage with elastic links");
  std::vector<std::string> names;
  for (const int link : elastic_links(*linkage)) names.push_back(body_at(*linkage, link)->name);
  if (names.empty()) throw UsageError("fit: found a linkage without elastic links, allowed one with elastic links");
  const std::string wanted = name.empty() && names.size() == 1 ? names.front() : name;
  for (const int link : elastic_links(*linkage))
    if (body_at(*linkage, link)->name == wanted) return *body_at(*linkage, link);
  refuse_flag("--rod", name.empty() ? "nothing" : name, fmt::format("{}", fmt::join(names, ", ")));
}

// Size of the unit in the header in s or rad/s; without one `usual`.
double size_of_unit(const NumberTable& table, Dimension dimension, double usual) {
  if (table.header.empty() || table.header[0].unit.empty()) return usual;
  const UnitText unit = parse_unit(table.header[0].unit);
  if (unit.unit && unit.unit->dimension == dimension) return size_of(*unit.unit);
  throw UsageError(fmt::format("{}: found the unit {} of {}, allowed {}", table.name, table.header[0].unit,
                               table.header[0].name, dimension == dimension::time ? "s, ms, ..." : "Hz, rad/s, rpm"));
}

Eigen::Index value_column(const NumberTable& table, const std::string& name) {
  if (name.empty()) {
    if (table.values.cols() == 2) return 1;
    throw UsageError(
        fmt::format("{}: found {} columns, allowed two, or --column NAME", table.name, table.values.cols()));
  }
  std::vector<std::string> names;
  for (std::size_t k = 1; k < table.header.size(); ++k) {
    if (table.header[k].name == name) return static_cast<Eigen::Index>(k);
    names.push_back(table.header[k].name);
  }
  refuse_flag("--column", name,
              names.empty() ? "a file with a header line" : fmt::format("{}", fmt::join(names, ", ")));
}

Measured measured_of(const FitFlags& flags, const Scene& scene) {
  if (flags.decay.empty() == flags.peak.empty())
    throw UsageError("fit: found " +
                     std::string(flags.decay.empty() ? "neither --decay nor --peak" : "both --decay and --peak") +
                     ", allowed one of the two");
  Measured measured;
  measured.is_peak = flags.decay.empty();
  measured.file = measured.is_peak ? flags.peak : flags.decay;
  const NumberTable table = parse_table(read_text_file(measured.file), measured.file, 0, 2);
  const Eigen::Index column = value_column(table, flags.column);
  const double size = measured.is_peak ? size_of_unit(table, dimension::speed, 2 * std::numbers::pi)
                                       : size_of_unit(table, dimension::time, scene.units.time_in_s);
  measured.at = size * table.values.col(0);
  measured.value = table.values.col(column);
  if (!table.header.empty()) {
    const ColumnName& name = table.header[static_cast<std::size_t>(column)];
    measured.quantity = name.name + (name.unit.empty() ? "" : " [" + name.unit + "]");
  }
  return measured;
}

Figure fit_figure(const Measured& measured, const FittedDamping& fitted, const CsvFile& csv) {
  Figure figure;
  figure.name = "fit";
  figure.commands = fmt::format(
      "set title {}\nset xlabel {}\nset ylabel {}\nset xrange [{}:{}]\nset key outside right top Left reverse samplen "
      "2\n"
      "plot '{}' using 1:2 with points pointtype 7 pointsize 0.4 linecolor rgb '#777777' title 'measured', '' using "
      "1:3 "
      "with lines lt 1 title 'fitted'\nunset title\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset key default\n",
      two_lines(fmt::format("{}, mode {}: damping ratio {}", fitted.rod, fitted.mode,
                            with_bar(fitted.fit.ratio, fitted.fit.ratio_error)),
                literal(measured.file)),
      quoted(csv.columns[0]), quoted(csv.columns[1]), csv.rows(0, 0), csv.rows(csv.rows.rows() - 1, 0), csv.name);
  return figure;
}

int run_fit(const FitFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  const Scene scene = input.source.with(overrides(flags));
  const Output out = output(flags);
  FittedDamping fitted;
  const Body& link = fitted_link(scene, flags.rod);
  fitted.rod = link.name;
  fitted.mode = integer_flag("--mode", flags.mode, 1, max_modes, fmt::format("1 to {}", max_modes));
  const Measured measured = measured_of(flags, scene);
  fitted.scene_frequency = scene_frequency(link, fitted.mode, scene.units);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "fit", provenance(flags.line, input));
  fitted.fit = measured.is_peak ? fit_peak(measured.at, measured.value) : fit_decay(measured.at, measured.value);
  const nlohmann::ordered_json document = fit_json(scene, measured, fitted);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : fit_table(scene, measured, fitted);
  delivery.write_data = [&](OutputFolder& place) -> std::vector<Figure> {
    place.write("fit.json", json_file_text(document));
    const CsvFile csv = fit_csv(scene, measured, fitted);
    place.write(csv.name, csv_text(csv));
    return {fit_figure(measured, fitted, csv)};
  };
  return deliver(folder ? &*folder : nullptr, out.pictures, exit_ok, delivery);
}

}  // namespace

void add_fit_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("fit", "damping of an elastic link's mode from a measured decay or resonance peak");
  const auto flags = std::make_shared<FitFlags>();
  add_scene_flags(*command, *flags);
  command->add_option("--decay", flags->decay, "CSV of a free vibration: time, then values")->type_name("FILE");
  command->add_option("--peak", flags->peak, "CSV of a resonance: frequency, then amplitudes")->type_name("FILE");
  command->add_option("--column", flags->column, "name of the values' column, of several")->type_name("NAME");
  command->add_option("--rod", flags->rod, "the elastic link measured, of several")->type_name("NAME");
  command->add_option("--mode", flags->mode, "its mode, default 1")->type_name("I");
  command->callback([flags, &status] { status = run_fit(*flags); });
}

}  // namespace hb::tools
