#include "hb/analysis/resonance_lines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hb/engine/boundaries/boundary_curve.hpp"

namespace hb {
namespace {

constexpr std::size_t lattice = 65;  // places per side where the frequencies are computed
constexpr int modes_with_lines = 2;
constexpr int max_order = 8;

using PlanePoint = std::array<double, 2>;

PlanePoint between(const PlanePoint& p, const PlanePoint& q, double f) {
  return {p[0] + (q[0] - p[0]) * f, p[1] + (q[1] - p[1]) * f};
}

// Pieces of the line where `values` (lattice x lattice, NaN: unknown) are zero, straight inside each cell.
std::vector<std::vector<PlanePoint>> zero_lines(const std::vector<PlanePoint>& places,
                                                const std::vector<double>& values) {
  // Crossings on the edges that leave a node to the right (2 node) and upward (2 node + 1).
  const std::size_t num_nodes = lattice * lattice;
  std::vector<std::size_t> number(2 * num_nodes, SIZE_MAX);
  std::vector<PlanePoint> crossings;
  const auto cross = [&](std::size_t slot, std::size_t a, std::size_t b) {
    if ((values[a] > 0) == (values[b] > 0) || !std::isfinite(values[a]) || !std::isfinite(values[b])) return;
    number[slot] = crossings.size();
    crossings.push_back(between(places[a], places[b], values[a] / (values[a] - values[b])));
  };
  for (std::size_t j = 0; j < lattice; ++j) {
    for (std::size_t i = 0; i < lattice; ++i) {
      const std::size_t node = i + lattice * j;
      if (i + 1 < lattice) cross(2 * node, node, node + 1);
      if (j + 1 < lattice) cross(2 * node + 1, node, node + lattice);
    }
  }
  std::vector<CurveLink> links;
  for (std::size_t j = 0; j + 1 < lattice; ++j) {
    for (std::size_t i = 0; i + 1 < lattice; ++i) {
      const std::size_t node = i + lattice * j;
      std::vector<std::size_t> rim;
      for (const std::size_t slot : {2 * node, 2 * (node + 1) + 1, 2 * (node + lattice), 2 * node + 1}) {
        if (number[slot] != SIZE_MAX) rim.push_back(number[slot]);
      }
      if (rim.size() == 2) links.push_back({{rim[0], rim[1]}, node});
    }
  }
  std::vector<std::vector<PlanePoint>> pieces;
  for (const CurveChain& chain : chains(crossings.size(), links)) {
    pieces.emplace_back();
    for (const std::size_t p : chain.points) pieces.back().push_back(crossings[p]);
  }
  return pieces;
}

}  // namespace

std::string ResonanceLine::name(bool subscripts) const {
  const auto omega = [&](int mode) { return fmt::format("ω{}{}", subscripts ? "_" : "", mode + 1); };
  const std::string over = k == 1 ? "" : fmt::format("/{}", k);
  if (i == j) return fmt::format("2{}{}", omega(i), over);
  const std::string pair = omega(j) + (sign > 0 ? "+" : "-") + omega(i);
  return k == 1 ? pair : fmt::format("({}){}", pair, over);
}

std::vector<ResonanceLine> resonance_lines(const MapSystemAt& at, std::array<double, 2> x, std::array<double, 2> y,
                                           std::size_t max_lines, const ForEach& for_each) {
  std::vector<PlanePoint> places(lattice * lattice);
  std::array<std::vector<double>, modes_with_lines> w;  // frequencies over the speed
  for (std::vector<double>& of_mode : w) of_mode.assign(places.size(), std::numeric_limits<double>::quiet_NaN());
  do_each(for_each, lattice, [&](std::size_t j) {
    for (std::size_t i = 0; i < lattice; ++i) {
      const std::size_t p = i + lattice * j;
      places[p] = {x[0] + (x[1] - x[0]) * static_cast<double>(i) / (lattice - 1),
                   y[0] + (y[1] - y[0]) * static_cast<double>(j) / (lattice - 1)};
      const std::optional<ScaledSystem> system = at(places[p][0], places[p][1]);
      if (!system) continue;
      const Eigen::VectorXd squares = system->squared_frequencies();
      for (Eigen::Index m = 0; m < std::min<Eigen::Index>(modes_with_lines, squares.size()); ++m)
        if (squares(m) >= 0) w[static_cast<std::size_t>(m)][p] = std::sqrt(squares(m));
    }
  });
  std::vector<ResonanceLine> lines;
  struct Kind {
    int i, j, sign;
  };
  for (const Kind kind : {Kind{0, 0, 1}, Kind{0, 1, 1}, Kind{1, 1, 1}, Kind{0, 1, -1}}) {
    if (std::ranges::all_of(w[static_cast<std::size_t>(kind.j)], [](double value) { return std::isnan(value); }))
      continue;
    for (int k = 1; k <= max_order; ++k) {
      std::vector<double> detuning(places.size());
      for (std::size_t p = 0; p < places.size(); ++p) {
        detuning[p] =
            std::abs(w[static_cast<std::size_t>(kind.j)][p] + kind.sign * w[static_cast<std::size_t>(kind.i)][p]) - k;
      }
      ResonanceLine line{kind.i, kind.j, kind.sign, k, zero_lines(places, detuning)};
      if (!line.pieces.empty()) lines.push_back(std::move(line));
    }
  }
  std::stable_sort(lines.begin(), lines.end(), [](const ResonanceLine& a, const ResonanceLine& b) {
    // Higher modes and orders are weaker.
    return a.k + 2 * (a.i + a.j) + (a.sign < 0) < b.k + 2 * (b.i + b.j) + (b.sign < 0);
  });
  if (lines.size() > max_lines) lines.resize(max_lines);
  return lines;
}

}  // namespace hb
