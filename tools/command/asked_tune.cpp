#include "tools/command/asked_tune.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/range_units.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/command/tune_heights.hpp"
#include "tools/command/tune_search.hpp"
#include "tools/command/tune_start.hpp"

namespace hb::tools {
namespace {

// --over rpm=A:B, else the scene's or the flags' speed.
std::pair<SpeedSpan, bool> span_of(const TuneFlags& flags, const Scene& scene) {
  SpeedSpan span;
  if (!flags.speeds.empty()) span.num_nodes = integer_flag("--speeds", flags.speeds, 2, 10000, "an integer 2 to 10000");
  bool in_rpm = true;
  double from = 0, to = 0;
  if (flags.over.empty()) {
    if (flags.rpm.empty() && flags.omega.empty() && !scene.analysis.rpm && !scene.analysis.omega)
      throw UsageError(
          fmt::format("--over: no speeds given, and {} has none under [analysis]; allowed: rpm=FROM:TO, as in "
                      "rpm=300:3000, or omega=FROM:TO (rad per {})",
                      scene.file.string(), scene.units.time));
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
    const auto read = [&](std::string_view part) { return speed_quantity(part, in_rpm, scene.units); };
    const std::string flag = "--over " + range.path;
    std::tie(from, to) = bounds_flag(flag, plain_range(flag, range.range, ThirdNumber::step, read));
  }
  span.from = in_rpm ? speed_from_rpm(from, scene.units) : from;
  span.to = in_rpm ? speed_from_rpm(to, scene.units) : to;
  if (!(span.from >= std::numeric_limits<double>::min() && std::isfinite(span.to)))
    throw UsageError(fmt::format("--over: found speeds from {:g}, allowed: positive ones", from));
  return {span, in_rpm};
}

// A condition whose bound may have a unit: "deflection<=2 mm", "stress<=200 MPa".
Keep keep_flag(const std::string& text, const Scene& scene) {
  const std::size_t sign = text.find_first_of("<>");
  const std::size_t bound = sign == std::string::npos ? sign : text.find_first_not_of("= ", sign + 1);
  if (bound == std::string::npos || !has_unit(text.substr(bound))) return parse_keep(text);
  const NumberText number = *number_and_unit(text.substr(bound));
  const UnitText unit = parse_unit(std::string(number.unit));
  const Metric metric = parse_keep(text.substr(0, bound) + "1").metric;
  const std::optional<Unit> own = parse_unit(unit_of(metric.kind, scene)).unit;
  if (!unit.unit || !own || !(unit.unit->dimension == own->dimension))
    throw UsageError(
        fmt::format("--keep: found \"{}\" with {}, {}; allowed: a plain number{}", text, text.substr(bound),
                    unit.unit ? words_of(unit.unit->dimension) : unit.problem,
                    own ? fmt::format(" in {}, or a unit of that kind", unit_of(metric.kind, scene)) : ""));
  Keep keep = parse_keep(fmt::format("{}{}", text.substr(0, bound), converted(number.value, *unit.unit, *own)));
  keep.text = text;
  return keep;
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
  const SceneSource source =
      set.empty() ? as_written : SceneSource(as_written.text_with(set), input.name, input.folder);
  TuneTask task{.family = source,
                .variables = {},
                .goal = flags.maximise.empty() ? parse_goal(flags.minimise) : parse_largest_goal(flags.maximise),
                .keeps = {},
                .span = {},
                .in_rpm = true,
                .heights = {},
                .settings = {},
                .options = design_options(flags)};
  Remarks remarks;
  task.variables = tune_variables(flags, source, remarks);
  close_start(task, remarks);
  const Scene scene = given ? *given : task.family.scene(numbers_at(task, start_of(task)));
  for (const std::string& text : flags.keep) task.keeps.push_back(keep_flag(text, scene));
  require_algorithm(task);
  task.settings = settings(flags, scene);
  task.heights = heights_flag(flags.height, scene.units);
  require_heights(task, scene);
  std::tie(task.span, task.in_rpm) = span_of(flags, scene);
  task.speed_unit = task.in_rpm ? speed_from_rpm(1, scene.units) : 1;
  start_speeds(task, remarks);
  return {source, std::move(task), scene, std::move(remarks)};
}

}  // namespace hb::tools
