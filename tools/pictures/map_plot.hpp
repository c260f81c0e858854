// The picture of a stability map: growth as colour, boundaries by kind, resonance lines with their names.
#pragma once

#include "tools/pictures/gnuplot.hpp"
#include "tools/output/map_output.hpp"

namespace hb::tools {

enum class MapColour { growth, per_turn, tenfold_time };

struct MapFiles {
  std::string grid, boundaries, resonance;
  std::vector<std::string> damping;  // as in MapResult::damping
};

[[nodiscard]] Figure map_figure(const MapDocument& document, const MapFiles& files, MapColour colour);

}  // namespace hb::tools
