// How an answer moves with damping, Young's modulus, mass: table and document.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "hb/analysis/sensitivity_band.hpp"

namespace hb::tools {

// `nominal`: the document of hb steady at factor 1.
[[nodiscard]] nlohmann::ordered_json bands_json(const nlohmann::ordered_json& nominal,
                                                const std::vector<SensitivityBand>& bands);
// The same from the documents at both ends: without slopes where there are none.
struct BandSides {
  BandRequest asked;
  nlohmann::ordered_json low, high;
  std::vector<BandSlope> slopes = {};
};
[[nodiscard]] nlohmann::ordered_json bands_json(const nlohmann::ordered_json& nominal,
                                                const std::vector<BandSides>& bands);
[[nodiscard]] nlohmann::ordered_json bands_json(const nlohmann::ordered_json& nominal,
                                                const std::vector<NonlinearBand>& bands);
// From that list.
[[nodiscard]] std::string bands_table(const nlohmann::ordered_json& bands);

}  // namespace hb::tools
