// The picture of a stability map: growth as colour, boundaries by kind, resonance lines with their names.
#pragma once

#include "tools/output/map_output.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

enum class MapColour { growth, per_turn, tenfold_time };

struct MapFiles {
  std::string grid, boundaries, resonance;
  std::string theory;  // empty: not looked at
  std::string loads;  // empty: not asked for
  std::vector<std::string> band;  // as in MapResult::band
};

[[nodiscard]] Figure map_figure(const MapDocument& document, const MapFiles& files, MapColour colour);

// Names of both axes, quoted.
void name_axes(const MapDocument& document, Figure& figure);
// What maps share: ranges and names of both axes, and the boundaries as layers of a plot.
[[nodiscard]] std::string map_axes(const MapDocument& document);
[[nodiscard]] std::vector<std::string> boundary_layers(const MapResult& result, const MapFiles& files);
// Room for the key below and for the colours' numbers and name at the right.
inline constexpr const char* map_frame =
    "set bmargin at screen 0.2\nset tmargin at screen 0.89\nset lmargin at screen 0.14\nset rmargin at screen 0.83\n"
    "set colorbox user origin screen 0.85, screen 0.2 size screen 0.03, screen 0.69\n";
inline constexpr const char* map_clean_up =
    "unset label\nunset object\nunset logscale\nset key default\nset margins -1, -1, -1, -1\nset colorbox default\n"
    "set cbrange [*:*]\nset xrange [*:*]\nset yrange [*:*]\n";

// Largest stress and smallest safety of each rod over the map, with the boundaries of stability.
[[nodiscard]] std::vector<Figure> load_figures(const MapDocument& document, const MapFiles& files);

}  // namespace hb::tools
