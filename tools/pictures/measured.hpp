// Measured values that pictures show beside the computed ones, from a CSV file (--measured).
#pragma once

#include <string>
#include <vector>

#include "tools/output/csv_output.hpp"

namespace hb::tools {

// What a column of the file may hold, by its name in the header, and the unit that pictures show it in.
struct MeasuredQuantity {
  std::string name;  // "deflection AB", "AB.0 x", "torque"
  std::string unit;  // "mm"; empty: none
};

class MeasuredOverlay {
 public:
  MeasuredOverlay() = default;  // nothing was measured
  explicit MeasuredOverlay(CsvFile csv) : csv_(std::move(csv)) {}

  [[nodiscard]] bool empty() const { return csv_.rows.cols() == 0; }
  [[nodiscard]] const CsvFile& csv() const { return csv_; }
  // A column beside the others, which no picture shows.
  void add_column(const std::string& name, const Eigen::VectorXd& values);
  // A further layer of a plot, ", 'measured.csv' using 1:3 with points ..."; nothing where it was not measured.
  [[nodiscard]] std::string layer(const std::string& quantity, bool in_key = false) const;
  // "; circles: measured" where any of these was.
  [[nodiscard]] std::string note(const std::vector<std::string>& quantities) const;
  [[nodiscard]] std::vector<double> values(const std::string& quantity) const;

 private:
  [[nodiscard]] int column(const std::string& quantity) const;  // from 1; 0: none
  CsvFile csv_;  // the columns' names are the quantities'
};

// The first column is the place: along `axis`, in its unit or that of the header. Throws UsageError naming file,
// column, what was found and what is allowed, SceneError for a file that is no table.
[[nodiscard]] MeasuredOverlay read_measured(const std::string& file, const MeasuredQuantity& axis,
                                            const std::vector<MeasuredQuantity>& allowed);

}  // namespace hb::tools
