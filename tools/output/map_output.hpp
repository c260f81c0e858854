// A stability map as JSON, CSV and a few lines of text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hb/analysis/map_task.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/long_text.hpp"

namespace hb::tools {

struct MapDocument {
  const MapResult& result;
  const Scene& scene;
  Eigen::Index num_modes = 0;
  double tolerance = 0;  // of boundary points, relative
  bool boundaries = true;  // they were asked for
  bool complete = true;  // false: ended early
  std::vector<std::string> warnings = {};
  bool bounds = false;  // growth rates are upper bounds where these prove stability
  const Settings* settings = nullptr;  // with them what was computed, and how long that took
  std::vector<Stage> stages = {};
};
// "rpm = 3000, AB.J = 40 mm^4"
[[nodiscard]] std::string place_words(const MapDocument& document, double x, double y);

// Refers to the map.
[[nodiscard]] MapDocument document_of(const Map& map);

// "UNSTABLE at 19 % of the points because of AB", "stable at all points".
[[nodiscard]] std::string map_verdict(const MapDocument& document);
// The document in pieces, as text, and as values. Grids are written by all threads; the text is the same.
void write_map(const MapDocument& document, const TextSink& sink, int num_threads = 1);
[[nodiscard]] std::string map_text(const MapDocument& document);
[[nodiscard]] nlohmann::ordered_json map_json(const MapDocument& document);

// x, y, growth (1/time, per turn, tenfold time), verdict (1 unstable, 0 undecided, -1 stable), interpolated (0, 1),
// then growth of each rod; NaN where there is no system.
[[nodiscard]] CsvFile map_grid_csv(const MapDocument& document);
void write_map_grid(const MapDocument& document, const TextSink& sink);
// Curve, rod (from 1), kind (1, -1, 0 complex), x, y, error; a row of NaN between curves.
[[nodiscard]] CsvFile map_boundary_csv(const MapDocument& document, const std::vector<RodCurve>& curves,
                                       const std::string& name, const std::string& what);
// Line, x, y; a row of NaN between pieces.
[[nodiscard]] CsvFile map_resonance_csv(const MapDocument& document);

[[nodiscard]] std::string map_summary(const MapDocument& document);

// Growth per turn, and the time to grow tenfold (infinite where it does not grow).
[[nodiscard]] double growth_per_turn(const MapPoint& point);
[[nodiscard]] double tenfold_time(const MapPoint& point);

}  // namespace hb::tools
