// What a map says of the linear theory, from the theory errors at some of its places: JSON, CSV, lines of the table,
// warnings, a caption.
#pragma once

#include <string>
#include <vector>

#include "tools/output/json.hpp"
#include "tools/output/map_output.hpp"

namespace hb::tools {

// A list: x, y, `theory_error` by rod, `growth_theory_error`; null: no value; `beyond` the linear theory.
[[nodiscard]] Json theory_sample_json(const MapDocument& document);

// One line; empty for a [hill] scene.
[[nodiscard]] std::string map_theory_rows(const MapDocument& document);

// In the words of a sweep's. "ROD: theory not judged: ..." where q was not asked for.
[[nodiscard]] std::vector<std::string> map_theory_warnings(const MapDocument& document);

// x, y, theory error of each rod, of the growth rate, 1 beyond the linear theory (else 0).
[[nodiscard]] CsvFile map_theory_csv(const MapDocument& document);

// "stability by the linear theory, AB, CD; beyond it at 3 of 9 points looked at" with `rods` = ", AB, CD"; of a [hill]
// scene "stability of the steady motion".
[[nodiscard]] std::string map_theory_caption(const MapDocument& document, const std::string& rods);

}  // namespace hb::tools
