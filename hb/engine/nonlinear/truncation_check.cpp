#include "hb/engine/nonlinear/truncation_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/dense.hpp"

namespace hb::nonlinear {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

VectorXd with_zeros(const VectorXd& u, Index size) {
  VectorXd result = VectorXd::Zero(size);
  result.head(u.size()) = u;
  return result;
}

// Inverse of the mean blocks beyond the window.
class Tail {
 public:
  Tail(const HarmonicBalance& coarse, const Linearisation& linear, double p, Index last)
      : n_(coarse.num_components()), first_(coarse.num_harmonics() + 1) {
    for (Index k = first_; k <= last; ++k) blocks_.emplace_back(coarse.mean_block(linear, p, k));
  }
  void solve(const VectorXd& F, VectorXd& e) const {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Index row = n_ * (2 * (first_ + Index(b)) - 1);
      Eigen::VectorXcd right(n_);
      right.real() = F.segment(row, n_);
      right.imag() = F.segment(row + n_, n_);
      const Eigen::VectorXcd x = blocks_[b].solve(right);
      e.segment(row, n_) = x.real();
      e.segment(row + n_, n_) = x.imag();
    }
  }

 private:
  Index n_, first_;
  std::vector<dense::Lu<std::complex<double>>> blocks_;
};

}  // namespace

TruncationCheck check_truncation(const NonlinearSystem& system, const Corrector& corrector,
                                 const HarmonicBalance& coarse, const Unknowns& x, const Constraint& constraint,
                                 double p_scale, double tolerance, const std::function<bool()>& stop) {
  const Index n = coarse.num_components(), N = 2 * coarse.num_samples();
  // All harmonics that the samples show: where a motion has every third one only, twice as many would not be enough.
  HarmonicBalance fine(system, coarse.turns(), N / 2 - 1, N);
  TruncationCheck check;
  const VectorXd start = with_zeros(x.u, fine.num_unknowns());
  check.finer = {start, x.p};
  const double enough = tolerance * size(x.u, n);
  const auto judged = [&](const VectorXd& from, const VectorXd& left) {
    check.found = true;
    check.error = sizes(check.finer.u - from, n) + left;
    check.parameter_error = std::abs(check.finer.p - x.p);
    return check;
  };
  const Tail tail(coarse, corrector.linearisation(), x.p, fine.num_harmonics());
  constexpr int most_steps = 12;
  constexpr double too_slow = 0.5;
  VectorXd F, e(fine.num_unknowns());
  double last = HUGE_VAL;
  for (int step = 0; step < most_steps; ++step) {
    if (stop && stop()) return check;
    if (auto failure = fine.residual(check.finer.u, check.finer.p, F)) {
      check.failure = *failure;
      break;
    }
    const Unknowns window = corrector.apply(-F.head(x.u.size()));
    e.head(x.u.size()) = window.u;
    tail.solve(-F, e);
    const double now = size(e, n), theta = now / last;
    if (!std::isfinite(now)) break;
    if (step > 0 && !(theta <= too_slow) && !(now <= enough)) break;
    check.finer.u += e;
    check.finer.p += window.p;
    check.evaluations = fine.evaluated_samples();
    if (now <= enough && step > 0) return judged(start, sizes(e, n));
    last = now;
  }
  // By Newton's method on twice the harmonics, and a few more where these are few.
  const Index H = 2 * coarse.num_harmonics() + 4 * coarse.turns();
  HarmonicBalance twice(system, coarse.turns(), H, std::max(N, samples_for(H)));
  const VectorXd padded_start = with_zeros(x.u, twice.num_unknowns());
  check.finer = {padded_start, x.p};
  Constraint wide = constraint;
  if (!wide.holds_parameter()) wide.row = with_zeros(constraint.row, twice.num_unknowns());
  Corrector newton(twice, p_scale, stop);
  const Correction correction = newton.solve(check.finer, wide, tolerance, false, 8);
  check.evaluations = fine.evaluated_samples() + twice.evaluated_samples();
  if (correction.status != CorrectionStatus::converged) {
    check.failure = correction.failure;
    return check;
  }
  return judged(padded_start, VectorXd::Constant(n, correction.last));
}

Index harmonics_needed(const VectorXd& u, Index num_components, double tolerance) {
  const Index n = num_components, H = (u.size() / n - 1) / 2;
  const double allowed = tolerance * size(u, n);
  VectorXd sum = VectorXd::Zero(n);
  for (Index k = H; k >= 1; --k) {
    for (Index i = 0; i < n; ++i) sum(i) += 2 * std::hypot(u(n * (2 * k - 1) + i), u(n * 2 * k + i));
    if (!(sum.maxCoeff() <= allowed)) return k;
  }
  return 0;
}

}  // namespace hb::nonlinear
