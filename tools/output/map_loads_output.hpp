// Stress, safety and deflection over a map as JSON, CSV and lines of the table.
#pragma once

#include "tools/output/json.hpp"
#include "tools/output/map_output.hpp"

namespace hb::tools {

// `deflection`, `theory_error` and the grids of `stress` of one rod, rows along x; null where there are none.
void add_loads(Json& rod, const MapResult& result, std::size_t r, const Units& units);

// x, y, then of each rod deflection, stress, its error, safeties where there are any; NaN where there is no answer.
[[nodiscard]] CsvFile map_loads_csv(const MapDocument& document);
// Of a rod, from 1.
struct LoadColumns {
  int deflection = 0, theory_error = 0, stress = 0, yield_safety = 0, fatigue_safety = 0;  // 0: none
};
[[nodiscard]] LoadColumns load_columns(const MapResult& result, std::size_t r);

// The motion is stable there, and within the linear theory.
[[nodiscard]] bool trusted_loads(const MapResult& result, std::size_t place, std::size_t r);

// Largest stress and smallest safety of each rod with their places.
[[nodiscard]] std::string loads_rows(const MapDocument& document);

}  // namespace hb::tools
