// From tables of samples over one turn to Fourier series: forces over the crank angle, and the matrices and loads of
// [hill]. Every error is a SceneError "file:line: found ..., allowed ...".
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/fourier/fourier.hpp"
#include "lib/scene/table_file.hpp"

namespace hb {

// Odd, but usable: "file:line: found ..., allowed ...; what was done".
using SampleRemark = std::function<void(const std::string&)>;

// The columns `columns` of a table as one series (a component each). With an angle column: its rows, in units of
// `angle_unit` rad, strictly increasing over one turn; the first row may stand at the end again. Without: equally
// spaced rows from angle 0. Equally spaced angles (to half a percent of the spacing, so that rounded ones count) are
// interpolated trigonometrically, others by a periodic cubic spline. `quantity` names the values in messages.
[[nodiscard]] FourierSeries sampled_series(const NumberTable& table, std::optional<Eigen::Index> angle_column,
                                           const std::vector<Eigen::Index>& columns, double angle_unit,
                                           const std::string& quantity, const SampleRemark& remark);

// rad per unit of an angle column: the unit in its header ("angle [deg]") if one stands there, else the scene's.
[[nodiscard]] double angle_unit_of(const NumberTable& table, std::optional<Eigen::Index> angle_column,
                                   double angle_unit);

// Which columns of a sample file hold what: component i + size*k is the entry (i, k) of a matrix, i that of a vector.
struct SampleColumns {
  std::optional<Eigen::Index> angle;
  std::vector<Eigen::Index> components;
};

// By the names of the header where one of them is an entry (k11, c_12; h1, load2; any letters) or an angle; of a matrix
// one half is enough, the other is its mirror image. Else all entries row by row and no angle.
[[nodiscard]] SampleColumns sample_columns(const NumberTable& table, Eigen::Index size, bool matrix);

// Angle ("angle", "crank angle", "tau", "phi") and value of a force or pressure table. `column`: the name of the
// value's column, or its number from 1; without it the table has two columns.
struct ForceColumns {
  Eigen::Index angle = 0, value = 1;
};
[[nodiscard]] ForceColumns force_columns(const NumberTable& table, const std::string& column);

}  // namespace hb
