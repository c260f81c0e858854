#include "lib/scene/table_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "lib/scene/characters.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

namespace {

constexpr Eigen::Index max_rows = 20001;

constexpr std::string_view blanks = " \t\r";

// Fields between commas or semicolons (then an empty field stays a field), else between blanks.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  const bool by_comma = line.find_first_of(",;") != std::string_view::npos;
  while (true) {
    const std::size_t end = line.find_first_of(by_comma ? ",;" : blanks);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line = line.substr(end + 1);
    if (!by_comma) line = trimmed(line);
  }
}

// "0,5" of a line whose fields stand between semicolons; empty: none.
std::string_view decimal_comma(std::string_view line) {
  if (line.find(';') == std::string_view::npos) return {};
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t at = line.find(','); at != std::string_view::npos; at = line.find(',', at + 1)) {
    if (at == 0 || at + 1 == line.size() || !digit(line[at - 1]) || !digit(line[at + 1])) continue;
    const std::size_t from = line.find_last_of(';', at), to = line.find(';', at);
    const std::size_t begin = from == std::string_view::npos ? 0 : from + 1;
    return trimmed(line.substr(begin, to == std::string_view::npos ? to : to - begin));
  }
  return {};
}

std::optional<double> number_of(std::string_view field) {
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

std::string_view unquoted(std::string_view field) {
  if (field.size() >= 2 && (field.front() == '"' || field.front() == '\'') && field.back() == field.front()) {
    field.remove_prefix(1);
    field.remove_suffix(1);
  }
  return trimmed(field);
}

// "force [kN]", "force (kN)", "force / kN": name and unit.
ColumnName column_name(std::string_view field) {
  field = unquoted(field);
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t at = field.find(open);
    if (at == std::string_view::npos || at == 0 || field.back() != close) continue;
    return {std::string(trimmed(field.substr(0, at))),
            std::string(trimmed(field.substr(at + 1, field.size() - at - 2)))};
  }
  const std::size_t at = field.find('/');
  if (at == std::string_view::npos || at == 0) return {std::string(field), ""};
  return {std::string(trimmed(field.substr(0, at))), std::string(trimmed(field.substr(at + 1)))};
}

// Lines of a table that are not blank, without comments and byte order mark.
class TableLines {
 public:
  explicit TableLines(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
  }
  // The next line with anything in it, or an empty one at the end.
  std::string_view next() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      std::string_view line = rest_.substr(0, end);
      rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
      ++number_;
      line = trimmed(line.substr(0, line.find('#')));
      if (!line.empty()) return line;
    }
    return {};
  }
  int number() const { return number_; }

 private:
  std::string_view rest_;
  int number_ = 0;
};

bool is_header(const std::vector<std::string_view>& fields) {
  return std::ranges::none_of(fields, [](std::string_view field) { return number_of(field).has_value(); });
}

}  // namespace

std::vector<ColumnName> table_header(const std::string& text) {
  TableLines lines(text);
  const std::vector<std::string_view> fields = fields_of(lines.next());
  std::vector<ColumnName> names;
  if (!is_header(fields)) return names;
  for (const std::string_view field : fields) names.push_back(column_name(field));
  return names;
}

NumberTable parse_table(const std::string& text, const std::string& name, Eigen::Index num_columns,
                        Eigen::Index min_rows, std::string_view explanation) {
  NumberTable table{name, table_header(text), {}, {}};
  std::vector<double> numbers;
  TableLines lines(text);
  bool first = true;
  for (std::string_view line = lines.next(); !line.empty(); line = lines.next(), first = false) {
    const std::vector<std::string_view> fields = fields_of(line);
    const auto fail = [&](const std::string& found, const std::string& allowed) {
      throw SceneError(fmt::format("{}:{}: found {}, allowed {}", name, lines.number(), found, allowed));
    };
    if (first && is_header(fields)) continue;
    if (const std::string_view field = decimal_comma(line); !field.empty())
      fail(fmt::format("\"{}\" between semicolons", printable(field, 40)), "a decimal point (0.5), not a comma");
    if (num_columns == 0) num_columns = static_cast<Eigen::Index>(fields.size());
    if (static_cast<Eigen::Index>(fields.size()) != num_columns) {
      fail(counted(static_cast<std::ptrdiff_t>(fields.size()), "field"),
           fmt::format("{} in a row{}", counted(num_columns, "number"), explanation));
    }
    if (static_cast<Eigen::Index>(table.lines.size()) == max_rows) {
      fail("more rows", fmt::format("at most {} rows", max_rows));
    }
    for (const std::string_view field : fields) {
      const std::optional<double> value = number_of(field);
      if (value && std::abs(*value) <= largest_number) {
        numbers.push_back(*value);
        continue;
      }
      fail("\"" + printable(field, 40) + "\"", std::string(any_number.words));
    }
    table.lines.push_back(lines.number());
  }
  const auto num_rows = static_cast<Eigen::Index>(table.lines.size());
  if (num_rows < min_rows) {
    throw SceneError(fmt::format("{}: found {} rows of numbers, allowed at least {}", name, num_rows, min_rows));
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values = Eigen::Map<const RowMajor>(numbers.data(), num_rows, num_columns);
  if (static_cast<Eigen::Index>(table.header.size()) != num_columns) table.header.clear();
  return table;
}

}  // namespace hb
