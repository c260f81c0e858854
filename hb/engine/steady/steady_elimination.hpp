// Inverses of the block Hill operator by elimination: in blocks (steady_direct.hpp) or in a band (steady_band.hpp).
#pragma once

#include <memory>

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

class EliminatedInverse : public Inverse {
 public:
  // Refined with exact products: once at least where `relative` is small.
  bool solve(const Spectrum& rhs, double relative, Spectrum& z) override;
  // False if a factor has a vanishing pivot.
  bool regular() const { return regular_; }

 protected:
  // Pivots from here down count as zero.
  static constexpr double smallest_pivot = 1e-300;

  explicit EliminatedInverse(Operator& A) : A_(A) {}
  // By the factors alone.
  virtual void substitute(const Spectrum& rhs, Spectrum& z) const = 0;

  Operator& A_;
  bool regular_ = true;

 private:
  Spectrum product_, correction_, residual_;  // of solve(), kept from one to the next
};

// Whichever suits the operator.
[[nodiscard]] std::unique_ptr<EliminatedInverse> eliminate(Operator& A);

// Harmonics of K above 1e-10 of the diagonal enter the factors: one refinement gains as many digits.
[[nodiscard]] Eigen::Index factor_harmonics(const WeightedSystem& system);

}  // namespace hb::steady
