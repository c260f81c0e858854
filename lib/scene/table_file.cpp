#include "lib/scene/table_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "lib/scene/scene.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

namespace {

constexpr Eigen::Index max_rows = 20001;

constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

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

std::optional<double> number_of(std::string_view field) {
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

}  // namespace

NumberTable parse_table(const std::string& text, const std::string& name, Eigen::Index num_columns,
                        Eigen::Index min_rows) {
  NumberTable table{name, {}, {}};
  std::vector<double> numbers;
  std::string_view rest = text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  bool header_allowed = true;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;

    const std::vector<std::string_view> fields = fields_of(line);
    const auto fail = [&](const std::string& found, const std::string& allowed) {
      throw SceneError(fmt::format("{}:{}: found {}, allowed {}", name, line_number, found, allowed));
    };
    std::vector<std::optional<double>> row;
    bool any = false;
    for (const std::string_view field : fields) {
      row.push_back(number_of(field));
      any = any || row.back();
    }
    const bool header = header_allowed && !any;
    header_allowed = false;
    if (header) continue;
    if (static_cast<Eigen::Index>(fields.size()) != num_columns) {
      fail(counted(static_cast<std::ptrdiff_t>(fields.size()), "field"), counted(num_columns, "number") + " in a row");
    }
    if (static_cast<Eigen::Index>(table.lines.size()) == max_rows) {
      fail("more rows", fmt::format("at most {} rows", max_rows));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (row[i] && std::abs(*row[i]) <= largest_number) {
        numbers.push_back(*row[i]);
        continue;
      }
      std::string found;
      for (const char c : fields[i].substr(0, 40)) found += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
      fail("\"" + found + "\"", std::string(any_number.words));
    }
    table.lines.push_back(line_number);
  }
  const auto num_rows = static_cast<Eigen::Index>(table.lines.size());
  if (num_rows < min_rows) {
    throw SceneError(fmt::format("{}: found {} rows of numbers, allowed at least {}", name, num_rows, min_rows));
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values = Eigen::Map<const RowMajor>(numbers.data(), num_rows, num_columns);
  return table;
}

NumberTable read_table(const std::filesystem::path& file, Eigen::Index num_columns, Eigen::Index min_rows) {
  return parse_table(read_text_file(file), file.string(), num_columns, min_rows);
}

}  // namespace hb
