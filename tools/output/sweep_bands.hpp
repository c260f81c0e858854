// How a sweep moves with damping, Young's modulus, mass: document, table, CSV.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hb/analysis/sensitivity_band.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

// `nominal`: the document of hb sweep at factor 1.
[[nodiscard]] nlohmann::ordered_json sweep_bands_json(const nlohmann::ordered_json& nominal,
                                                      const std::vector<SweepBand>& bands);
// The largest value of all points, as given and at both ends; how many points are unstable.
struct BandExtreme {
  std::string name;  // "AB deflection [mm]"
  double low = 0, given = 0, high = 0;
};
[[nodiscard]] std::vector<BandExtreme> band_extremes(const nlohmann::ordered_json& nominal,
                                                     const nlohmann::ordered_json& band);
// From that list and the document.
[[nodiscard]] std::string sweep_bands_table(const nlohmann::ordered_json& nominal, const nlohmann::ordered_json& bands);

// Of one band and rod: x, then of each quantity as given and at both ends.
struct BandCurves {
  std::string rod, parameter;
  double from = 1, to = 1;  // factors
  std::vector<std::string> labels;  // of the quantities
  CsvFile csv;
};
[[nodiscard]] std::vector<BandCurves> band_curves(const nlohmann::ordered_json& nominal,
                                                  const nlohmann::ordered_json& bands, const std::string& axis);
// The same of one speed: q_1 of each rod over the turn.
[[nodiscard]] std::vector<BandCurves> band_responses(const SteadyResult& nominal,
                                                     const std::vector<SensitivityBand>& bands);

}  // namespace hb::tools
