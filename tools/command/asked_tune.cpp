#include "tools/command/asked_tune.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/theory_flags.hpp"

namespace hb::tools {
namespace {

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

using Remarks = std::vector<std::string>;

// Moved into the bounds if need be.
void start_at(TuneVariable& variable, double value, Remarks& remarks) {
  variable.start = std::clamp(value, variable.lower, variable.upper);
  if (variable.start == value) return;
  variable.moved_from = value;
  remarks.push_back(fmt::format("{} = {:g} lies outside {:g} to {:g}; the search starts at {:g}", variable.path, value,
                                variable.lower, variable.upper, variable.start));
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
std::vector<TuneVariable> variables(const TuneFlags& flags, const SceneSource& source, Remarks& remarks) {
  std::vector<TuneVariable> result;
  for (const std::string& text : flags.vary) {
    const NamedRange range = named_range("--vary", text);
    const auto [a, b] = bounds("--vary " + range.path, range.range);
    TuneVariable variable{range.path, a, b, a, std::nullopt, {}};
    for (const TuneVariable& other : result)
      if (other.path == range.path) throw UsageError(fmt::format("--vary: found {} twice, allowed: once", range.path));
    require_mechanism("--vary", range.path);
    if (!is_speed(variable)) start_at(variable, source.value(range.path), remarks);
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
void close_start(TuneTask& task, Remarks& remarks) {
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
  remarks.push_back(
      fmt::format("the linkage does not close at the start; the search starts from {}, where it does", start));
}

void start_speeds(TuneTask& task, Remarks& remarks) {
  double lowest_to = task.span.to / task.speed_unit, highest_from = task.span.from / task.speed_unit;
  bool any = false;
  for (TuneVariable& variable : task.variables) {
    if (!is_speed(variable)) continue;
    any = true;
    const bool from = variable.path == range_from;
    if (!(variable.lower > 0))
      throw UsageError(fmt::format("--vary: found {} from {:g}, allowed: speeds > 0", variable.path, variable.lower));
    start_at(variable, (from ? task.span.from : task.span.to) / task.speed_unit, remarks);
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
    if (flags.over.find('=') == std::string::npos)
      throw UsageError(
          fmt::format("--over: found \"{0}\", allowed: rpm=FROM:TO or omega=FROM:TO, as in rpm={0}", flags.over));
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

}  // namespace

AskedTune asked_tune(const TuneFlags& flags, const SceneInput& input) {
  if (flags.minimise.empty() == flags.maximise.empty())
    throw UsageError(fmt::format("--minimise, --maximise: found {}, allowed: one goal, as in --minimise deflection",
                                 flags.minimise.empty() ? "neither" : "both"));
  if (flags.vary.empty()) throw UsageError("--vary: found nothing, allowed: PATH=FROM:TO, as in --vary AB.J=20:200");
  if (!flags.only.empty())
    throw UsageError(
        fmt::format("--only: found \"{}\", allowed: not with tune, where goal and conditions say what is "
                    "computed",
                    flags.only));
  require_linear(flags.theory,
                 "designs are compared by the linear theory; look at the one found with hb sweep --theory nonlinear");
  // Numbers of --set become part of the scene that is tuned.
  const SceneSource& as_written = input.source;
  const std::vector<Override> set = overrides(flags);
  std::optional<Scene> given;
  try {
    given = as_written.with(set);
  } catch (const ObstructedLinkage&) {  // an infeasible start
  }
  TuneTask task{.source = set.empty() ? as_written : SceneSource(as_written.text_with(set), input.name, input.folder),
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
  std::vector<std::string> remarks;
  task.variables = variables(flags, task.source, remarks);
  require_algorithm(task);
  close_start(task, remarks);
  const Scene scene = given ? *given : task.source.with(overrides_at(task, start_of(task)));
  task.settings = settings(flags, scene);
  require_heights(task, scene);
  std::tie(task.span, task.in_rpm) = span_of(flags, scene);
  task.speed_unit = task.in_rpm ? speed_from_rpm(1, scene.units) : 1;
  start_speeds(task, remarks);
  return {std::move(task), scene, std::move(remarks)};
}

}  // namespace hb::tools
