#include "tools/command/speed_flags.hpp"

#include <fmt/core.h>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/range_units.hpp"

namespace hb::tools {
namespace {

// "A:B:STEP", "A:B:xN" or "N", positive, with units or without; `single`: only the last.
Speeds speeds_flag(const std::string& flag, const std::string& written, bool single, const Units& units) {
  const std::string text = plain_range(flag, written, ThirdNumber::step, [&](std::string_view part) {
    return speed_quantity(part, flag == "--rpm", units);
  });
  std::string allowed = fmt::format("a positive number, {:g} to {:g}{}", slowest, fastest,
                                    single ? "" : ", FROM:TO:STEP or FROM:TO:xN with FROM <= TO, STEP > 0, N points");
  if (text.starts_with('-')) {
    allowed +=
        "; a crank turns counter-clockwise: for the other way mirror the scene about the x axis (the signs of "
        "gravity, of every y, angle and branch)";
  }
  std::vector<std::string> parts = split(text, ':');
  if (parts.size() == 3 && single) refuse_flag(flag, text, "one speed, " + allowed + "; hb sweep takes a range");
  if (!single && parts.size() == 2) allowed += "; a step is missing: " + text + ":10 or " + text + ":x50";
  if (const std::size_t dash = text.find('-', 1); parts.size() == 1 && dash != std::string::npos &&
                                                  whole_number(text.substr(0, dash)) &&
                                                  whole_number(text.substr(dash + 1)))
    allowed += fmt::format("; a range{} is {}:{}:10", single ? ", of hb sweep," : "", text.substr(0, dash),
                           text.substr(dash + 1));
  if (parts.size() == 1) allowed += number_hint(text);
  if (parts.size() != 1 && parts.size() != 3) refuse_flag(flag, text, allowed);
  const std::optional<std::size_t> count = parts.size() == 3 ? point_count(flag, text, parts[2]) : std::nullopt;
  if (count) parts.pop_back();
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    const std::optional<double> value = whole_number(part);
    if (!value || !(*value >= slowest && *value <= fastest)) refuse_flag(flag, text, allowed);
    numbers.push_back(*value);
  }
  if (numbers.size() == 1) return {numbers[0], numbers[0], 0};
  if (!(numbers[0] <= numbers[1])) refuse_flag(flag, text, allowed + "; this one runs backwards");
  if (!count) return {numbers[0], numbers[1], numbers[2]};
  const int N = static_cast<int>(*count);
  return {numbers[0], numbers[1], (numbers[1] - numbers[0]) / (N - 1), N};
}

SpeedRange speeds_of_flags(const CommonFlags& flags, const Scene& scene, bool single) {
  if (!flags.rpm.empty() && !flags.omega.empty()) {
    throw UsageError(
        fmt::format("--omega: found \"{}\" beside --rpm {}, allowed: one of the two", flags.omega, flags.rpm));
  }
  if (!flags.rpm.empty()) return {speeds_flag("--rpm", flags.rpm, single, scene.units), true};
  if (!flags.omega.empty()) return {speeds_flag("--omega", flags.omega, single, scene.units), false};
  if (scene.analysis.rpm) return {*scene.analysis.rpm, true};
  if (scene.analysis.omega) return {*scene.analysis.omega, false};
  throw UsageError(fmt::format(
      "--rpm: no speed given, and {} has none under [analysis]; allowed: --rpm {}, or --omega the same (rad per {})",
      scene.file.string(), single ? "N" : "FROM:TO:STEP", scene.units.time));
}

}  // namespace

SpeedRange speed_range(const CommonFlags& flags, const Scene& scene) { return speeds_of_flags(flags, scene, false); }

SpeedRange several_speeds(const CommonFlags& flags, const Scene& scene) {
  const SpeedRange range = speed_range(flags, scene);
  if (range.speeds.from < range.speeds.to) return range;
  const std::string name = range.in_rpm ? "rpm" : "omega";
  if (!flags.rpm.empty() || !flags.omega.empty()) {
    throw UsageError(
        fmt::format("--{}: found the single speed {}, allowed: a range FROM:TO:STEP or FROM:TO:xN (hb steady "
                    "does one speed)",
                    name, range.speeds.from));
  }
  throw UsageError(
      fmt::format("--{0}: not given, and the scene's [analysis] has the single speed {0} = {1}; allowed: "
                  "--{0} FROM:TO:STEP (or FROM:TO:xN), or {0} = [from, to, step] in the scene",
                  name, range.speeds.from));
}

std::vector<double> speed_values(const SpeedRange& range) {
  const Speeds& speeds = range.speeds;
  const std::string flag = range.in_rpm ? "--rpm" : "--omega";
  if (speeds.count > 0) return range_by_count(flag, speeds.from, speeds.to, static_cast<std::size_t>(speeds.count));
  return range_by_step(flag, speeds.from, speeds.to, speeds.step);
}

SpeedRange first_speed(const CommonFlags& flags, const Scene& scene) {
  SpeedRange range = speeds_of_flags(flags, scene, true);
  range.speeds = {range.speeds.from, range.speeds.from, 0};
  return range;
}

}  // namespace hb::tools
