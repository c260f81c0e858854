// The pictures of `hb steady` and `hb scene`, drawn from the CSV files of csv_output.hpp.
#pragma once

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/pictures/measured.hpp"

namespace hb::tools {

// q_i over the turn, a panel per mode (the first `max_panels`).
[[nodiscard]] Figure response_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                     const std::string& csv, const MeasuredOverlay& measured = {});
// (q_i, dq_i/dt), a panel per mode.
[[nodiscard]] Figure phase_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                  const std::string& csv);
// Amplitudes over the harmonic, logarithmic.
[[nodiscard]] Figure spectrum_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                     const std::string& csv);
// Deflection or bending moment along the rod at several crank angles, with the envelope over the turn.
[[nodiscard]] Figure shape_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                  const CsvFile& csv, bool moment);
// Stress of both fibres along the rod, between smallest and largest over the turn.
[[nodiscard]] Figure stress_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                   const std::string& csv);
// Elastic beside rigid: one figure per dyad, one for the crank's pivot.
[[nodiscard]] std::vector<Figure> force_figures(const SceneModel& model, const SpeedResult& result,
                                                const std::string& csv, const MeasuredOverlay& measured = {});
// As vectors over the turn, in the same groups.
[[nodiscard]] std::vector<Figure> polar_figures(const SceneModel& model, const SpeedResult& result,
                                                const std::string& csv);
[[nodiscard]] Figure torque_figure(const SceneModel& model, const SpeedResult& result, const std::string& csv,
                                   const MeasuredOverlay& measured = {});
// The mechanism in several poses with the paths of its joints.
[[nodiscard]] Figure mechanism_figure(const Scene& scene, const CsvFile& csv);

inline constexpr Eigen::Index max_panels = 6;

}  // namespace hb::tools
