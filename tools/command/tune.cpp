// hb tune: scene numbers that minimise a goal under conditions, worst over a range of speeds.
#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/output/table_output.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/pictures/tune_pictures.hpp"
#include "tools/report/report_data.hpp"
#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct TuneFlags : CommonFlags {
  std::string theory = "linear";
  std::string minimise, maximise, over, algorithm, seed, analyses, speeds;
  std::vector<std::string> vary, keep, tie, height;
};

constexpr double largest = std::numeric_limits<double>::max();

// "A:B" with A < B.
std::pair<double, double> bounds(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string allowed = "FROM:TO, two finite numbers with FROM < TO";
  if (colon == std::string::npos)
    throw UsageError(fmt::format("{}: found \"{}\", a single value; allowed: {}", flag, text, allowed));
  const double a = number_flag(flag, text.substr(0, colon), -largest, largest, allowed);
  const double b = number_flag(flag, text.substr(colon + 1), -largest, largest, allowed);
  if (a == b) throw UsageError(fmt::format("{}: found \"{}\", an empty range; allowed: {}", flag, text, allowed));
  if (!(a < b) || !std::isfinite(b - a))
    throw UsageError(
        fmt::format("{}: found \"{}\", which runs backwards or is too wide; allowed: {}", flag, text, allowed));
  return {a, b};
}

// The scene with one number replaced must be a scene, turning through or not.
void require_scene(const SceneSource& source, const std::string& path, double value) {
  try {
    (void)source.with({number_override(path, value)});
  } catch (const ObstructedLinkage&) {  // an infeasible design
  }
}

