#include "hb/analysis/along.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace hb {

bool in_rpm(const std::string& path) { return path == "rpm" || path == "analysis.rpm"; }

bool is_speed(const std::string& path) { return in_rpm(path) || path == "omega" || path == "analysis.omega"; }

bool same_number(const SceneFamily& family, const std::string& a, const std::string& b) {
  if (a == b) return true;
  const std::string& all = a.starts_with("*.") ? a : b;
  const std::string& one = a.starts_with("*.") ? b : a;
  const std::size_t dot = one.rfind('.');
  if (!all.starts_with("*.") || dot == std::string::npos || one.substr(dot + 1) != all.substr(2)) return false;
  const std::vector<std::string> paths = family.paths();
  return std::ranges::find(paths, one.substr(0, dot) + ".E") != paths.end();
}

Along along(std::string path, double from, double to, std::size_t count) {
  Along result{std::move(path), std::vector<double>(std::max<std::size_t>(2, count))};
  const auto steps = static_cast<double>(result.values.size() - 1);
  for (std::size_t k = 0; k < result.values.size(); ++k)
    result.values[k] = from + static_cast<double>(k) / steps * (to - from);
  result.values.back() = to;
  return result;
}

Scene some_scene(const SceneFamily& family, const std::vector<const Along*>& axes) {
  std::size_t longest = 1;
  for (const Along* axis : axes)
    if (!is_speed(axis->path)) longest = std::max(longest, axis->values.size());
  std::optional<ObstructedLinkage> obstructed;
  for (std::size_t k = 0; k < longest; ++k) {
    Numbers numbers;
    for (const Along* axis : axes)
      if (!is_speed(axis->path)) numbers.push_back({axis->path, axis->values[std::min(k, axis->values.size() - 1)]});
    try {
      return family.scene(numbers);
    } catch (const ObstructedLinkage& error) {
      if (!obstructed) obstructed = error;
    }
  }
  throw ObstructedLinkage(*obstructed);
}

void require_values(const char* field, const Along& along, const Units& units) {
  const std::vector<double>& values = along.values;
  if (values.size() < 2) throw RequestError(field, fmt::format("{} values", values.size()), "at least two");
  for (std::size_t k = 0; k + 1 < values.size(); ++k)
    if (!(values[k] < values[k + 1]))
      throw RequestError(field, fmt::format("{} before {}", values[k], values[k + 1]), "values in ascending order");
  if (!is_speed(along.path) && along.path.starts_with("analysis."))
    throw RequestError(field, along.path, "a speed, or a number of the mechanism or system: all points share the rest");
  if (!is_speed(along.path)) return;
  const double lowest = in_rpm(along.path) ? speed_from_rpm(values.front(), units) : values.front();
  if (!(lowest >= std::numeric_limits<double>::min()))
    throw RequestError(field, fmt::format("a range from {}", values.front()), "positive speeds");
}

void require_no_speed(const Request& request, const char* field, const Along& axis) {
  if (!request.rpm && !request.omega) return;
  const double value = request.rpm ? *request.rpm : *request.omega;
  throw RequestError(request.rpm ? "rpm" : "omega", fmt::format("{}", value), "one of the two",
                     fmt::format("found {} beside @{} {}, allowed: one of the two", value, field, axis.path));
}

}  // namespace hb
