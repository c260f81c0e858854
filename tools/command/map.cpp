// hb map: stability over two numbers of a scene, one of which may be the speed.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/map_output.hpp"
#include "tools/pictures/map_plot.hpp"
#include "hb/analysis/map_result.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/work/parallel_for.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/work/ranks.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_points = 4000000;
constexpr Eigen::Index default_modes = 5;

struct MapFlags : CommonFlags {
  std::string x, y, damping_range, colour = "growth";
  bool resume = false;
};

struct AxisRange {
  PlaneAxis axis;
  std::vector<double> values;
};

AxisRange axis_range(const std::string& flag, const std::string& text) {
  if (text.empty())
    throw UsageError(fmt::format("{}: not given, allowed: PATH=FROM:TO:N, as in rpm=200:6000:100", flag));
  const NamedRange named = named_range(flag, text);
  AxisRange range;
  range.axis.path = named.path;
  range.values = range_by_count(flag, named.range);
  range.axis.from = range.values.front();
  range.axis.to = range.values.back();
  for (std::size_t k = 0; k + 1 < range.values.size(); ++k) {
    if (!(range.values[k] < range.values[k + 1])) {
      throw UsageError(
          fmt::format("{}: found \"{}\", whose points are too close to be told apart; allowed: a wider range "
                      "or fewer points",
                      flag, text));
    }
  }
  if (named.path == "rpm" || named.path == "analysis.rpm") {
    range.axis.role = PlaneAxis::Role::rpm;
  } else if (named.path == "omega" || named.path == "analysis.omega") {
    range.axis.role = PlaneAxis::Role::omega;
  } else if (named.path.starts_with("analysis.")) {
    throw UsageError(fmt::format("{}: found {}, allowed: rpm, omega or a number of the model", flag, named.path));
  }
  if (range.axis.role != PlaneAxis::Role::scene_number && !(range.axis.from > 0)) {
    throw UsageError(fmt::format("{}: found \"{}\", allowed: positive speeds", flag, text));
  }
  return range;
}

bool is_speed(const AxisRange& range) { return range.axis.role != PlaneAxis::Role::scene_number; }

// "AB.J" and "*.J" name one number where AB is elastic.
bool same_number(const SceneSource& source, const std::string& a, const std::string& b) {
  if (a == b) return true;
  const std::string& all = a.starts_with("*.") ? a : b;
  const std::string& one = a.starts_with("*.") ? b : a;
  const std::size_t dot = one.rfind('.');
  if (!all.starts_with("*.") || dot == std::string::npos || one.substr(dot + 1) != all.substr(2)) return false;
  const std::vector<std::string> paths = source.numeric_paths();
  return std::find(paths.begin(), paths.end(), one.substr(0, dot) + ".E") != paths.end();
}

void require_different(const MapFlags& flags, const SceneSource& source, const AxisRange& x, const AxisRange& y) {
  if ((is_speed(x) && is_speed(y)) || same_number(source, x.axis.path, y.axis.path)) {
    throw UsageError(
        fmt::format("--y: found {} beside --x {}, allowed: two different parameters", y.axis.path, x.axis.path));
  }
  for (const AxisRange* range : {&x, &y}) {
    const char* flag = range == &x ? "--x" : "--y";
    for (const Override& set : overrides(flags)) {
      if (same_number(source, set.path, range->axis.path)) {
        throw UsageError(
            fmt::format("--set: found {} beside {} {}, allowed: one of the two", set.path, flag, range->axis.path));
      }
    }
    if (is_speed(*range) && (!flags.rpm.empty() || !flags.omega.empty())) {
      throw UsageError(fmt::format("--{}: found {} beside {} {}, allowed: one of the two",
                                   flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm,
                                   flag, range->axis.path));
    }
  }
}

// Some scene of the map, for what does not depend on the place: the one as written, or one of a corner.
Scene readable_scene(const SceneSource& source, const std::vector<Override>& set, const AxisRange& x,
                     const AxisRange& y) {
  std::optional<ObstructedLinkage> obstructed;
  for (int corner = 0; corner <= 4; ++corner) {
    std::vector<Override> all = set;
    if (corner > 0 && !is_speed(x)) all.push_back(number_override(x.axis.path, corner % 2 ? x.axis.from : x.axis.to));
    if (corner > 0 && !is_speed(y)) all.push_back(number_override(y.axis.path, corner <= 2 ? y.axis.from : y.axis.to));
    try {
      return source.with(all);
    } catch (const ObstructedLinkage& error) {
      obstructed = error;
    }
  }
  throw ObstructedLinkage(*obstructed);
}

