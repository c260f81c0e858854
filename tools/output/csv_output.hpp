// Results as CSV over one turn of the crank, in the units of output_units.hpp: comment lines (#) that say what the file
// holds, one line of column names with units, then numbers with all their digits.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb::tools {

struct CsvFile {
  std::string name;  // of the file
  std::vector<std::string> comment;  // lines
  std::vector<std::string> columns;  // names with units
  Eigen::MatrixXd rows;
};

[[nodiscard]] std::string csv_text(const CsvFile& file);
[[nodiscard]] std::string csv_rows(const Eigen::MatrixXd& rows);

// Crank angle, q_i, dq_i/dt.
[[nodiscard]] CsvFile response_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod);
// n, then real and imaginary part and amplitude (|c_0|, 2 |c_n|) of each q_i.
[[nodiscard]] CsvFile fourier_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod);
// Real and imaginary part of the exponents, error.
[[nodiscard]] CsvFile exponents_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod);
// Crank angle, then for each joint and component elastic beside rigid.
[[nodiscard]] CsvFile forces_csv(const SceneModel& model, const SpeedResult& result);
// Crank angle, torque elastic and rigid.
[[nodiscard]] CsvFile torque_csv(const SceneModel& model, const SpeedResult& result);
// x, smallest and largest over the turn, then at `shape_angles` equally spaced crank angles.
inline constexpr int shape_angles = 12;
[[nodiscard]] CsvFile deflection_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod);
[[nodiscard]] CsvFile bending_moment_csv(const SceneModel& model, const SpeedResult& result, const RodResult& rod);

// Names of the places that mechanism_csv traces: every joint, pivot and point once per body that carries it.
struct TracedPoint {
  std::string name;  // "crank.pivot", "AB.0", "O2BC.C"
  int body = 0;
  std::complex<double> point = 0;  // in the body's frame
  bool fixed = false;
};
[[nodiscard]] std::vector<TracedPoint> traced_points(const Linkage& linkage);
// Crank angle, x and y of every traced point.
[[nodiscard]] CsvFile mechanism_csv(const Scene& scene);

}  // namespace hb::tools
