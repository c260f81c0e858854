#include "hb/engine/system/independent_parts.hpp"

#include <algorithm>
#include <numeric>

namespace hb {

using Eigen::Index;

std::vector<std::vector<int>> independent_groups(const ScaledSystem& system) {
  const Index I = system.num_modes();
  const auto coupled = [&](Index i, Index j) {
    return system.G(i, j) != 0 || (system.K.c.row(i + I * j).array() != 0.0).any();
  };
  std::vector<int> group(static_cast<std::size_t>(I));
  std::iota(group.begin(), group.end(), 0);
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < I; ++j) {
      if (i == j || !coupled(i, j)) continue;
      const int a = group[static_cast<std::size_t>(i)], b = group[static_cast<std::size_t>(j)];
      std::replace(group.begin(), group.end(), std::max(a, b), std::min(a, b));
    }
  std::vector<std::vector<int>> groups(static_cast<std::size_t>(I));
  for (int i = 0; i < int(I); ++i) groups[static_cast<std::size_t>(group[static_cast<std::size_t>(i)])].push_back(i);
  std::erase_if(groups, [](const std::vector<int>& modes) { return modes.empty(); });
  return groups;
}

ScaledSystem group_of(const ScaledSystem& system, const std::vector<int>& modes) {
  const Index I = system.num_modes(), m = static_cast<Index>(modes.size());
  ScaledSystem part;
  part.speed = system.speed;
  part.T = system.T(Eigen::all, modes);
  part.T_inverse = system.T_inverse(modes, Eigen::all);
  part.G = system.G(modes, modes);
  part.K_rounding = system.K_rounding(modes, modes);
  part.diagonal_damping = system.diagonal_damping;
  part.K = FourierSeries(m * m, system.K.num_harmonics());
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < m; ++i)
      part.K.c.row(i + m * j) =
          system.K.c.row(modes[static_cast<std::size_t>(i)] + I * modes[static_cast<std::size_t>(j)]);
  Index H = part.K.num_harmonics();
  while (H > 0 && (part.K.c.col(H).array() == 0.0).all()) --H;
  part.K = fourier::resized(part.K, H);
  return part;
}

Index common_divisor(const ScaledSystem& system) {
  Index g = 0;
  for (Index k = 1; k <= system.K.num_harmonics(); ++k)
    if ((system.K.c.col(k).array() != 0.0).any()) g = std::gcd(g, k);
  return g;
}

// x'' + G x' + K x = 0 with d/dtau = g d/dtau': divided by g^2.
ScaledSystem with_period_divided(const ScaledSystem& system, Index g) {
  const double factor = 1 / static_cast<double>(g);
  ScaledSystem shorter;
  shorter.speed = system.speed * static_cast<double>(g);
  shorter.T = system.T;
  shorter.T_inverse = system.T_inverse;
  shorter.G = system.G * factor;
  shorter.K_rounding = system.K_rounding * (factor * factor);
  shorter.diagonal_damping = system.diagonal_damping;
  shorter.K = FourierSeries(system.K.num_components(), system.K.num_harmonics() / g);
  for (Index k = 0; k <= shorter.K.num_harmonics(); ++k) shorter.K.c.col(k) = factor * factor * system.K.c.col(g * k);
  return shorter;
}

}  // namespace hb
