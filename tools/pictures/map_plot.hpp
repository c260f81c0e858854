// The picture of a stability map: growth as colour, boundaries by kind, resonance lines with their names.
#pragma once

#include "tools/output/map_output.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

enum class MapColour { growth, per_turn, tenfold_time };

struct MapFiles {
  std::string grid, boundaries, resonance;
  std::vector<std::string> damping;  // as in MapResult::damping
};

[[nodiscard]] Figure map_figure(const MapDocument& document, const MapFiles& files, MapColour colour);

}  // namespace hb::tools