MapColour colour_flag(const std::string& text) {
  if (text == "growth") return MapColour::growth;
  if (text == "turn") return MapColour::per_turn;
  if (text == "tenfold") return MapColour::tenfold_time;
  throw UsageError(fmt::format("--colour: found \"{}\", allowed: growth, turn, tenfold", text));
}

struct Factors {
  double low, high;
};

std::optional<Factors> damping_factors(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::string allowed = "LOW:HIGH with 0 <= LOW < HIGH, factors on the damping";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  const double most = std::numeric_limits<double>::max();
  const Factors factors{number_flag("--damping-range", text.substr(0, colon), 0, most, allowed),
                        number_flag("--damping-range", text.substr(colon + 1), 0, most, allowed)};
  if (!(factors.low < factors.high)) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  return factors;
}

// Internal damping of the elastic links, or the whole damping matrix of a [hill] scene, times a factor.
std::vector<Override> damping_overrides(const SceneSource& source, const Scene& scene, const AxisRange& x,
                                        const AxisRange& y, double factor) {
  std::vector<Override> result;
  const bool hill = std::holds_alternative<HillSystem>(scene.model);
  for (const std::string& path : source.numeric_paths()) {
    if (!(hill ? path.starts_with("hill.damping.") : path.ends_with(".damping_internal"))) continue;
    for (const AxisRange* range : {&x, &y}) {
      if (same_number(source, path, range->axis.path)) {
        throw UsageError(fmt::format("--damping-range: found beside {}, allowed: parameters other than the damping",
                                     range->axis.path));
      }
    }
    result.push_back(number_override(path, factor * source.value(path)));
  }
  if (result.empty()) throw UsageError("--damping-range: the scene gives no damping to multiply");
  return result;
}

std::vector<Figure> write_tables(const MapDocument& document, MapColour colour, OutputFolder& folder) {
  const MapResult& result = document.result;
  const auto write = [&](const CsvFile& file) {
    folder.write(file.name, csv_text(file));
    return file.name;
  };
  MapFiles files;
  files.grid = write(map_grid_csv(document));
  files.boundaries = write(
      map_boundary_csv(document, result.boundaries, "map_boundaries.csv", "boundaries of stability of the worst rod"));
  for (std::size_t r = 0; r < result.rods.size() && result.rods.size() > 1; ++r) {
    std::vector<RodCurve> own;
    for (const BoundaryCurve& curve : result.maps[r].boundaries) own.push_back({r, curve});
    write(map_boundary_csv(document, own, file_name("map_boundaries_" + result.rods[r]) + ".csv",
                           "boundaries of stability of " + result.rods[r]));
  }
  files.resonance = write(map_resonance_csv(document));
  for (const DampingCurves& damping : result.damping) {
    files.damping.push_back(write(map_boundary_csv(
        document, damping.boundaries, file_name(fmt::format("map_boundaries_damping_{:g}", damping.factor)) + ".csv",
        fmt::format("boundaries of stability of the worst rod with damping times {:g}", damping.factor))));
  }
  return {map_figure(document, files, colour)};
}

// Of everything that the map depends on; numbers of the scene by what they lead to, at the corners and inside.
std::uint64_t map_key(const ScenePlane& plane, const AxisRange& x, const AxisRange& y, const Settings& settings,
                      const std::optional<Factors>& factors) {
  TaskKey key;
  key.add("map");
  for (const AxisRange* range : {&x, &y}) {
    key.add(range->axis.path);
    for (const double value : range->values) key.add(value);
  }
  key.add(settings.tolerance).add(static_cast<double>(settings.stability_method));
  key.add(factors ? factors->low : -1).add(factors ? factors->high : -1);
  for (const double s : {0.0, 0.37, 1.0}) {
    for (const double t : {0.0, 0.61, 1.0}) {
      for (std::size_t r = 0; r < plane.rods().size(); ++r) {
        key.add(plane.rods()[r]);
        const std::optional<ScaledSystem> system =
            plane.system(r, x.axis.from + s * (x.axis.to - x.axis.from), y.axis.from + t * (y.axis.to - y.axis.from));
        key.add(system ? static_cast<double>(system->num_modes()) : -1);
        if (!system) continue;
        key.add(system->speed);
        for (const double value : system->G.reshaped()) key.add(value);
        for (const std::complex<double> value : system->K.c.reshaped()) key.add(value.real()).add(value.imag());
      }
    }
  }
  return key.value();
}

