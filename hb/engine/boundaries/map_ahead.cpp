#include "hb/engine/boundaries/map_ahead.hpp"

namespace hb {
namespace {

constexpr double edges_of_a_halving = 13;
// In times that an edge of the grid takes: the stretch of curve at a crossing, and all halvings around an edge that is
// crossed twice.
constexpr double edges_of_a_crossing = 1.5, edges_of_two_crossings = 8;

}  // namespace

PartsAhead MapAhead::parts() const {
  return {{"node", nodes}, {"edge", edges + after_edges}, {"halved edge", halved}, {"curve point", points}};
}

void MapAhead::foresee_by(const std::map<std::size_t, SearchedInterval>& sampled, bool curves) {
  if (sampled.empty()) return;
  double crossings = 0, twice = 0;
  for (const auto& [edge, found] : sampled) {
    crossings += static_cast<double>(found.boundaries.size());
    twice += found.boundaries.size() > 1;
  }
  const double each = edges / static_cast<double>(sampled.size());
  after_edges = each * (edges_of_two_crossings * twice + (curves ? edges_of_a_crossing * crossings : 0));
}

void MapAhead::foresee_by(double halvings, std::size_t crossings, bool curves) {
  halved = edges_of_a_halving * halvings;
  after_edges = curves ? edges_of_a_crossing * static_cast<double>(crossings) : 0;
}

}  // namespace hb
