// What the search of a map has still to compute, about: between what was measured of smooth and of chaotic maps, for
// forecasts alone.
#pragma once

#include <cstddef>
#include <map>

#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/part.hpp"

namespace hb {

struct MapAhead {
  double nodes = 0, edges = 0;
  double after_edges = 0;  // in times that an edge takes
  double halved = 0, points = 0;

  [[nodiscard]] PartsAhead parts() const;

  // After the edges, by some of them, searched first; `curves`: they are followed.
  void foresee_by(const std::map<std::size_t, SearchedInterval>& sampled, bool curves);
  // Of cells that are being halved, should each hand its wish on to one of its quarters for so many times.
  void foresee_by(double halvings, std::size_t crossings, bool curves);
};

}  // namespace hb