int run_map(const MapFlags& flags) {
  const AxisRange x = axis_range("--x", flags.x), y = axis_range("--y", flags.y);
  const MapColour colour = colour_flag(flags.colour);
  const std::optional<Factors> factors = damping_factors(flags.damping_range);
  if (static_cast<double>(x.values.size()) * static_cast<double>(y.values.size()) > max_points) {
    throw UsageError(fmt::format("--x, --y: found {} x {} points, allowed: at most {} in all", x.values.size(),
                                 y.values.size(), max_points));
  }
  const SceneSource source(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  require_different(flags, source, x, y);
  const Scene scene = readable_scene(source, set, x, y);
  const Settings options = settings(flags, scene);
  if (!options.only.stability) throw UsageError(fmt::format("--only: found \"{}\", allowed: stability", flags.only));

  PlaneOptions plane_options;
  plane_options.num_modes = std::holds_alternative<int>(options.modes) ? std::get<int>(options.modes) : default_modes;
  if (!is_speed(x) && !is_speed(y)) plane_options.speed = single_speed(flags, scene);
  plane_options.rods = options.rods;
  plane_options.parallel_for = [&options](std::size_t count, const std::function<void(std::size_t)>& work) {
    parallel_for(count, options.threads, work);
  };
  const auto plane_with = [&](const std::vector<Override>& further) {
    std::vector<Override> all = set;
    all.insert(all.end(), further.begin(), further.end());
    return ScenePlane(source, all, x.axis, y.axis, plane_options);
  };

  std::optional<OutputFolder> folder;
  if (options.out && ranks().first()) folder.emplace(*options.out);
  MapOptions search;
  search.search.stability.method = options.stability_method;
  search.search.stability.tolerance = std::clamp(options.tolerance, 1e-13, 1e-9);
  search.search.tolerance = std::clamp(0.1 * options.tolerance, 1e-14, 1e-6);

  const ScenePlane plane = plane_with({});
  MapResult result;
  const auto compute = [&](SharedWork& work) {
    search.parts = work.of("stability map, this step");
    result = compute_map(plane, x.axis, x.values, y.axis, y.values, search);
    if (!factors) return;
    const std::filesystem::path file(flags.scene_file);
    const SceneSource as_set(source.text_with(set), flags.scene_file, file.parent_path());
    for (const double factor : {factors->low, factors->high}) {
      const ScenePlane damped = plane_with(damping_overrides(as_set, scene, x, y, factor));
      MapOptions curves = search;
      curves.curves_only = true;
      std::vector<StabilityMap> maps;
      for (std::size_t r = 0; r < damped.rods().size(); ++r) {
        maps.push_back(rod_map(damped, r, x.values, y.values, curves));
      }
      result.damping.push_back({factor, worst_boundaries(damped, maps, search)});
    }
  };
  if (!run_kept("map", options.out, flags.resume, map_key(plane, x, y, options, factors), options.threads, compute)) {
    return exit_interrupted;
  }

  const MapDocument document{result, plane.scene(), plane_options.num_modes, search.search.tolerance};
  const nlohmann::ordered_json json = options.json || folder ? map_json(document) : nlohmann::ordered_json();
  if (folder) {
    folder->write("map.json", json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    draw_figures(write_tables(document, colour, *folder), *folder, options.plots);
    folder->commit();
  }
  if (options.json) {
    print_json(json);
  } else {
    fmt::print("{}", map_summary(document));
  }
  if (options.stats && !options.json) {
    std::size_t samples = 0;
    for (const StabilityMap& map : result.maps) samples += map.samples;
    fmt::print(stderr, "\n  {}; exponents at {} places\n", plane.evidence(), samples);
  }
  return boundary_points_not_reached(result) == 0 ? exit_ok : exit_not_reached;
}

}  // namespace

void add_map_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "map", "stability over two parameters: growth rate on a grid, boundaries with their kind, resonance lines");
  const auto flags = std::make_shared<MapFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  command->add_option("--x", flags->x, "first parameter, as in rpm=200:6000:100 (N points)")->type_name("PATH=A:B:N");
  command->add_option("--y", flags->y, "second parameter, as in AB.J=30:60:50 or *.J=30:60:50")
      ->type_name("PATH=A:B:N");
  command
      ->add_option("--damping-range", flags->damping_range,
                   "boundaries also with the internal damping (of a [hill] scene: the damping) times both factors")
      ->type_name("A:B");
  command
      ->add_option("--colour", flags->colour, "colours of the picture: growth, turn (growth per turn), tenfold (time)")
      ->type_name("WHAT");
  command->add_flag("--resume", flags->resume, "go on where an interrupted run into the same --out stopped");
  command->callback([flags, &status] { status = run_map(*flags); });
}

}  // namespace hb::tools
