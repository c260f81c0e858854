// The pictures of `hb sweep`, drawn from the CSV files of sweep_output.hpp. Unstable bands are shaded in all of them.
#pragma once

#include <vector>

#include "tools/output/sweep_output.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/pictures/measured.hpp"

namespace hb::tools {

// What may be measured along a sweep, and along what.
[[nodiscard]] std::vector<MeasuredQuantity> measured_quantities(const SweepScene& scene);
[[nodiscard]] MeasuredQuantity measured_axis(const SweepScene& scene);

// Frequencies of the modes over the axis, coloured by growth rate; order lines n Omega; parametric resonances: half
// orders k Omega/2, met by omega_i and by (omega_i +- omega_j)/2; resonance peaks as dots.
[[nodiscard]] Figure campbell_figure(const SweepScene& scene, const SweepResult& result, std::size_t rod,
                                     const CsvFile& csv, const std::string& critical,
                                     const MeasuredOverlay& measured = {});
// Peaks of the q_i, logarithmic.
[[nodiscard]] Figure peaks_figure(const SweepScene& scene, const SweepResult& result, std::size_t rod,
                                  const CsvFile& csv, const MeasuredOverlay& measured = {});
// Largest deflection and bending moment.
[[nodiscard]] Figure strain_figure(const SweepScene& scene, const SweepResult& result, std::size_t rod,
                                   const CsvFile& csv, const MeasuredOverlay& measured = {});
// Growth rate of the slowest decay or fastest growth, and of every mode.
[[nodiscard]] Figure growth_figure(const SweepScene& scene, const SweepResult& result, std::size_t rod,
                                   const CsvFile& csv, const MeasuredOverlay& measured = {});
// Verdicts as a strip of colours, a row for each elastic link.
[[nodiscard]] CsvFile sweep_verdict_csv(const SweepScene& scene, const SweepResult& result);
[[nodiscard]] Figure sweep_verdict_figure(const SweepScene& scene, const SweepResult& result, const CsvFile& csv);
// Joint forces and torque, elastic beside rigid: one figure per dyad, one for the crank.
[[nodiscard]] std::vector<Figure> sweep_force_figures(const SweepScene& scene, const SweepResult& result,
                                                      const CsvFile& csv, const MeasuredOverlay& measured = {});

}  // namespace hb::tools
