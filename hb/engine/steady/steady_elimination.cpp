#include "hb/engine/steady/steady_elimination.hpp"

#include <cmath>

#include "hb/engine/steady/steady_band.hpp"
#include "hb/engine/steady/steady_direct.hpp"

namespace hb::steady {

using Index = Eigen::Index;

Index factor_harmonics(const WeightedSystem& system) {
  constexpr double factor_accuracy = 1e-10;
  Index P = system.P;
  const auto scale = [&](Index i) { return factor_accuracy * (1 + std::abs(system.mean(i))); };
  const auto negligible = [&](Index m) {
    for (Index j = 0; j < system.I; ++j)
      for (Index i = 0; i < system.I; ++i)
        if (!(std::norm(system.K(i + system.I * j, m)) <= scale(i) * scale(j))) return false;
    return true;
  };
  while (P > 0 && negligible(P)) --P;
  return P;
}

std::unique_ptr<EliminatedInverse> eliminate(Operator& A) {
  if (BandInverse::suits(A)) return std::make_unique<BandInverse>(A);
  return std::make_unique<DirectInverse>(A);
}

bool EliminatedInverse::solve(const Spectrum& rhs, double relative, Spectrum& z) {
  // The factors give more digits than this of any operator that is not singular to rounding.
  constexpr double rough = 1e-4;
  const Index H = A_.num_harmonics();
  const auto size = [&](const Spectrum& r) {
    return (r.topRows(H + 1).array() / A_.magnitude().array().max(1e-300)).matrix().norm();
  };
  substitute(rhs, z);
  const double aim = relative * size(rhs);
  double last = HUGE_VAL;
  for (int refinement = 0; refinement < 6; ++refinement) {
    A_.couple(z, H, product_);
    residual_ = rhs.topRows(H + 1) - A_.D().cwiseProduct(z) - product_;
    const double now = size(residual_);
    if (now <= aim && (refinement > 0 || relative >= rough)) return true;
    if (!(now < 0.5 * last)) return now <= aim;
    last = now;
    substitute(residual_, correction_);
    z += correction_;
  }
  return last <= aim;
}

}  // namespace hb::steady
