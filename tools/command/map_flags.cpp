#include "tools/command/map_flags.hpp"

#include <fmt/core.h>

#include <array>
#include <limits>
#include <optional>

#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/range_units.hpp"
#include "tools/command/speed_flags.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_points = 20000000;

Along axis_range(const std::string& flag, const std::string& text, const SceneSource& source) {
  if (text.empty())
    throw UsageError(fmt::format("{}: not given, allowed: PATH=FROM:TO:N, as in rpm=200:6000:100 (100 points)", flag));
  const NamedRange named = named_range(flag, text);
  const std::string plain = plain_range(flag + " " + named.path, named.range, ThirdNumber::count, source, named.path);
  Along range{named.path, range_by_count(flag, plain)};
  for (std::size_t k = 0; k + 1 < range.values.size(); ++k) {
    if (!(range.values[k] < range.values[k + 1])) {
      throw UsageError(
          fmt::format("{}: found \"{}\", whose points are too close to be told apart; allowed: a wider range "
                      "or fewer points",
                      flag, text));
    }
  }
  if (!is_speed(range.path) && range.path.starts_with("analysis."))
    throw UsageError(fmt::format("{}: found {}, allowed: rpm, omega or a number of the model", flag, range.path));
  if (is_speed(range.path) && !(range.values.front() > 0))
    throw UsageError(fmt::format("{}: found \"{}\", allowed: positive speeds", flag, text));
  return range;
}

void require_different(const CommonFlags& flags, const SceneSource& source, const Along& x, const Along& y) {
  if ((is_speed(x.path) && is_speed(y.path)) || same_number(source, x.path, y.path)) {
    throw UsageError(fmt::format("--y: found {} beside --x {}, allowed: two different parameters", y.path, x.path));
  }
  for (const Along* range : {&x, &y}) {
    const char* flag = range == &x ? "--x" : "--y";
    for (const Override& set : overrides(flags)) {
      if (same_number(source, set.path, range->path)) {
        throw UsageError(
            fmt::format("--set: found {} beside {} {}, allowed: one of the two", set.path, flag, range->path));
      }
    }
    if (is_speed(range->path) && (!flags.rpm.empty() || !flags.omega.empty())) {
      throw UsageError(fmt::format("--{}: found {} beside {} {}, allowed: one of the two",
                                   flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm,
                                   flag, range->path));
    }
  }
}

// Some scene of the map, for what does not depend on the place: the one as written, or one of a corner.
Scene readable_scene(const SceneSource& source, const std::vector<Override>& set, const Along& x, const Along& y) {
  std::optional<ObstructedLinkage> obstructed;
  for (int corner = 0; corner <= 4; ++corner) {
    std::vector<Override> all = set;
    if (corner > 0 && !is_speed(x.path))
      all.push_back(value_override(x.path, corner % 2 ? x.values.front() : x.values.back()));
    if (corner > 0 && !is_speed(y.path))
      all.push_back(value_override(y.path, corner <= 2 ? y.values.front() : y.values.back()));
    try {
      return source.with(all);
    } catch (const ObstructedLinkage& error) {
      obstructed = error;
    }
  }
  throw ObstructedLinkage(*obstructed);
}

std::optional<std::array<double, 2>> damping_factors(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::string allowed = "LOW:HIGH with 0 <= LOW < HIGH, factors on the damping";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  const double most = std::numeric_limits<double>::max();
  const std::array<double, 2> factors{number_flag("--damping-range", text.substr(0, colon), 0, most, allowed),
                                      number_flag("--damping-range", text.substr(colon + 1), 0, most, allowed)};
  if (!(factors[0] < factors[1])) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  return factors;
}

// --band damping=A:B is --damping-range A:B.
void ask_for_band(const std::vector<std::string>& bands, MapRequest& request) {
  if (bands.empty()) return;
  if (bands.size() > 1)
    throw UsageError(fmt::format("--band: found \"{}\" beside \"{}\", allowed: one, whose boundaries the map shows",
                                 bands[1], bands[0]));
  if (request.damping_range) throw UsageError("--band: found beside --damping-range, allowed: one of the two");
  const BandRequest band = parse_band(bands.front());
  if (band.parameter == BandParameter::damping)
    request.damping_range = {band.from, band.to};
  else
    request.band = band;
}

}  // namespace

MapRequest asked_map(const CommonFlags& flags, const MapFlags& map, const SceneInput& input) {
  MapRequest request;
  request.x = axis_range("--x", map.x, input.source);
  request.y = axis_range("--y", map.y, input.source);
  request.damping_range = damping_factors(map.damping_range);
  ask_for_band(map.bands, request);
  const std::vector<Override> set = overrides(flags);
  const std::size_t nx = request.x.values.size(), ny = request.y.values.size();
  if (static_cast<double>(nx) * static_cast<double>(ny) > max_points)
    throw UsageError(fmt::format("--x, --y: found {} x {} points, allowed: at most {} in all", nx, ny, max_points));
  require_different(flags, input.source, request.x, request.y);
  const Scene scene = readable_scene(input.source, set, request.x, request.y);
  static_cast<Request&>(request) = asked_request(flags, scene);
  if (!request.only.stability)
    throw UsageError(fmt::format("--only: found \"{}\", allowed: with stability, growth or verdict", flags.only));
  if (!is_speed(request.x.path) && !is_speed(request.y.path)) set_speed(request, first_speed(flags, scene));
  request.boundaries = !map.no_boundaries;
  request.stress = map.stress;
  if (!map.boundary_tolerance.empty())
    request.boundary_tolerance =
        number_flag("--boundary-tol", map.boundary_tolerance, 1e-14, 0.01, "a number from 1e-14 to 0.01");
  if (map.no_boundaries && (request.damping_range || request.band || !map.boundary_tolerance.empty()))
    throw UsageError(fmt::format("--no-boundaries: found beside {}, allowed: one of the two", request.band ? "--band"
                                                                                              : request.damping_range
                                                                                                  ? "--damping-range"
                                                                                                  : "--boundary-tol"));
  return request;
}

}  // namespace hb::tools
