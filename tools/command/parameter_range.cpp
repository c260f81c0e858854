#include "tools/command/parameter_range.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "lib/scene/scene_keys.hpp"
#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"

namespace hb::tools {
namespace {

constexpr const char* by_step = "FROM:TO:STEP or FROM:TO:xN (N points) with FROM < TO and 0 < STEP <= TO - FROM";
constexpr const char* by_count =
    "FROM:TO:N or FROM:TO:xN with FROM < TO and N, the number of points, an integer, 2 or more";

[[noreturn]] void refuse(const std::string& flag, const std::string& found, const std::string& why,
                         const std::string& allowed) {
  throw UsageError(fmt::format("{}: found \"{}\", {}; allowed: {}", flag, found, why, allowed));
}

[[noreturn]] void refuse_size(const std::string& flag, const std::string& found, double count) {
  refuse(flag, found, fmt::format("which is {:.10g} points", count),
         fmt::format("at most {} points", max_range_points));
}

double number_in(const std::string& flag, const std::string& text, const std::string& part,
                 const std::string& allowed) {
  double value = 0;
  const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc() || stop != part.data() + part.size() || !std::isfinite(value)) {
    refuse(flag, text, fmt::format("where \"{}\" is not a finite number", part), allowed);
  }
  return value;
}

// "FROM:TO:third", the third a number or "xN".
struct RangeText {
  double from, to;
  std::string third;
};

RangeText range_text(const std::string& flag, const std::string& text, const std::string& allowed) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() == 1) refuse(flag, text, "a single value", allowed);
  if (parts.size() != 3) refuse(flag, text, "which has not three parts", allowed);
  return {number_in(flag, text, parts[0], allowed), number_in(flag, text, parts[1], allowed), parts[2]};
}

void require_ascending(const std::string& flag, const std::string& text, double from, double to,
                       const std::string& allowed) {
  if (from == to) refuse(flag, text, "a single point", allowed);
  if (!(from < to)) refuse(flag, text, "which runs backwards", allowed);
  if (!std::isfinite(to - from)) refuse(flag, text, "which is too wide", allowed);
}

}  // namespace

NamedRange named_range(const std::string& flag, const std::string& text, const std::string& allowed) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    refuse(flag, text, "which names no parameter or no range", allowed);
  }
  const std::string path = text.substr(0, equals);
  // Numbers of links have a dot.
  if (path.find('.') == std::string::npos)
    if (const std::string speed = nearest_name(path, {"rpm", "omega"}); !speed.empty() && speed != path)
      refuse(flag, text, fmt::format("which names {} ({} meant?)", path, speed), allowed);
  return {path, text.substr(equals + 1)};
}

std::vector<double> range_by_step(const std::string& flag, double from, double to, double step) {
  const std::string text = fmt::format("{}:{}:{}", from, to, step);
  if (step == 0) refuse(flag, text, "whose step is zero", by_step);
  require_ascending(flag, text, from, to, by_step);
  if (!(step > 0)) refuse(flag, text, "whose step is negative", by_step);
  const double steps = (to - from) / step;
  if (!(steps < static_cast<double>(max_range_points))) refuse_size(flag, text, steps + 1);
  // Steps that meet `to` but for rounding.
  const double slack = 1e-9 * std::max(1.0, steps);
  const auto last = static_cast<std::size_t>(std::floor(steps + std::min(slack, 1e-3)));
  if (last == 0) refuse(flag, text, "a single point", by_step);
  std::vector<double> values;
  values.reserve(last + 1);
  for (std::size_t k = 0; k <= last; ++k) values.push_back(from + static_cast<double>(k) * step);
  if (std::abs(values.back() - to) <= std::min(slack, 1e-3) * step) values.back() = to;
  if (!(values[1] > values[0])) refuse(flag, text, "whose step is lost in rounding", by_step);
  return values;
}

std::optional<std::size_t> point_count(const std::string& flag, const std::string& range, const std::string& third) {
  if (!third.starts_with('x')) return std::nullopt;
  std::size_t count = 0;
  const auto [stop, error] = std::from_chars(third.data() + 1, third.data() + third.size(), count);
  if (error != std::errc() || stop != third.data() + third.size() || count < 2) {
    refuse(flag, range, fmt::format("where \"{}\" is not x and a number of points", third),
           "FROM:TO:xN with N an integer, 2 or more");
  }
  if (count > max_range_points) refuse_size(flag, range, static_cast<double>(count));
  return count;
}

std::vector<double> range_by_step(const std::string& flag, const std::string& text) {
  const RangeText range = range_text(flag, text, by_step);
  if (const auto count = point_count(flag, text, range.third))
    return range_by_count(flag, range.from, range.to, *count);
  return range_by_step(flag, range.from, range.to, number_in(flag, text, range.third, by_step));
}

std::vector<double> range_by_count(const std::string& flag, const std::string& text) {
  const RangeText range = range_text(flag, text, by_count);
  if (const auto count = point_count(flag, text, range.third))
    return range_by_count(flag, range.from, range.to, *count);
  const double count = number_in(flag, text, range.third, by_count);
  if (count > static_cast<double>(max_range_points)) refuse_size(flag, text, count);
  if (!(count >= 2) || count != std::floor(count)) {
    refuse(flag, text,
           fmt::format("where the number of points is {}, no integer of 2 or more{}", range.third,
                       count > 0 && count < range.to - range.from ? " (here the third number is no step)" : ""),
           by_count);
  }
  return range_by_count(flag, range.from, range.to, static_cast<std::size_t>(count));
}

std::vector<double> range_by_count(const std::string& flag, double from, double to, std::size_t count) {
  const std::string text = fmt::format("{}:{}:x{}", from, to, count);
  require_ascending(flag, text, from, to, by_count);
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(count - 1);
    values[k] = from + t * (to - from);
  }
  values.back() = to;
  if (!(values[1] > values[0])) refuse(flag, text, "whose step is lost in rounding", by_count);
  return values;
}

}  // namespace hb::tools
