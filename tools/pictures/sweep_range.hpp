// Which values of a sweep a picture has to show.
#pragma once

#include <vector>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

// Finite values of a column, counted from 1.
[[nodiscard]] std::vector<double> finite(const CsvFile& csv, int column);
// Values of a column at points of the sweep where every rod is stable and bent by no more than its length; of all
// points if that is nowhere or not known.
[[nodiscard]] std::vector<double> where_stable(const SweepScene& scene, const SweepResult& result, const CsvFile& csv,
                                               int column);
// Without what is many times larger than nine tenths of all: sharp peaks would flatten the rest.
[[nodiscard]] std::vector<double> without_spikes(std::vector<double> values);
// 0 of none.
[[nodiscard]] double median(std::vector<double> values);
[[nodiscard]] double largest(const std::vector<double>& values);

}  // namespace hb::tools