bool is_speed(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

// Moved into the bounds if need be.
void start_at(TuneVariable& variable, double value) {
  variable.start = std::clamp(value, variable.lower, variable.upper);
  if (variable.start == value) return;
  variable.moved_from = value;
  fmt::print(stderr, "hb tune: {} = {:g} lies outside {:g} to {:g}; the search starts at {:g}\n", variable.path, value,
             variable.lower, variable.upper, variable.start);
}

void require_mechanism(const char* flag, const std::string& path) {
  if (path.starts_with("analysis.") || path.starts_with("units."))
    throw UsageError(fmt::format("{}: found {}, allowed: numbers of the mechanism", flag, path));
}

void add_ties(const TuneFlags& flags, const SceneSource& source, std::vector<TuneVariable>& variables) {
  for (const std::string& text : flags.tie) {
    const NamedRange tie = named_range("--tie", text);
    const std::size_t star = tie.range.rfind('*');
    const bool scaled = star != std::string::npos && star > 0;
    TiedNumber tied{tie.path, 1};
    const std::string path = scaled ? tie.range.substr(star + 1) : tie.range;
    if (scaled)
      tied.factor = number_flag("--tie", tie.range.substr(0, star), -largest, largest, "PATH=PATH or PATH=FACTOR*PATH");
    const auto leader = std::ranges::find(variables, path, &TuneVariable::path);
    if (leader == variables.end())
      throw UsageError(fmt::format("--tie: found \"{}\", allowed: PATH=FACTOR*VARIED with one of --vary, {}", text,
                                   fmt::join(flags.vary, ", ")));
    for (const TuneVariable& variable : variables) {
      bool taken = variable.path == tie.path;
      for (const TiedNumber& other : variable.tied) taken = taken || other.path == tie.path;
      if (taken) throw UsageError(fmt::format("--tie: found {}, which is varied or tied already", tie.path));
    }
    require_mechanism("--tie", tie.path);
    (void)source.value(tie.path);
    leader->tied.push_back(tied);
  }
}

// Ends of the speed range start later, in `start_speeds`.
std::vector<TuneVariable> variables(const TuneFlags& flags, const SceneSource& source) {
  std::vector<TuneVariable> result;
  for (const std::string& text : flags.vary) {
    const NamedRange range = named_range("--vary", text);
    const auto [a, b] = bounds("--vary " + range.path, range.range);
    TuneVariable variable{range.path, a, b, a, std::nullopt, {}};
    for (const TuneVariable& other : result)
      if (other.path == range.path) throw UsageError(fmt::format("--vary: found {} twice, allowed: once", range.path));
    require_mechanism("--vary", range.path);
    if (!is_speed(variable)) start_at(variable, source.value(range.path));
    result.push_back(std::move(variable));
  }
  add_ties(flags, source, result);
  // Conditions between numbers (a wall within its tube) are the search's business; each alone must be possible at one
  // end at least.
  for (const TuneVariable& variable : result) {
    if (is_speed(variable)) continue;
    try {
      require_scene(source, variable.path, variable.lower);
    } catch (const SceneError& problem) {
      require_scene(source, variable.path, variable.start);
      if (variable.lower <= 0)
        throw UsageError(fmt::format("--vary {}={:g}:{:g}: its lower bound makes no scene: {}", variable.path,
                                     variable.lower, variable.upper, problem.what()));
    }
  }
  return result;
}

// Where the linkage does not close at the start, moves that to a design within the bounds that does, and says so.
void close_start(TuneTask& task) {
  std::string obstruction;
  const auto closes = [&](const std::vector<double>& x) {
    try {
      Settings settings;
      settings.modes = 1;
      (void)make_model(task.source.with(overrides_at(task, x)), settings);
      return true;
    } catch (const ObstructedLinkage& problem) {
      if (obstruction.empty()) obstruction = problem.what();
    }
    return false;
  };
  if (closes(start_of(task))) return;
  // The first that closes of evenly spread designs: fractions of k/g, k/g^2, ... with g^(n+1) = g + 1 (M. Roberts'
  // additive recurrence).
  constexpr int count = 400;
  const std::size_t n = task.variables.size();
  double g = 2;
  for (int k = 0; k < 60; ++k) g = std::pow(1 + g, 1.0 / static_cast<double>(n + 1));
  std::optional<std::vector<double>> found;
  for (int k = 0; k < count && !found; ++k) {
    std::vector<double> x;
    for (const TuneVariable& variable : task.variables) {
      const double u = std::fmod(0.5 + k * std::pow(g, -static_cast<double>(x.size() + 1)), 1.0);
      x.push_back(variable.lower + u * (variable.upper - variable.lower));
    }
    try {
      if (closes(x)) found = std::move(x);
    } catch (const SceneError&) {  // no possible scene
    }
  }
  if (!found)
    throw UsageError(
        fmt::format("--vary: found no design within the bounds whose linkage closes, of {} looked at ({}); allowed: "
                    "bounds with some",
                    count, obstruction));
  std::string start;
  for (std::size_t i = 0; i < n; ++i) {
    TuneVariable& variable = task.variables[i];
    if (is_speed(variable)) continue;
    if (!variable.moved_from) variable.moved_from = variable.start;
    variable.start = (*found)[i];
    start += fmt::format("{}{} = {:.6g}", start.empty() ? "" : ", ", variable.path, variable.start);
  }
  fmt::print(stderr, "hb tune: the linkage does not close at the start; the search starts from {}, where it does\n",
             start);
}

void start_speeds(TuneTask& task) {
  double lowest_to = task.span.to / task.speed_unit, highest_from = task.span.from / task.speed_unit;
  bool any = false;
  for (TuneVariable& variable : task.variables) {
    if (!is_speed(variable)) continue;
    any = true;
    const bool from = variable.path == range_from;
    if (!(variable.lower > 0))
      throw UsageError(fmt::format("--vary: found {} from {:g}, allowed: speeds > 0", variable.path, variable.lower));
    start_at(variable, (from ? task.span.from : task.span.to) / task.speed_unit);
    (from ? highest_from : lowest_to) = from ? variable.upper : variable.lower;
  }
  if (any && !(highest_from < lowest_to))
    throw UsageError(
        fmt::format("--vary: found speed ranges from {:g} to {:g}, allowed: from below to", highest_from, lowest_to));
}

// --over rpm=A:B, else the scene's or the flags' speed.
std::pair<SpeedSpan, bool> span_of(const TuneFlags& flags, const Scene& scene) {
  SpeedSpan span;
  if (!flags.speeds.empty()) span.num_nodes = integer_flag("--speeds", flags.speeds, 2, 10000, "an integer 2 to 10000");
  bool in_rpm = true;
  double from = 0, to = 0;
  if (flags.over.empty()) {
    const SpeedRange range = speed_range(flags, scene);
    in_rpm = range.in_rpm;
    from = range.speeds.from;
    to = range.speeds.to;
  } else {
    const NamedRange range = named_range("--over", flags.over);
    if (range.path != "rpm" && range.path != "omega")
      throw UsageError(fmt::format("--over: found {}, allowed: rpm=FROM:TO or omega=FROM:TO", range.path));
    if (!flags.rpm.empty() || !flags.omega.empty())
      throw UsageError("--over: found beside --rpm or --omega, allowed: one of them");
    in_rpm = range.path == "rpm";
    std::tie(from, to) = bounds("--over " + range.path, range.range);
  }
  span.from = in_rpm ? speed_from_rpm(from, scene.units) : from;
  span.to = in_rpm ? speed_from_rpm(to, scene.units) : to;
  if (!(span.from >= std::numeric_limits<double>::min() && std::isfinite(span.to)))
    throw UsageError(fmt::format("--over: found speeds from {:g}, allowed: positive ones", from));
  return {span, in_rpm};
}

DesignOptions design_options(const TuneFlags& flags, std::size_t num_variables) {
  DesignOptions options;
  options.max_evaluations = 400 + 100 * static_cast<int>(std::min<std::size_t>(num_variables, 100));
  if (!flags.analyses.empty())
    options.max_evaluations = integer_flag("--analyses", flags.analyses, 2, 1000000, "an integer 2 to 1000000");
  if (!flags.seed.empty())
    options.seed = static_cast<std::uint64_t>(
        integer_flag("--seed", flags.seed, 0, std::numeric_limits<int>::max(), "an integer >= 0"));
  if (!flags.algorithm.empty()) {
    std::string names;
    bool known = false;
    for (const DesignAlgorithm algorithm :
         {DesignAlgorithm::automatic, DesignAlgorithm::direct, DesignAlgorithm::mlsl, DesignAlgorithm::cobyla,
          DesignAlgorithm::bobyqa, DesignAlgorithm::slsqp, DesignAlgorithm::mma}) {
      names += (names.empty() ? "" : ", ") + std::string(to_string(algorithm));
      if (flags.algorithm != to_string(algorithm)) continue;
      options.algorithm = algorithm;
      known = true;
    }
    if (!known) throw UsageError(fmt::format("--algorithm: found \"{}\", allowed: {}", flags.algorithm, names));
  }
  if (isatty(STDERR_FILENO) != 0) {
    const double sign = flags.maximise.empty() ? 1 : -1;
    options.progress = [sign](int evaluations, bool feasible, double goal) {
      fmt::print(stderr, "\r\033[Ktune: {} designs, best {}{:.6g}", evaluations,
                 feasible ? "" : "(conditions not met) ", sign * goal);
    };
  }
  return options;
}

// Heights are for rods without a section, where something asks for stress.
void require_heights(const TuneTask& task, const Scene& scene) {
  const std::map<std::string, double>& heights = task.heights;
  if (heights.empty()) return;
  const std::vector<std::string> paths = task.source.numeric_paths();
  std::vector<std::string> without, with;  // a section
  if (const auto* linkage = std::get_if<Linkage>(&scene.model)) {
    for (const int link : elastic_links(*linkage)) {
      const std::string name = body_name(*linkage, link);
      const bool section = std::ranges::any_of(paths, [&](const std::string& path) {
        return path.starts_with(name + ".section.") || path.starts_with(name + ".elastic.section.");
      });
      (section ? with : without).push_back(name);
    }
  }
  std::vector<std::string> allowed = without;
  if (!without.empty()) allowed.insert(allowed.begin(), "*");
  const std::string list = allowed.empty() ? "no --height" : fmt::format("{}", fmt::join(allowed, ", "));
  for (const auto& [name, height] : heights) {
    if (std::ranges::find(allowed, name) != allowed.end()) continue;
    if (name == "*" || std::ranges::find(with, name) != with.end())
      throw UsageError(fmt::format(
          "--height: found {}={:g}, where the section in the scene gives the height; allowed: {}", name, height, list));
    throw UsageError(fmt::format("--height: found {}, no elastic link of the scene; allowed: {}", name, list));
  }
  if (heights.contains("*") && heights.size() > 1)
    throw UsageError("--height: found * beside a rod's name, allowed: * alone, or one for each rod");
  const auto is_stress = [](const Metric& metric) { return metric.kind == MetricKind::stress; };
  if (std::ranges::none_of(task.goal.terms, is_stress, &GoalTerm::metric) &&
      std::ranges::none_of(task.keeps, is_stress, &Keep::metric))
    throw UsageError(fmt::format("--height: found {}={:g}, allowed: with stress as goal or condition",
                                 heights.begin()->first, heights.begin()->second));
}

void require_algorithm(const TuneTask& task) {
  if (task.options.algorithm != DesignAlgorithm::bobyqa) return;
  constexpr const char* allowed = "allowed: automatic, direct, mlsl, cobyla, slsqp, mma";
  if (!task.keeps.empty())
    throw UsageError(fmt::format("--algorithm: found bobyqa, which takes no conditions, with --keep; {}", allowed));
  if (task.variables.size() < 2)
    throw UsageError(fmt::format("--algorithm: found bobyqa, which needs two variables, with one --vary; {}", allowed));
}

// The design after along its speeds, beside the design before.
std::string design_page(const TuneTask& task, const TuneResult& result, const Scene& before,
                        const nlohmann::ordered_json& document, int threads, PageText text) {
  constexpr int points = 49;
  const SpeedSpan& span = result.span_after;
  const std::vector<Override> tuned = overrides_at(task, result.tuned);
  const Scene after = task.source.with(tuned);
  ReportData data(after);
  SharedWork work(threads);
  if (span.from < span.to) {
    Axis axis;
    axis.kind = task.in_rpm ? Axis::Kind::rpm : Axis::Kind::omega;
    axis.path = task.in_rpm ? "rpm" : "omega";
    axis.values = evenly(span.from / task.speed_unit, span.to / task.speed_unit, points);
    const SweepScene along(task.source, tuned, task.settings, axis, span.from, axis.values.front());
    data.add_sweep(along, run_sweep(along, work), places_along(along, work));
  } else {
    const auto model = std::make_shared<const SceneModel>(make_model(after, task.settings));
    data.add_speed({model, analyse(*model, span.from, task.settings), ""}, task.settings);
  }
  std::vector<ReportData::DesignCurve> curves;
  if (result.curves_before && result.curves_after) {
    const auto speeds = [&](const DesignCurves& design) {
      std::vector<double> x;
      for (const double speed : design.speed) x.push_back(speed / task.speed_unit);
      return x;
    };
    const auto values = [](const auto& column) {
      const Eigen::VectorXd list = column;
      return std::vector<double>(list.begin(), list.end());
    };
    const DesignCurves &first = *result.curves_before, &last = *result.curves_after;
    const OutputUnits units = output_units(before);
    for (std::size_t r = 0; r < last.rods.size(); ++r) {
      const auto column = static_cast<Eigen::Index>(r);
      curves.push_back({"Largest deflection of " + last.rods[r], units.response, speeds(first),
                        values(first.deflection.col(column)), speeds(last), values(last.deflection.col(column))});
    }
    curves.push_back(
        {"Growth rate, largest of the links", units.rate, speeds(first), values(first.growth), speeds(last), values(last.growth)});
  }
  data.add_design(document, tune_table(task, result, before), before, curves);
  return data.page(std::move(text));
}

int run_tune(const TuneFlags& flags) {
  if (flags.minimise.empty() == flags.maximise.empty())
    throw UsageError(fmt::format("--minimise, --maximise: found {}, allowed: one goal, as in --minimise deflection",
                                 flags.minimise.empty() ? "neither" : "both"));
  if (flags.vary.empty()) throw UsageError("--vary: found nothing, allowed: PATH=FROM:TO, as in --vary AB.J=20:200");
  if (!flags.only.empty())
    throw UsageError(
        fmt::format("--only: found \"{}\", allowed: not with tune, where goal and conditions say what is "
                    "computed",
                    flags.only));
  // Numbers of --set become part of the scene that is tuned.
  require_linear(flags.theory, "designs are compared by the linear theory; look at the one found with hb sweep --theory nonlinear");
  const SceneInput input = scene_input(flags.scene_file);
  const SceneSource& as_written = input.source;
  const std::vector<Override> set = overrides(flags);
  const std::filesystem::path file = flags.scene_file;
  std::optional<Scene> given;
  try {
    given = as_written.with(set);
  } catch (const ObstructedLinkage&) {  // an infeasible start
  }
  TuneTask task{
      .source = set.empty() ? as_written : SceneSource(as_written.text_with(set), input.name, input.folder),
      .variables = {},
      .goal = flags.maximise.empty() ? parse_goal(flags.minimise) : parse_largest_goal(flags.maximise),
      .keeps = {},
      .span = {},
      .in_rpm = true,
      .heights = {},
      .settings = {},
      .options = design_options(flags, flags.vary.size())};
  for (const std::string& text : flags.keep) task.keeps.push_back(parse_keep(text));
  for (const std::string& text : flags.height) {
    const NamedRange height = named_range("--height", text);
    task.heights[height.path] =
        number_flag("--height", height.range, std::numeric_limits<double>::min(), largest, "ROD=H with H > 0");
  }
  task.variables = variables(flags, task.source);
  require_algorithm(task);
  close_start(task);
  const Scene scene = given ? *given : task.source.with(overrides_at(task, start_of(task)));
  task.settings = settings(flags, scene);
  const Output out = output(flags);
  require_heights(task, scene);
  std::tie(task.span, task.in_rpm) = span_of(flags, scene);
  task.speed_unit = task.in_rpm ? speed_from_rpm(1, scene.units) : 1;
  start_speeds(task);

  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder) {
    for (const char* name : {tuned_file, nearest_file}) {
      std::error_code none;
      if (std::filesystem::equivalent(*out.folder / name, file, none))
        throw UsageError(
            fmt::format("--out: found {}, where {} would replace the scene itself; allowed: another folder",
                        out.folder->string(), name));
    }
    folder.emplace(*out.folder, "tune", origin);
  }
  task.options.stop = early_end(out.folder.has_value());
  std::optional<TuneResult> found;
  try {
    const InterruptGuard guard(!out.folder);
    found = tune(task, SharedWork(out.threads));
  } catch (const RequestError&) {  // no design yet
    if (!asked_to_end()) throw;
    return stopped_status();
  }
  const TuneResult& result = *found;
  if (task.options.progress) fmt::print(stderr, "\r\033[K");
  task.settings.modes = result.num_modes;

  const nlohmann::ordered_json document = tune_json(task, result, scene, out.stats);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : tune_table(task, result, scene);
  if (!out.json && folder)
    delivery.printed += fmt::format("written: {}\n", (*out.folder / scene_file(result)).string());
  delivery.write_data = [&](OutputFolder& place) -> std::vector<Figure> {
    place.write(scene_file(result), tuned_scene(task, result, scene.units, file, *out.folder));
    place.write("tune.json", json_file_text(document));
    const CsvFile history = history_csv(task, result);
    place.write(history.name, csv_text(history));
    write_curves(task, result, scene, place);
    return {};
  };
  delivery.write_more = [&](OutputFolder& place) { return tune_figures(task, result, scene, out.threads, place); };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      return design_page(task, result, scene, document, out.threads, page_text(origin, std::move(pictures)));
    };
  const int status = deliver(folder ? &*folder : nullptr, out.plots,
                             ended_status(shortfall(result).empty() ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) fmt::print(stderr, "\n{}", stages_table(result.stages));
  return status;
}

}  // namespace

