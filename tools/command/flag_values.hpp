// Values of flags as numbers, lists and words; every refusal is a UsageError that names the flag, what was found and
// what is allowed.
#pragma once

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hb::tools {

[[noreturn]] void refuse_flag(const std::string& flag, const std::string& found, const std::string& allowed);

// The whole text as a number, or nothing.
[[nodiscard]] std::optional<double> whole_number(const std::string& text);
// What is likely wrong with a text that is no number; may be empty.
[[nodiscard]] std::string number_hint(const std::string& text);
// " (verdict meant?)", or nothing.
[[nodiscard]] std::string meant(const std::string& found, const std::vector<std::string>& names);

inline constexpr double largest_number = std::numeric_limits<double>::max();

// A finite number that satisfies lowest <= value <= highest; else UsageError with `allowed`.
[[nodiscard]] double number_flag(const std::string& flag, const std::string& text, double lowest, double highest,
                                 const std::string& allowed);
[[nodiscard]] int integer_flag(const std::string& flag, const std::string& text, int lowest, int highest,
                               const std::string& allowed);
// Seconds from 0.001 to `highest`: a number, or one with a unit of time ("2 min").
[[nodiscard]] double seconds_flag(const std::string& flag, const std::string& text, double highest);
// The parts between the marks, empty ones too.
[[nodiscard]] std::vector<std::string> split(const std::string& text, char mark);

// Parts of "a,b,c"; an empty part is a UsageError.
[[nodiscard]] std::vector<std::string> list_flag(const std::string& flag, const std::string& text);

// One of several words.
template <class Enum>
Enum choice_flag(const std::string& flag, const std::string& text,
                 const std::vector<std::pair<const char*, Enum>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (text == name) return value;
    names.push_back(name);
  }
  refuse_flag(flag, text, fmt::format("{}{}", fmt::join(names, ", "), meant(text, names)));
}

}  // namespace hb::tools
