// From maps over the segments of a turn to the periodic state and the Floquet multipliers, without forming what
// overflows or vanishes.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace hb {

// y_(k+1) = Phi_k y_k + p_k, k = 0..N-1.
struct SegmentMap {
  Eigen::MatrixXd transition;  // Phi_k
  Eigen::VectorXd particular;  // p_k
};

struct CyclicSolution {
  std::vector<Eigen::VectorXd> states;  // y_0..y_(N-1), with y_N = y_0
  double reciprocal_condition = 0;  // of the last, condensed system; 0: singular
};

// Structured orthogonal elimination around the cycle: stable for growing and decaying solutions together (S. J. Wright,
// SIAM J. Sci. Stat. Comput. 13 (1992) 742, doi:10.1137/0913044).
[[nodiscard]] CyclicSolution solve_cyclic(const std::vector<SegmentMap>& segments);

// Log of an eigenvalue of Phi_(N-1) ... Phi_0: real part log modulus, imaginary part its argument in (-pi, pi].
struct LogMultiplier {
  std::complex<double> value;
  double amplification = 1;  // a relative error of every segment map appears in `value` about this much larger
};

struct LogMultipliers {
  std::vector<LogMultiplier> values;  // real part descending; those above the noise
  bool some_below = false;  // others vanished below `noise` in some segment
};

// Orthogonal iteration over the turn: the triangular factors of the segments keep every growth rate apart. A direction
// that shrinks against the largest entry of its segment by more than `noise` is below what the maps resolve.
[[nodiscard]] LogMultipliers log_multipliers(const std::vector<SegmentMap>& segments, double noise);

}  // namespace hb
