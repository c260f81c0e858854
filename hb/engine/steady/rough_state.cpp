#include "hb/engine/steady/rough_state.hpp"

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

}  // namespace hb
