// Iterative solution of the block Hill system: products by FFT, preconditioned mode by mode.
#pragma once

#include "hb/engine/steady/mode_factors.hpp"
#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

// GMRES, preconditioned from the right by each mode's own band M: its residuals are those of A, in the norm that is
// asked for.
class IterativeInverse : public Inverse {
 public:
  explicit IterativeInverse(Operator& A);
  bool solve(const Spectrum& rhs, double relative, Spectrum& z) override;

 private:
  // Adds to z what A^-1 makes of r until |W r| <= aim; false where it does not get there.
  bool reduce(const Spectrum& r, double aim, Spectrum& z);

  Operator& A_;
  ModeFactors factors_;
  // W of |W r|, the norm over the turn of r/|D|, conjugate pairs counting twice; a number each for real and imaginary
  // parts.
  Eigen::ArrayXd weight_, inverse_weight_;
  Spectrum direction_, product_;
};

}  // namespace hb::steady
