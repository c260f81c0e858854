// What the rounding left in the invariance equations does to alpha; hb/engine/README.md (E7).
#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "hb/engine/exponents/slaving_iteration.hpp"
#include "lib/constants.hpp"
#include "lib/modulus.hpp"

namespace hb::slaving {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Nothing is taken to be carried by less than this part (a choice).
constexpr double least_carried = 0.01;

// exp(sum_m (z_m/m) y^m) = sum_d c_d y^d by c_d = sum_m z_m c_(d-m)/d; from each d on the largest, at most 1. With
// the last w of them at most l, all others at most L, and sum_m z_m l + sum_(m>w) z_m L <= d l, no later one is above
// l.
void carried_by(const VectorXd& z, VectorXd& back, VectorXd& c) {
  constexpr double most = 1e100;
  const Index H = z.size();
  back.setZero(H + 1);  // c_H .. c_0
  back(H) = 1;
  const double sum = z.sum();
  double largest = 1;  // of all c so far
  Index small = 0;  // so many of the last c are
  for (Index d = 1; d <= H; ++d) {
    const double next = std::min(z.head(d).dot(back.segment(H - d + 1, d)) / double(d), most);
    back(H - d) = next;
    largest = std::max(largest, next);
    small = next <= least_carried ? small + 1 : 0;
    const double room = (double(d) - sum) * least_carried;
    if (small > 0 && room >= 0 && z.tail(H - small).sum() * largest <= room) break;
  }
  c = back.reverse();
  for (Index d = H; d-- > 0;) c(d) = std::max(c(d), c(d + 1));
  c = c.cwiseMin(1.0).cwiseMax(least_carried);
}

// For each harmonic k the largest size_l carried from k to l. `padded` is room for the sizes between zeros.
void reached(const VectorXd& size, const VectorXd& carried, VectorXd& padded, VectorXd& result) {
  const Index count = size.size();
  Index farthest = 0;
  while (farthest + 1 < count && carried(farthest + 1) > least_carried) ++farthest;
  padded.setZero(count + 2 * farthest);
  padded.segment(farthest, count) = size;
  result.resize(count);
  const double least = least_carried * size.maxCoeff();
  const double* const middle = padded.data() + farthest;
  in_groups(count, [&]<int width>(std::integral_constant<int, width>, Index k) {
    Numbers<width> most = at<width>(middle + k).max(least);
    for (Index d = 1; d <= farthest; ++d)
      most = most.max(carried(d) * at<width>(middle + k - d).max(at<width>(middle + k + d)));
    at<width>(result.data() + k) = most;
  });
}

}  // namespace

double Iteration::carried_change(const FourierSeries& alpha) {
  const auto re = forward_.re(), im = forward_.im();
  const Index nm = n_ * m_;
  // What matters less than this part of alpha's rounding is not looked into.
  const double negligible = 0.01 * 4 * eps * alpha_.cwiseAbs().maxCoeff();
  double sum = 0, squares = 0, others = 0;
  VectorXd r1(H_ + 1), r2(H_ + 1), size1(H_ + 1), size2(H_ + 1), phase(H_), carried, back, padded, change;
  for (Index j = 0; j < n_; ++j) {
    const auto own = given_.c.row(F_[j] + I_ * F_[j]);
    const double fast = std::max(std::sqrt(std::abs(own(0).real())), 1e-3);
    for (Index l = 0; l < m_; ++l) {
      const Index q = j + n_ * l;
      const double most = effect_.row(q).dot(residual_.row(q));
      if (2 * most <= negligible) {
        others += most;
        continue;
      }
      phase.setZero();  // |K_m|/w_F + |alpha_m|/w_S of the harmonics from 1
      phase.head(own.size() - 1) = own.tail(own.size() - 1).cwiseAbs2().cwiseSqrt() / fast;
      for (Index s = 0; s < m_; ++s)
        phase += alpha.c.row(s + m_ * l).segment(1, H_).cwiseAbs2().cwiseSqrt().transpose() / weight_[std::size_t(l)];
      for (Index k = 0; k <= H_; ++k) {
        const double n = double(k);
        r1(k) = modulus({re(2 * nm + q, k) - n * im(q, k), im(2 * nm + q, k) + n * re(q, k)});
        r2(k) = modulus({re(3 * nm + q, k) - n * im(nm + q, k), im(3 * nm + q, k) + n * re(nm + q, k)});
        const double rate = diagonal_damping_ ? 1 : n + weight_[std::size_t(l)];
        size1(k) = rate * inverse_size_(q, k);
        size2(k) = rate * inverse_size_(nm + q, k);
      }
      carried_by(phase, back, carried);
      const auto add = [&](const VectorXd& r, const VectorXd& gain, double effect) {
        reached(gain, carried, padded, change);
        change.array() *= effect / gain.maxCoeff() * r.array();
        sum += 2 * change.sum() - change(0);
        squares += 2 * change.squaredNorm() - change(0) * change(0);
      };
      add(r1, size1, effect_(q, 0));
      add(r2, size2, effect_(q, 1));
    }
  }
  // Rounding of harmonics is independent for the most part, what is not yet solved is not.
  return std::min(2 * sum, 4 * std::sqrt(squares) + 0.25 * sum) + 2 * others;
}

}  // namespace hb::slaving
