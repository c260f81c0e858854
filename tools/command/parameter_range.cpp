#include "tools/command/parameter_range.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "tools/command/command.hpp"

namespace hb::tools {
namespace {

constexpr const char* by_step = "FROM:TO:STEP with FROM < TO and 0 < STEP <= TO - FROM";
constexpr const char* by_count = "FROM:TO:N with FROM < TO and N an integer, 2 or more";

[[noreturn]] void refuse(const std::string& flag, const std::string& found, const std::string& why,
                         const std::string& allowed) {
  throw UsageError(fmt::format("{}: found \"{}\", {}; allowed: {}", flag, found, why, allowed));
}

[[noreturn]] void refuse_size(const std::string& flag, const std::string& found, double count) {
  refuse(flag, found, fmt::format("which is {:.3g} points", count), fmt::format("at most {} points", max_range_points));
}

std::vector<double> three_numbers(const std::string& flag, const std::string& text, const std::string& allowed) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() == 1) refuse(flag, text, "a single value", allowed);
  if (parts.size() != 3) refuse(flag, text, "which has not three parts", allowed);
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    double value = 0;
    const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || stop != part.data() + part.size() || !std::isfinite(value)) {
      refuse(flag, text, fmt::format("where \"{}\" is not a finite number", part), allowed);
    }
    numbers.push_back(value);
  }
  return numbers;
}

void require_ascending(const std::string& flag, const std::string& text, double from, double to,
                       const std::string& allowed) {
  if (from == to) refuse(flag, text, "a single point", allowed);
  if (!(from < to)) refuse(flag, text, "which runs backwards", allowed);
  if (!std::isfinite(to - from)) refuse(flag, text, "which is too wide", allowed);
}

}  // namespace

NamedRange named_range(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    refuse(flag, text, "which names no parameter or no range", "PATH=FROM:TO:..., as in AB.J=30:60:1");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
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

std::vector<double> range_by_step(const std::string& flag, const std::string& text) {
  const std::vector<double> numbers = three_numbers(flag, text, by_step);
  return range_by_step(flag, numbers[0], numbers[1], numbers[2]);
}

std::vector<double> range_by_count(const std::string& flag, const std::string& text) {
  const std::vector<double> numbers = three_numbers(flag, text, by_count);
  require_ascending(flag, text, numbers[0], numbers[1], by_count);
  const double count = numbers[2];
  if (count > static_cast<double>(max_range_points)) refuse_size(flag, text, count);
  if (!(count >= 2) || count != std::floor(count)) refuse(flag, text, "whose number of points is not one", by_count);
  const auto N = static_cast<std::size_t>(count);
  std::vector<double> values(N);
  for (std::size_t k = 0; k < N; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(N - 1);
    values[k] = numbers[0] + t * (numbers[1] - numbers[0]);
  }
  values.back() = numbers[1];
  if (!(values[1] > values[0])) refuse(flag, text, "whose step is lost in rounding", by_count);
  return values;
}

}  // namespace hb::tools
