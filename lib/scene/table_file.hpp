// Tables of numbers from CSV files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace hb {

struct NumberTable {
  std::string name;
  Eigen::MatrixXd values;  // row per line, column per field
  std::vector<int> lines;  // line of the file that each row stands in
};

// Reads a table whose every row holds `num_columns` finite numbers, separated by commas, semicolons, tabs or spaces.
// '#' starts a comment, blank lines are skipped, one header line may stand first (no field of it is a number).
// At least `min_rows` and at most 20 001 rows. Throws SceneError naming file, line and what was found.
[[nodiscard]] NumberTable read_table(const std::filesystem::path& file, Eigen::Index num_columns,
                                     Eigen::Index min_rows);
[[nodiscard]] NumberTable parse_table(const std::string& text, const std::string& name, Eigen::Index num_columns,
                                      Eigen::Index min_rows);

}  // namespace hb
