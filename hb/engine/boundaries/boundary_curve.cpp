#include "hb/engine/boundaries/boundary_curve.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

std::vector<CurveChain> chains(std::size_t num_points, const std::vector<CurveLink>& links) {
  std::vector<std::vector<std::size_t>> at(num_points);
  for (std::size_t k = 0; k < links.size(); ++k) {
    for (const std::size_t end : links[k].ends) at[end].push_back(k);
  }
  std::vector<bool> used(links.size(), false);
  std::vector<CurveChain> result;
  const auto walk = [&](std::size_t start) {
    CurveChain chain;
    chain.points.push_back(start);
    for (std::size_t point = start;;) {
      const auto next = std::find_if(at[point].begin(), at[point].end(), [&](std::size_t k) { return !used[k]; });
      if (next == at[point].end()) break;
      used[*next] = true;
      const CurveLink& link = links[*next];
      point = link.ends[0] == point ? link.ends[1] : link.ends[0];
      chain.points.push_back(point);
      chain.cells.push_back(link.cell);
    }
    chain.closed = chain.points.size() > 2 && chain.points.front() == chain.points.back();
    if (!chain.cells.empty()) result.push_back(std::move(chain));
  };
  for (std::size_t p = 0; p < num_points; ++p) {
    if (at[p].size() == 1) walk(p);
  }
  for (std::size_t p = 0; p < num_points; ++p) walk(p);
  return result;
}

std::vector<std::array<std::size_t, 2>> joined_in_cell(std::size_t num_crossings, bool start_unstable,
                                                       bool centre_unstable) {
  std::vector<std::array<std::size_t, 2>> pairs;
  // Piece m of the rim runs from crossing m - 1 to crossing m.
  for (std::size_t m = 0; m < num_crossings; ++m) {
    const bool unstable = start_unstable != (m % 2 == 1);
    if (unstable != centre_unstable) pairs.push_back({(m + num_crossings - 1) % num_crossings, m});
  }
  return pairs;
}

std::vector<std::size_t> coarse_cells(const CurveChain& chain, const std::vector<BoundaryPoint>& scaled, double sag) {
  std::vector<std::size_t> cells;
  const std::size_t n = chain.points.size();
  const auto check = [&](std::size_t before, std::size_t middle, std::size_t after, std::size_t cell_before,
                         std::size_t cell_after) {
    const BoundaryPoint &p0 = scaled[before], &p1 = scaled[middle], &p2 = scaled[after];
    const double ux = p1.x - p0.x, uy = p1.y - p0.y, vx = p2.x - p1.x, vy = p2.y - p1.y;
    const double u = std::hypot(ux, uy), v = std::hypot(vx, vy);
    const double turn = std::atan2(std::abs(ux * vy - uy * vx), ux * vx + uy * vy);
    if (u * turn / 8 > sag) cells.push_back(cell_before);
    if (v * turn / 8 > sag) cells.push_back(cell_after);
  };
  for (std::size_t k = 1; k + 1 < n; ++k) {
    check(chain.points[k - 1], chain.points[k], chain.points[k + 1], chain.cells[k - 1], chain.cells[k]);
  }
  if (chain.closed) check(chain.points[n - 2], chain.points[0], chain.points[1], chain.cells[n - 2], chain.cells[0]);
  return cells;
}

}  // namespace hb
