// Growth of several exponents that come near each other between places where they are known: the coefficients of
//     prod_j (w - w_j),      w_j = -i (s_j - m),      m the mean of the s_j,      imaginary parts modulo 1,
// are analytic where the w_j have branches, whichever of them is which. Of two it is (B2): w^2 + Q.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace hb {

struct ClusterNode {
  double x = 0;
  double growth = 0;  // Re m
  double growth_error = 0;
  std::vector<std::complex<double>> w;
  std::vector<std::complex<double>> c;  // of w^0 .. w^(n-2); that of w^(n-1) is zero
  std::vector<double> c_error;
  bool real = false;  // all s_j on one line Re s = const, or in pairs on either side of it
};

// Less than half a turn apart.
[[nodiscard]] ClusterNode cluster_node(double x, std::span<const std::complex<double>> s,
                                       std::span<const double> error);

class ClusterModel {
 public:
  // Four nodes; between x of the first two.
  explicit ClusterModel(std::vector<ClusterNode> nodes) : nodes_(std::move(nodes)) {}

  struct Bounds {
    double growth = 0;  // upper one, of all exponents; not below `told` where that suffices
    double apart = 0;  // of the nearest two
  };
  [[nodiscard]] Bounds operator()(double x, double told) const;

 private:
  std::vector<ClusterNode> nodes_;
};

}  // namespace hb
