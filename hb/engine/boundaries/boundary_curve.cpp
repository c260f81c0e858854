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

std::vector<bool> coarse_chords(const std::vector<BoundaryPoint>& scaled, bool closed, double sag) {
  const std::size_t n = scaled.size() - 1;  // stretches
  std::vector<bool> coarse(n, false);
  const auto check = [&](std::size_t before, std::size_t after) {
    const BoundaryPoint &p0 = scaled[before], &p1 = scaled[before + 1], &p2 = scaled[after], &p3 = scaled[after + 1];
    const double ux = p1.x - p0.x, uy = p1.y - p0.y, vx = p3.x - p2.x, vy = p3.y - p2.y;
    const double u = std::hypot(ux, uy), v = std::hypot(vx, vy);
    const double turn = std::atan2(std::abs(ux * vy - uy * vx), ux * vx + uy * vy);
    if (u * turn / 8 > sag) coarse[before] = true;
    if (v * turn / 8 > sag) coarse[after] = true;
  };
  for (std::size_t k = 0; k + 1 < n; ++k) check(k, k + 1);
  if (closed) check(n - 1, 0);
  return coarse;
}

}  // namespace hb