void add_tune_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("tune", "design: scene numbers that minimise a goal under conditions over a range of speeds");
  const auto flags = std::make_shared<TuneFlags>();
  add_scene_flags(*command, *flags);
  add_linear_theory_flag(*command, flags->theory);
  add_analysis_flags(*command, *flags);
  add_html_flag(*command, *flags);
  const auto repeatable = [&](const char* name, std::vector<std::string>& values, const char* help, const char* type) {
    command->add_option(name, values, help)
        ->type_name(type)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  command
      ->add_option("--minimise,--minimize", flags->minimise,
                   "deflection, stress, force (each :NAME for one rod or joint), torque-ripple (largest minus smallest "
                   "torque), mass, or a sum such as "
                   "0.7*deflection+0.3*mass of parts over their start values")
      ->type_name("GOAL");
  command
      ->add_option("--maximise,--maximize", flags->maximise,
                   "instead: stable (the margin), frequency, clearance:N or speed-range")
      ->type_name("GOAL");
  repeatable("--vary", flags->vary,
             "a scene number to choose within bounds, as in AB.J=20:200, or an end of the speed range, over.from or "
             "over.to; repeatable",
             "PATH=A:B");
  repeatable("--tie", flags->tie, "a scene number that follows a varied one, as in CD.J=AB.J or CD.J=0.5*AB.J",
             "PATH=PATH");
  repeatable(
      "--keep", flags->keep,
      "stable, stable>=M (1/time) or M/turn, deflection<=, stress<= (MPa), force:JOINT<= (N), torque-ripple<= "
      "(N m), mass<=, frequency>= (Hz), clearance:N>= (least |omega_1/(n Omega) - 1| over speeds, rods and n = 1..N)",
      "CONDITION");
  command->add_option("--over", flags->over, "speeds over which the worst case counts")->type_name("rpm=A:B");
  repeatable("--height", flags->height, "height of a rod's section in the plane of motion, for stress; * for all",
             "ROD=H");
  command->add_option("--algorithm", flags->algorithm, "automatic, direct, mlsl, cobyla, bobyqa, slsqp or mma (NLopt)")
      ->type_name("NAME");
  command->add_option("--seed", flags->seed, "of mlsl")->type_name("N");
  command->add_option("--analyses", flags->analyses, "designs analysed at most, confirmations included")
      ->type_name("N");
  command->add_option("--speeds", flags->speeds, "speeds sampled before the worst case is refined; default 24")
      ->type_name("N");
  command->callback([flags, &status] { status = run_tune(*flags); });
}

}  // namespace hb::tools
