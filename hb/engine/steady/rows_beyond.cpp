#include "hb/engine/steady/rows_beyond.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

// c_i, all that couples row k of mode i to others.
double coupling(const WeightedSystem& s, Index i, Index k) {
  return s.coupling(i) + static_cast<double>(k) * s.G_off.row(i).cwiseAbs().sum();
}

// |D_i(k)| of rows beyond, where |D_i|^2 = (w^2 - k^2)^2 + (k G)^2 is least less what coupling may move w^2 by there,
//     2 sum_m (|K_m,ii|^2 |1/D_i(k+m) + 1/D_i(k-m)| + sum_{j != i} |K_m,ij|^2 (1/|D_j(k+m)| + 1/|D_j(k-m)|)),
// down to the damping or rounding at worst.
class Stiffness {
 public:
  // K: moduli, I*I x (P+1).
  Stiffness(const WeightedSystem& system, const Eigen::MatrixXd& K)
      : s_(&system), below_(system.I), nearest_(2, system.I) {
    constexpr double most = 1e12;
    for (Index i = 0; i < s_->I; ++i) {
      const double least = std::sqrt(std::max(s_->mean(i) - 0.5 * s_->G(i, i) * s_->G(i, i), 0.0));
      below_[static_cast<std::size_t>(i)] = static_cast<Index>(std::min(std::floor(least), most));
      for (Index n = 0; n < 2; ++n) {
        const Index k = below(i) + n;
        nearest_(n, i) = std::max({modulus(s_->D(i, k)) - 2 * moved(K, i, k),
                                   static_cast<double>(k) * std::abs(s_->G(i, i)), 32 * eps * s_->magnitude(i, k)});
      }
    }
  }

  double operator()(Index i, Index k) const {
    const Index n = k - below(i);
    return n == 0 || n == 1 ? nearest_(n, i) : modulus(s_->D(i, k));
  }

  // Largest c_i/|D_i(k)| over k >= first.
  double largest_answer(Index i, Index first) const {
    const Index k = std::max(below(i), first);
    return std::max(coupling(*s_, i, k) / (*this)(i, k), coupling(*s_, i, k + 1) / (*this)(i, k + 1));
  }

 private:
  Index below(Index i) const { return below_[static_cast<std::size_t>(i)]; }

  double moved(const Eigen::MatrixXd& K, Index i, Index k) const {
    const double least = 1e-8 * s_->coupling(i) * s_->coupling(i);
    double sum = 0;
    for (Index m = 1; m <= s_->P; ++m)
      for (Index j = 0; j < s_->I; ++j) {
        const double strength = K(i + s_->I * j, m) * K(i + s_->I * j, m);
        if (strength <= least) continue;
        const std::complex<double> up = s_->D(j, k + m), down = s_->D(j, std::abs(k - m));
        const double sizes = modulus(up) * modulus(down);
        sum += strength / sizes * (j == i ? modulus(up + down) : modulus(up) + modulus(down));
      }
    return sum;
  }

  const WeightedSystem* s_;
  std::vector<Index> below_;
  Eigen::MatrixXd nearest_;  // |D| at `below` and above it, 2 x I
};

}  // namespace

double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T) {
  double largest = 0;
  for (Index i = 0; i < T.rows(); ++i) {
    double sum = 0;
    for (Index j = 0; j < T.cols(); ++j) sum += std::abs(T(i, j)) * sizes(j);
    if (!std::isfinite(sum)) return sum;
    largest = std::max(largest, sum);
  }
  return largest;
}

// a_k,i = sum_m sum_j |K_m,ij| a_k-m,j / |D_i(k)|, row after row until no resonance is ahead and rows shrink, or all
// that are ahead could not make them count. The factor stands for what the answers do among themselves.
double answered_beyond(const WeightedSystem& s, const Eigen::MatrixXd& before, const Eigen::MatrixXd& T) {
  constexpr double among = 1.5, shrinking = 0.3, negligible = 1e-3;
  constexpr Index most_rows = 1000000;
  const Index I = s.I, P = s.P, R = before.rows() - 1;
  if (P == 0 || before.isZero(0)) return 0;
  const double known = 2 * weigh(before.colwise().sum(), T);
  // |K_m| of all m side by side for a_k-1, a_k-2, ..., a_k-P in one column, its last written row first.
  const Eigen::MatrixXd K = moduli(s.K);
  const Stiffness stiffness(s, K);
  Eigen::MatrixXd sums(I, I * P);
  for (Index m = 1; m <= P; ++m) sums.middleCols(I * (m - 1), I) = K.col(m).reshaped(I, I);
  const Eigen::MatrixXd within = K.col(0).reshaped(I, I) - Eigen::MatrixXd(s.mean.cwiseAbs().asDiagonal());
  Eigen::VectorXd last = Eigen::VectorXd::Zero(I * P), answer(I), total = Eigen::VectorXd::Zero(I);
  for (Index m = 0; m < std::min(P, R + 1); ++m) last.segment(I * m, I) = before.row(R - m);
  for (Index k = R + 1; k <= R + most_rows; ++k) {
    if ((k - R - 1) % P == 0) {
      end_if_wished();
      double ahead = 0, all = 1;
      for (Index i = 0; i < I; ++i) {
        const double one = stiffness.largest_answer(i, k);
        ahead = std::max(ahead, one);
        all *= std::max(one, 1.0);
      }
      const double size = 2 * weigh(last.reshaped(I, P).rowwise().sum(), T), so_far = 2 * weigh(total, T);
      if (ahead <= shrinking) return among * (so_far + size * ahead / (1 - ahead));
      if (size * all <= negligible * known) return among * (so_far + negligible * known);
      if (!std::isfinite(size)) break;
    }
    answer.noalias() = sums * last;
    for (Index i = 0; i < I; ++i) answer(i) /= stiffness(i, k);
    for (Index i = 0; i < I; ++i) {
      const double across = within.row(i).dot(answer) + static_cast<double>(k) * s.G_off.row(i).cwiseAbs().dot(answer);
      total(i) += answer(i) + across / stiffness(i, k);
    }
    std::shift_right(last.begin(), last.end(), I);
    last.head(I) = answer;
  }
  return HUGE_VAL;
}

}  // namespace hb::steady
