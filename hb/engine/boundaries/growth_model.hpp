// Growth of exponents between places where they are known, by interpolation of what is analytic there: of a single
// strand s itself, of two that may meet the mean of their growth and
//     Q = ((s_a - s_b)/2)^2,    imaginary part modulo 1,
// which has no branch where the two meet: Q ~ kappa^2 - c^2 (x - x_0)^2 beside a resonance of centre x_0.
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <vector>

namespace hb {

struct GrowthNode {
  double x = 0;
  double growth = 0;  // of the single strand, or the mean of the two
  double angle = 0;  // imaginary part of the single strand, or of the middle of the two; modulo 1
  std::complex<double> Q;
  double growth_error = 0, Q_error = 0;
};

// Two strands; errors are those of the exponents.
[[nodiscard]] GrowthNode pair_node(double x, std::complex<double> a, std::complex<double> b, double error_a,
                                   double error_b);

// Between two places, where a model is looked at: dense at both ends, where an interpolation's error vanishes with the
// distance.
[[nodiscard]] std::vector<double> probes(double from, double to);

struct GrowthBounds {
  double low = 0, high = 0;
};

class GrowthModel {
 public:
  // Between x of the first two nodes; up to two more beside them, nearest first. Without these nothing is bounded.
  explicit GrowthModel(std::vector<GrowthNode> nodes);

  // Larger growth of the two at x, with the interpolation's error: the difference between the polynomials through all
  // nodes and through all but the last one.
  GrowthBounds operator()(double x) const;
  // All nodes but one predict that one.
  bool consistent() const;
  // Where the two come nearest to each other or lock deepest.
  double centre() const;
  // How far Re Q at the centre exceeds what it is at the two places.
  double rise() const;
  // Of the exponents at the two places.
  double error() const { return std::max(nodes_[0].growth_error, nodes_[1].growth_error); }
  double mean_growth() const { return 0.5 * (nodes_[0].growth + nodes_[1].growth); }

 private:
  std::vector<GrowthNode> nodes_;
  bool real_ = true;  // Q is real: a conjugate pair modulo i
  // The two pass each other, without a lock, at one of the two places and at a third one beside it.
  bool pass_beside_ = false;
};

}  // namespace hb
