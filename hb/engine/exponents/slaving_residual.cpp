// What the rounding left in the invariance equations does to alpha; hb/engine/README.md (E7).
#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "hb/engine/exponents/slaving_iteration.hpp"
#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/workspace.hpp"

namespace hb::slaving {

using Eigen::Index;

namespace {

// Nothing is taken to be carried by less than this part (a choice).
constexpr double least_carried = 0.01;

// exp(sum_m (z_m/m) y^m) = sum_d c_d y^d by c_d = sum_m z_m c_(d-m)/d; carried is from each d on the largest, at
// most 1. Returned is the last d that more than the least is carried by; carried(d) is given up to there. With the last
// w of the c at most l, all others at most L, and sum_m z_m l + sum_(m>w) z_m L <= d l, no later one is above l. `back`
// is room for H + 1 numbers, H those of z.
template <class Column>
Index carried_by(const Column& z, Column& back, Column& carried) {
  constexpr double most = 1e100;
  const Index H = z.size();
  back(H) = 1;  // c_H .. c_0
  const double sum = z.sum();
  double largest = 1;  // of all c so far
  Index small = 0, last = 0;  // so many of the last c are; the last c
  while (last < H) {
    const Index d = ++last;
    const double next = std::min(z.head(d).dot(back.segment(H - d + 1, d)) / double(d), most);
    back(H - d) = next;
    largest = std::max(largest, next);
    small = next <= least_carried ? small + 1 : 0;
    const double room = (double(d) - sum) * least_carried;
    if (small > 0 && room >= 0 && z.tail(H - small).sum() * largest <= room) break;
  }
  double later = 0;
  Index farthest = 0;
  for (Index d = last; d > 0; --d) {
    later = std::max(back(H - d), later);
    carried(d) = std::min(later, 1.0);
    if (farthest == 0 && !(later <= least_carried)) farthest = d;
  }
  return farthest;
}

}  // namespace

double Iteration::carried_change(const Eigen::Ref<const Eigen::MatrixXcd>& alpha) {
  const auto re = forward_.re(), im = forward_.im();
  const Index nm = n_ * m_, count = H_ + 1;
  // What matters less than this part of alpha's rounding is not looked into.
  const double negligible = 0.01 * 4 * eps * alpha_.cwiseAbs().maxCoeff();
  thread_local Workspace kept;
  auto room = kept.matrix(count, 9);
  Column slow(&room(0, 0), H_), phase(&room(0, 1), H_), carried(&room(0, 2), count), back(&room(0, 3), count),
      r(&room(0, 4), count), change(&room(0, 5), count);
  double sum = 0, squares = 0, others = 0;
  for (Index l = 0; l < m_; ++l) {
    const double weight = weight_(n_ * l);
    // Of the harmonics from 1 |alpha_m|/w_S, and with it |K_m|/w_F.
    slow.setZero();
    for (Index s = 0; s < m_; ++s) slow += moduli(alpha.col(s + m_ * l).tail(H_)) / weight;
    for (Index j = 0; j < n_; ++j) {
      const Index q = j + n_ * l;
      const double most = effect_(q) * residual_(q) + effect_(nm + q) * residual_(nm + q);
      if (2 * most <= negligible) {
        others += most;
        continue;
      }
      const auto own = given_.c.row(F_[j] + I_ * F_[j]);
      const double fast = std::max(std::sqrt(std::abs(own(0).real())), 1e-3);
      phase = slow;
      phase.head(own.size() - 1) += moduli(own.tail(own.size() - 1)).transpose() / fast;
      const Index farthest = carried_by(phase, back, carried);
      // Of each equation: for each harmonic k the largest size_l carried from k to l, sizes between zeros.
      Column padded(&room(0, 6), count + 2 * farthest), size(padded.data() + farthest, count);
      padded.head(farthest).setZero();
      padded.tail(farthest).setZero();
      for (const Index first : {q, nm + q}) {
        for (Index k = 0; k < count; ++k) {
          const double n = double(k), rate = diagonal_damping_ ? 1 : n + weight;
          r(k) = modulus({re(2 * nm + first, k), im(2 * nm + first, k)});
          size(k) = rate * inverse_size_(first, k);
        }
        const double largest = size.maxCoeff(), least = least_carried * largest, by = effect_(first) / largest;
        in_groups(count, [&]<int width>(std::integral_constant<int, width>, Index k) {
          const double* const middle = size.data() + k;
          Numbers<width> reached = at<width>(middle).max(least);
          for (Index d = 1; d <= farthest; ++d)
            reached = reached.max(carried(d) * at<width>(middle - d).max(at<width>(middle + d)));
          at<width>(&change(k)) = reached * (by * at<width>(&r(k)));
        });
        sum += 2 * change.sum() - change(0);
        squares += 2 * change.squaredNorm() - change(0) * change(0);
      }
    }
  }
  // Rounding of harmonics is independent for the most part, what is not yet solved is not.
  return std::min(2 * sum, 4 * std::sqrt(squares) + 0.25 * sum) + 2 * others;
}

}  // namespace hb::slaving
