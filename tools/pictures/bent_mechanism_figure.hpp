// The mechanism with its bent links at several crank angles, deflections magnified.
#pragma once

#include <optional>

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// Poses drawn, equally far apart over the turn.
inline constexpr int bent_poses = 6;

struct BentMechanism {
  double factor = 1;  // deflections are drawn so many times larger: 1, 2 or 5 times a power of ten, at least 1
  CsvFile csv;  // pose, part, then both ends of a straight piece
};
// Empty without an elastic link whose shape is known, or where none bends.
[[nodiscard]] std::optional<BentMechanism> bent_mechanism(const SceneModel& model, const SpeedResult& result);
[[nodiscard]] Figure bent_mechanism_figure(const SceneModel& model, const SpeedResult& result,
                                           const BentMechanism& bent);

}  // namespace hb::tools
