#include "lib/scene/toml_hint.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/characters.hpp"
#include "lib/scene/quantity.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Offset of the last '=' outside quotes at or before `column`.
std::size_t last_equals(std::string_view line, std::size_t column) {
  std::size_t found = std::string_view::npos;
  char quote = 0;
  for (std::size_t i = 0; i < std::min(line.size(), column + 1); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      break;
    } else if (c == '=') {
      found = i;
    }
  }
  return found;
}

std::size_t digits_at(std::string_view text, std::size_t from) {
  std::size_t end = from;
  while (end < text.size() && is_digit(text[end])) ++end;
  return end;
}

}  // namespace

std::string toml_hint(std::string_view line, std::size_t column) {
  const std::size_t equals = last_equals(line, column);
  if (equals == std::string_view::npos) return "";
  const std::string_view before = trimmed(line.substr(0, equals));
  const std::size_t key_start = before.find_last_of("{, \t[");
  const std::string key = printable(key_start == std::string_view::npos ? before : before.substr(key_start + 1), 40);
  const std::string_view value = trimmed(line.substr(equals + 1));
  if (key.empty() || value.empty()) return "";

  // "0,055": digits, a comma, digits, and then the end of the value.
  const std::size_t first = value[0] == '-' || value[0] == '+' ? 1 : 0;
  const std::size_t whole = digits_at(value, first);
  if (whole > first && whole + 1 < value.size() && value[whole] == ',' && is_digit(value[whole + 1])) {
    const std::size_t end = digits_at(value, whole + 1);
    return fmt::format("a decimal comma? The decimal point is a point: {} = {}.{}", key, value.substr(0, whole),
                       value.substr(whole + 1, end - whole - 1));
  }
  if (value[0] == '"' && std::ranges::count(value, '"') == 1 && column > line.find('"', equals))
    return fmt::format("a quote at the end is missing: {} = {}\"", key, printable(value.substr(0, 60), 60));
  const std::string_view word = trimmed(value.substr(0, value.find_first_of(",}]#\"'")));
  if (word.empty()) return "";
  const auto number = number_and_unit(word);
  const bool unit =
      number && !number->unit.empty() && is_letter(number->unit[0]) && word.find(':') == std::string_view::npos;
  const bool text = is_letter(word[0]) && word != "true" && word != "false" && word != "inf" && word != "nan";
  if (!unit && !text) return "";
  return fmt::format("text needs quotes: {} = \"{}\"", key, printable(word, 60));
}

}  // namespace hb
