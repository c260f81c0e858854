// Polynomials through what is analytic at three or four places.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace hb {

constexpr double interpolation_safety = 3;  // the last term is taken so many times for the error

// of(node) at x by Newton's divided differences, and the last term; the last place is the farthest. Where one of the
// places beyond the first two, between which x lies, belongs to something else, leaving that one out tells it: half of
// what that changes counts if it is more. The last difference may vanish by chance: it is taken for a tenth of the one
// before over the distance of the places at least. `third_belongs`: the third place is known to belong to the same.
template <class Value, class Node, class Of>
[[nodiscard]] std::pair<Value, double> interpolated(const std::vector<Node>& nodes, double x, const Of& of,
                                                    bool third_belongs = false) {
  constexpr double least_part = 0.1;
  const std::size_t n = nodes.size();
  std::array<Value, 4> d{};
  for (std::size_t k = 0; k < n; ++k) d[k] = of(nodes[k]);
  Value sum = d[0];
  double product = 1;
  for (std::size_t order = 1; order < n; ++order) {
    for (std::size_t k = n - 1; k >= order; --k) d[k] = (d[k] - d[k - 1]) / (nodes[k].x - nodes[k - order].x);
    product *= x - nodes[order - 1].x;
    sum += d[order] * product;
  }
  if (n < 4) return {sum, HUGE_VAL};
  const double near = std::abs(x - nodes[2].x), far = std::abs(x - nodes[3].x);
  const double without_one =
      std::abs((x - nodes[0].x) * (x - nodes[1].x)) * (third_belongs ? near : std::max(near, 0.5 * far));
  const auto [low, high] = std::ranges::minmax(nodes, {}, &Node::x);
  return {sum, std::max(std::abs(d[3]), least_part * std::abs(d[2]) / (high.x - low.x)) * without_one};
}

}  // namespace hb
