#include "tools/command/sweep_axis.hpp"

#include <fmt/core.h>

#include <limits>

#include "tools/command/command.hpp"
#include "tools/command/parameter_range.hpp"

namespace hb::tools {
namespace {

void require_speeds(const std::string& flag, const Axis& axis, const Units& units) {
  const double lowest = axis.kind == Axis::Kind::rpm ? speed_from_rpm(axis.values.front(), units) : axis.values.front();
  if (!(lowest >= std::numeric_limits<double>::min())) {
    throw UsageError(fmt::format("{}: found a range from {}, allowed: positive speeds", flag, axis.values.front()));
  }
}

}  // namespace

AxisAndSpeed axis_of(const CommonFlags& flags, const std::string& x, const Scene& scene) {
  Axis axis;
  if (x.empty()) {
    const SpeedRange range = several_speeds(flags, scene);
    axis.kind = range.in_rpm ? Axis::Kind::rpm : Axis::Kind::omega;
    axis.path = range.in_rpm ? "rpm" : "omega";
    const std::string flag = "--" + axis.path;
    axis.values = speed_values(range);
    require_speeds(flag, axis, scene.units);
    return {std::move(axis)};
  }
  const NamedRange range = named_range("--x", x);
  axis.path = range.path;
  axis.values = range_by_step("--x", range.range);
  for (const Override& set : overrides(flags)) {
    if (set.path == axis.path) {
      throw UsageError(fmt::format("--set: found {} beside --x {}, allowed: one of the two", set.path, x));
    }
  }
  if (axis.path == "rpm" || axis.path == "omega") {
    axis.kind = axis.path == "rpm" ? Axis::Kind::rpm : Axis::Kind::omega;
    if (!flags.rpm.empty() || !flags.omega.empty()) {
      throw UsageError(fmt::format("--{}: found {} beside --x {}, allowed: one of the two",
                                   flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm,
                                   x));
    }
    require_speeds("--x", axis, scene.units);
    return {std::move(axis)};
  }
  axis.kind = Axis::Kind::parameter;
  const double speed = single_speed(flags, scene);
  const auto [speeds, in_rpm] = first_speed(flags, scene);
  return {std::move(axis), speed, in_rpm ? speeds.from : rpm_from_speed(speed, scene.units)};
}

}  // namespace hb::tools
