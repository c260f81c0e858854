#include "tools/command/sweep_axis.hpp"

#include <fmt/core.h>

#include <limits>

#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/range_units.hpp"
#include "tools/command/speed_flags.hpp"

namespace hb::tools {
namespace {

void require_speeds(const std::string& flag, const Along& along, const Units& units) {
  const double first = along.values.front(), lowest = in_rpm(along.path) ? speed_from_rpm(first, units) : first;
  if (!(lowest >= std::numeric_limits<double>::min()))
    throw UsageError(fmt::format("{}: found a range from {}, allowed: positive speeds", flag, first));
}

// --x PATH=RANGE.
void set_named(const CommonFlags& flags, const std::string& x, const SceneSource& source, const Scene& scene,
               SweepRequest& request) {
  const NamedRange range = named_range("--x", x);
  const std::string plain = plain_range("--x " + range.path, range.range, ThirdNumber::step, source, range.path);
  request.x = {range.path, range_by_step("--x", plain)};
  for (const Override& set : overrides(flags))
    if (set.path == range.path)
      throw UsageError(fmt::format("--set: found {} beside --x {}, allowed: one of the two", set.path, x));
  if (!is_speed(range.path)) return set_speed(request, first_speed(flags, scene));
  if (!flags.rpm.empty() || !flags.omega.empty())
    throw UsageError(fmt::format("--{}: found {} beside --x {}, allowed: one of the two",
                                 flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm, x));
  require_speeds("--x", request.x, scene.units);
}

}  // namespace

SweepRequest asked_sweep(const CommonFlags& flags, const std::string& x, const SceneSource& source,
                         const Scene& scene) {
  SweepRequest request;
  static_cast<Request&>(request) = asked_request(flags, scene);
  if (!x.empty()) {
    set_named(flags, x, source, scene, request);
    return request;
  }
  const SpeedRange range = several_speeds(flags, scene);
  request.x = {range.in_rpm ? "rpm" : "omega", speed_values(range)};
  require_speeds("--" + request.x.path, request.x, scene.units);
  return request;
}

}  // namespace hb::tools
