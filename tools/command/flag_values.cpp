#include "tools/command/flag_values.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "lib/scene/quantity.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/command/command.hpp"

namespace hb::tools {
namespace {

// The whole text as a number, or nothing.
template <class Number>
std::optional<Number> parse(const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

void refuse_flag(const std::string& flag, const std::string& found, const std::string& allowed) {
  throw UsageError(fmt::format("{}: found \"{}\", allowed: {}", flag, found, allowed));
}

std::optional<double> whole_number(const std::string& text) { return parse<double>(text); }

// " (verdict meant?)", or nothing.
std::string meant(const std::string& found, const std::vector<std::string>& names) {
  const std::string near = nearest_name(found, names);
  return near.empty() ? "" : fmt::format(" ({} meant?)", near);
}

// What is likely wrong with a text that is no number.
std::string number_hint(const std::string& text) {
  const auto digits = [](const std::string& part) {
    return !part.empty() && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  };
  if (const std::size_t comma = text.find(','); comma != std::string::npos && digits(text.substr(comma + 1)))
    return "; the decimal point is a point: " + text.substr(0, comma) + "." + text.substr(comma + 1);
  const std::size_t unit = text.find_first_not_of("0123456789.+-eE");
  if (unit != std::string::npos && unit > 0 && parse<double>(text.substr(0, unit)) && std::isalpha(text[unit]))
    return fmt::format("; without a unit: {}", text.substr(0, unit));
  return "";
}

double number_flag(const std::string& flag, const std::string& text, double lowest, double highest,
                   const std::string& allowed) {
  const std::optional<double> value = parse<double>(text);
  if (!value || !(*value >= lowest && *value <= highest)) refuse_flag(flag, text, allowed + number_hint(text));
  return *value;
}

int integer_flag(const std::string& flag, const std::string& text, int lowest, int highest,
                 const std::string& allowed) {
  const std::optional<int> value = parse<int>(text);
  if (!value || *value < lowest || *value > highest) refuse_flag(flag, text, allowed);
  return *value;
}

double seconds_flag(const std::string& flag, const std::string& text, double highest) {
  const std::string allowed = fmt::format("seconds from 0.001 to {:g}, or a time with a unit as in \"2 min\"", highest);
  const std::optional<NumberText> number = number_and_unit(text);
  if (!number || number->unit.empty()) return number_flag(flag, text, 1e-3, highest, allowed);
  const UnitText unit = parse_unit(number->unit);
  if (!unit.unit || unit.unit->dimension != dimension::time)
    refuse_flag(flag, text, unit.problem.empty() ? allowed : allowed + "; " + unit.problem);
  const double seconds = number->value * size_of(*unit.unit);
  if (!(seconds >= 1e-3 && seconds <= highest)) refuse_flag(flag, text, allowed);
  return seconds;
}

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == mark) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::vector<std::string> list_flag(const std::string& flag, const std::string& text) {
  std::vector<std::string> parts = split(text, ',');
  for (const std::string& part : parts) {
    if (part.empty()) refuse_flag(flag, text, "names joined by single commas");
  }
  return parts;
}

}  // namespace hb::tools
