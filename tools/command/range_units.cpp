#include "tools/command/range_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"

namespace hb::tools {
namespace {

bool is_plain(const std::string& part) {
  const std::optional<double> value = whole_number(part);
  return value && *value != 0;
}

}  // namespace

bool has_unit(std::string_view text) {
  const std::optional<NumberText> number = number_and_unit(text);
  if (!number || number->unit.empty()) return false;
  const auto first = static_cast<unsigned char>(number->unit.front());
  return std::isalpha(first) != 0 || first >= 0x80 || first == '%';
}

std::string plain_range(const std::string& flag, const std::string& text, ThirdNumber third, const UnitReader& read) {
  std::string bare = text;
  std::erase(bare, '"');
  const std::vector<std::string> parts = split(bare, ':');
  const std::size_t measured = third == ThirdNumber::step ? 3 : 2;
  if (const std::string& last = parts.back();
      parts.size() == 3 && last.size() > 1 && (last.back() == 'x' || last.back() == 'X')) {
    const std::string count = last.substr(0, last.size() - 1);
    if (std::ranges::all_of(count, [](char c) { return c >= '0' && c <= '9'; }))
      throw UsageError(fmt::format("{}: found \"{}\", where \"{}\" is no number (x{} meant, {} points?)", flag, text,
                                   last, count, count));
  }
  bool any = false;
  for (std::size_t k = 0; k < std::min(parts.size(), measured); ++k) any = any || has_unit(parts[k]);
  if (!any) return text;
  std::string plain;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (k > 0) plain += ":";
    if (k < measured && is_plain(parts[k]))
      throw UsageError(
          fmt::format("{}: found \"{}\", where {} has no unit beside one that has; allowed: a unit at each "
                      "number of the range, or at none",
                      flag, text, parts[k]));
    if (k >= measured || !has_unit(parts[k])) {
      plain += parts[k];
      continue;
    }
    const Quantity quantity = read(parts[k]);
    if (!quantity.value)
      throw UsageError(fmt::format("{}: found \"{}\" with {}, {}", flag, text, parts[k], quantity.problem));
    plain += fmt::format("{}", *quantity.value);
  }
  return plain;
}

std::string plain_range(const std::string& flag, const std::string& text, ThirdNumber third, const SceneSource& source,
                        const std::string& path) {
  return plain_range(flag, text, third, [&](std::string_view part) { return quantity_at(source, path, part); });
}

}  // namespace hb::tools
