#include "hb/analysis/disturbance.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/hill_sensitivity.hpp"

namespace hb {

// x_k e^(i nu_k t) and its conjugate make one line |nu_k|; so do two k of one size of nu_k, as where lambda is locked
// to the speed or to half of it.
std::vector<DisturbanceLine> disturbance_lines(const HillSystem& system, double speed, const Exponent& exponent,
                                               double least) {
  const std::optional<FloquetVectors> vectors = floquet_vectors(system, speed, exponent);
  if (!vectors) return {};
  const Eigen::Index H = (vectors->x.cols() - 1) / 2;
  const double same = 1e-6 * speed;
  std::vector<DisturbanceLine> lines;
  for (Eigen::Index k = -H; k <= H; ++k) {
    const double nu = std::abs(vectors->s.imag() + static_cast<double>(k) * speed), size = vectors->x.col(k + H).norm();
    const auto known = std::find_if(lines.begin(), lines.end(),
                                    [&](const DisturbanceLine& line) { return std::abs(line.frequency - nu) <= same; });
    if (known == lines.end())
      lines.push_back({nu, size});
    else
      known->share += size;
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const DisturbanceLine& a, const DisturbanceLine& b) { return a.share > b.share; });
  const double strongest = lines.front().share;
  for (DisturbanceLine& line : lines) line.share /= strongest;
  std::erase_if(lines, [&](const DisturbanceLine& line) { return !(line.share >= least); });
  return lines;
}

}  // namespace hb
