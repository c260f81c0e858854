#include "hb/engine/system/independent_parts.hpp"

#include <Eigen/Core>
#include <numeric>

namespace hb {

using Eigen::Index;

namespace {

using Reach = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

// (i, j): mode i feels mode j.
Reach couplings(const ScaledSystem& system) {
  const Index I = system.num_modes();
  Reach coupled(I, I);
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < I; ++j)
      coupled(i, j) = i == j || system.G(i, j) != 0 || (system.K.c.row(i + I * j).array() != 0.0).any();
  return coupled;
}

// Through any number of others (Warshall).
Reach closure(Reach reach) {
  for (Index via = 0; via < reach.rows(); ++via)
    for (Index i = 0; i < reach.rows(); ++i)
      if (reach(i, via)) reach.row(i) = reach.row(i) || reach.row(via);
  return reach;
}

// Classes of an equivalence.
std::vector<std::vector<int>> classes(const Reach& same) {
  std::vector<std::vector<int>> groups;
  for (Index i = 0; i < same.rows(); ++i) {
    if (same.row(i).head(i).any()) continue;
    std::vector<int>& group = groups.emplace_back();
    for (Index j = i; j < same.rows(); ++j)
      if (same(i, j)) group.push_back(static_cast<int>(j));
  }
  return groups;
}

}  // namespace

std::vector<std::vector<int>> independent_groups(const ScaledSystem& system) {
  if (system.num_modes() == 1) return {{0}};
  const Reach coupled = couplings(system);
  return classes(closure(coupled || coupled.transpose()));
}

std::vector<std::vector<int>> one_way_groups(const ScaledSystem& system) {
  if (system.num_modes() == 1) return {{0}};
  const Reach reach = closure(couplings(system));
  return classes(reach && reach.transpose());
}

ScaledSystem group_of(const ScaledSystem& system, const std::vector<int>& modes) {
  const Index I = system.num_modes(), m = static_cast<Index>(modes.size());
  ScaledSystem part;
  part.speed = system.speed;
  part.T = system.T(Eigen::all, modes);
  part.T_inverse = system.T_inverse(modes, Eigen::all);
  part.G = system.G(modes, modes);
  part.K_rounding = system.K_rounding(modes, modes);
  part.G_error = system.G_error(modes, modes);
  part.diagonal_damping = part.G.isDiagonal(0);
  part.conservative = system.conservative(modes);
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
  shorter.G_error = system.G_error * factor;
  shorter.diagonal_damping = system.diagonal_damping;
  shorter.conservative = system.conservative;
  shorter.K = FourierSeries(system.K.num_components(), system.K.num_harmonics() / g);
  for (Index k = 0; k <= shorter.K.num_harmonics(); ++k) shorter.K.c.col(k) = factor * factor * system.K.c.col(g * k);
  return shorter;
}

}  // namespace hb
