// Iterative solution of the block Hill system: products by FFT, the diagonal of each harmonic as preconditioner.
#pragma once

#include <vector>

#include "hb/engine/steady/steady_operator.hpp"
#include "lib/dense.hpp"

namespace hb::steady {

// Fixed point z <- D^-1 (rhs - E z) while it contracts well; then GMRES, preconditioned from the left by D and, on a
// small core of strongly coupled (mode, harmonic) pairs, by the exact restriction of A.
class IterativeInverse : public Inverse {
 public:
  explicit IterativeInverse(Operator& A);
  bool solve(const Spectrum& rhs, double relative, Spectrum& z) override;

 private:
  struct Pair {
    Eigen::Index mode, harmonic;
  };
  // Unknowns as a real vector: conjugate pairs count twice in a norm over the turn, hence sqrt(2).
  Eigen::Map<const Eigen::VectorXd> real(const Spectrum& x) const {
    return {reinterpret_cast<const double*>(x.data()), 2 * x.size()};
  }
  void make_core();
  void precondition(Spectrum& r) const;  // M^-1 r
  void apply(const Spectrum& x, Spectrum& y);  // M^-1 A x
  bool fixed_point(const Spectrum& rhs, double relative, Spectrum& z, Spectrum& change, double& size);
  // From zero; stops when the preconditioned residual has fallen by `relative`.
  bool gmres(const Spectrum& b, double relative, Spectrum& z);

  Operator& A_;
  Spectrum D_inverse_;
  bool core_known_ = false;
  bool try_fixed_point_ = true;
  std::vector<Pair> core_;
  dense::Lu<double> core_lu_;
  Spectrum scratch_;
};

}  // namespace hb::steady
