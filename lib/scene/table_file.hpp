// Tables of numbers from CSV files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hb {

// One name of a header line: "pressure [bar]", "force / N", "k11 (N/m)".
struct ColumnName {
  std::string name;  // without the unit
  std::string unit;  // "" if none stands there
};

struct NumberTable {
  std::string name;
  std::vector<ColumnName> header;  // empty if there is none, or not one name for each column
  Eigen::MatrixXd values;  // row per line, column per field
  std::vector<int> lines;  // line of the file that each row stands in
};

// The names of the header line, which may stand first (no field of it is a number); empty if there is none.
[[nodiscard]] std::vector<ColumnName> table_header(const std::string& text);

// Reads a table whose every row holds `num_columns` finite numbers (0: as many as the first row), separated by commas,
// semicolons, tabs or spaces. '#' starts a comment, blank lines are skipped, one header line may stand first. At least
// `min_rows` and at most 20 001 rows. Throws SceneError naming file, line and what was found; `explanation` is put
// behind what it says of the number of columns.
[[nodiscard]] NumberTable parse_table(const std::string& text, const std::string& name, Eigen::Index num_columns,
                                      Eigen::Index min_rows, std::string_view explanation = "");

}  // namespace hb
