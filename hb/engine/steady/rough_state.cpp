#include "hb/engine/steady/rough_state.hpp"

#include <cmath>

#include "hb/engine/steady/steady_iterative.hpp"
#include "hb/engine/steady/truncation.hpp"

namespace hb {

std::optional<RoughState> rough_steady_state(const HillSystem& system, double speed, double tolerance) {
  constexpr Eigen::Index most_harmonics = 256;
  const ScaledSystem scaled = scale_system(system, speed);
  if (scaled.load_scale == 0) return RoughState{FourierSeries(system.num_modes(), 0), 0};
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
  RoughState state{FourierSeries(Eigen::MatrixXcd(T * x.transpose())), 0};
  state.q.c.col(0) = state.q.c.col(0).real().cast<std::complex<double>>().eval();
  state.amplification = std::sqrt(2 * x.squaredNorm() - x.row(0).squaredNorm()) / A.scaled_norm(f);
  return state;
}

}  // namespace hb
