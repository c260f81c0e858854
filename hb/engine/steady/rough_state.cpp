#include "hb/engine/steady/rough_state.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/steady/steady_iterative.hpp"
#include "hb/engine/steady/truncation.hpp"

namespace hb {

std::optional<FourierSeries> rough_steady_state(const HillSystem& system, double speed, double tolerance) {
  constexpr Eigen::Index most_harmonics = 256;
  const ScaledSystem scaled = scale_system(system, speed);
  if (scaled.load_scale == 0) return FourierSeries(system.num_modes(), 0);
  const steady::WeightedSystem weighted = steady::weighted(scaled);
  const Eigen::Index H = steady::predicted_harmonics(weighted, tolerance, most_harmonics);
  if (H >= most_harmonics) return std::nullopt;
  steady::Operator A(weighted, H);
  steady::Spectrum f = steady::Spectrum::Zero(H + 1, weighted.I), x;
  const Eigen::Index rows = std::min(H + 1, weighted.f.rows());
  f.topRows(rows) = weighted.f.topRows(rows);
  steady::IterativeInverse inverse(A);
  if (!inverse.solve(f, tolerance, x) || !x.allFinite()) return std::nullopt;
  const Eigen::MatrixXd T = scaled.load_scale * scaled.T * weighted.weight.cwiseInverse().asDiagonal();
  FourierSeries q(Eigen::MatrixXcd(T * x.transpose()));
  q.c.col(0) = q.c.col(0).real().cast<std::complex<double>>().eval();
  return q;
}

double nearest_amplification(const HillSystem& system, double speed) {
  const Eigen::Index I = system.num_modes();
  const FourierSeries C = stiffness_at(system, speed);
  double largest = 1;
  for (Eigen::Index i = 0; i < I; ++i) {
    const double c = C.c(i + I * i, 0).real(), m = system.mass(i, i), b = system.damping(i, i);
    const double nearest = std::round(std::sqrt(std::max(0.0, c / m)) / speed);
    for (const double n : {nearest - 1, nearest, nearest + 1}) {
      const double omega = n * speed, inertia = m * omega * omega, damping = std::abs(b * omega);
      largest = std::max(largest, (std::abs(c) + inertia + damping) / std::hypot(c - inertia, damping));
    }
  }
  return largest;
}

}  // namespace hb
