#include "lib/jacobi_rotations.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using Eigen::ArrayXXd;
using Eigen::Index;
using Rows = Eigen::Ref<ArrayXXd>;
using In = const double* __restrict;
using InOut = double* __restrict;

// Of what is left beside the diagonal, to the distance of the two entries that it is between.
constexpr double negligible = 1e-8;

// (a b; b d) of each row is turned until b is zero, by at most 45 degrees:
//     t = tan = b/(h + sign(h) sqrt(h^2 + b^2)),   h = (d - a)/2,   a - t b,   d + t b.
void make_diagonal(Index count, InOut a, InOut b, InOut d, InOut c, InOut s) {
  for (Index j = 0; j < count; ++j) {
    const double h = (d[j] - a[j]) / 2, root = std::sqrt(h * h + b[j] * b[j]) + 1e-300;
    const double t = b[j] / (h + std::copysign(root, h));
    c[j] = 1 / std::sqrt(1 + t * t);
    s[j] = t * c[j];
    a[j] -= t * b[j];
    d[j] += t * b[j];
    b[j] = 0;
  }
}

void turn_block(Index count, In c, In s, InOut a, InOut b, InOut d) {
  for (Index j = 0; j < count; ++j) {
    const double cc = c[j] * c[j], ss = s[j] * s[j], cs = c[j] * s[j];
    const double half = cs * (a[j] - d[j]), twice = 2 * cs * b[j], first = cc * a[j] + ss * d[j] - twice;
    d[j] = ss * a[j] + cc * d[j] + twice;
    a[j] = first;
    b[j] = (cc - ss) * b[j] + half;
  }
}

void turn(Index count, In c, In s, InOut x, InOut y) {
  for (Index j = 0; j < count; ++j) {
    const double first = c[j] * x[j] - s[j] * y[j];
    y[j] = s[j] * x[j] + c[j] * y[j];
    x[j] = first;
  }
}

// One sweep over all pairs of rows and columns that are coupled anywhere; false if none is.
bool sweep(Index n, Rows A, Rows B, ArrayXXd& angles) {
  const Index count = A.rows();
  double *c = angles.col(0).data(), *s = angles.col(1).data();
  bool turned = false;
  for (Index p = 0; p + 1 < n; ++p)
    for (Index q = p + 1; q < n; ++q) {
      const Index pp = symmetric_entry(n, p, p), pq = symmetric_entry(n, p, q), qq = symmetric_entry(n, q, q);
      if (!((A.col(pq).abs() - negligible * (A.col(qq) - A.col(pp)).abs()).maxCoeff() > 0)) continue;
      turned = true;
      make_diagonal(count, A.col(pp).data(), A.col(pq).data(), A.col(qq).data(), c, s);
      turn_block(count, c, s, B.col(pp).data(), B.col(pq).data(), B.col(qq).data());
      for (Index l = 0; l < n; ++l) {
        if (l == p || l == q) continue;
        const Index lp = symmetric_entry(n, l, p), lq = symmetric_entry(n, l, q);
        turn(count, c, s, A.col(lp).data(), A.col(lq).data());
        turn(count, c, s, B.col(lp).data(), B.col(lq).data());
      }
    }
  return turned;
}

bool are_ascending(Index n, const Rows& A) {
  for (Index q = 1; q < n; ++q)
    if ((A.col(symmetric_entry(n, q, q)) - A.col(symmetric_entry(n, q - 1, q - 1))).minCoeff() < 0) return false;
  return true;
}

void sort(Index n, Index row, Rows A, Rows B) {
  for (Index sorted = 1; sorted < n; ++sorted)
    for (Index q = sorted; q > 0; --q) {
      const Index p = q - 1, pp = symmetric_entry(n, p, p), qq = symmetric_entry(n, q, q);
      if (!(A(row, qq) < A(row, pp))) break;
      std::swap(A(row, pp), A(row, qq));
      std::swap(B(row, pp), B(row, qq));
      for (Index l = 0; l < n; ++l)
        if (l != p && l != q) std::swap(B(row, symmetric_entry(n, l, p)), B(row, symmetric_entry(n, l, q)));
    }
}

}  // namespace

bool diagonalise_all(Index n, Rows A, Rows B) {
  constexpr int most_sweeps = 16;
  ArrayXXd angles(A.rows(), 2);
  int sweeps = 0;
  while (sweep(n, A, B, angles))
    if (++sweeps == most_sweeps) return false;
  for (Index p = 0; p < n; ++p)
    for (Index q = p + 1; q < n; ++q) A.col(symmetric_entry(n, p, q)).setZero();
  for (Index row = 0; row < A.rows() && !are_ascending(n, A); ++row) sort(n, row, A, B);
  return true;
}

}  // namespace hb
