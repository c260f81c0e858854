#include "hb/engine/steady/steady_iterative.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/lanes.hpp"
#include "lib/workspace.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

constexpr int most_iterations = 60;

Eigen::Map<Eigen::ArrayXd> numbers(Spectrum& x) { return {reinterpret_cast<double*>(x.data()), 2 * x.size()}; }
Eigen::Map<const Eigen::ArrayXd> numbers(const Spectrum& x) {
  return {reinterpret_cast<const double*>(x.data()), 2 * x.size()};
}

// w <- w - factor v, and what is left times `next`, which may be w itself: in one pass through the numbers.
double taken_away(double factor, const double* v, const double* next, double* w, Index count) {
  constexpr Index width = Lanes::width, together = 4;
  Lanes sums[together];
  Index n = 0;
  for (; n + together * width <= count; n += together * width)
    for (Index i = 0; i < together; ++i) {
      const Index at = n + i * width;
      const Lanes left = Lanes::load(w + at) - factor * Lanes::load(v + at);
      left.store(w + at);
      sums[i] += left * Lanes::load(next + at);
    }
  double product = 0;
  for (const double part : ((sums[0] + sums[1]) + (sums[2] + sums[3])).values()) product += part;
  for (; n < count; ++n) {
    w[n] -= factor * v[n];
    product += w[n] * next[n];
  }
  return product;
}

// Least squares |b - R_j y| of GMRES, R_j of j + 1 rows and j columns: turned column by column to a triangle, b to g.
class HessenbergSquares {
 public:
  explicit HessenbergSquares(double size) : R_(most_iterations + 1, most_iterations), g_(most_iterations + 1) {
    g_(0) = size;
  }
  int columns() const { return columns_; }
  double rest() const { return std::abs(g_(columns_)); }
  // Numbers of the next column.
  Eigen::Ref<Eigen::VectorXd> next() { return R_.col(columns_).head(columns_ + 2); }
  // Takes the next column; false where it vanishes.
  bool add() {
    const int j = columns_;
    for (int i = 0; i < j; ++i) turn(i, R_(i, j), R_(i + 1, j));
    const double length = std::hypot(R_(j, j), R_(j + 1, j));
    if (!(length > 0)) return false;
    cosines_[j] = R_(j, j) / length;
    sines_[j] = R_(j + 1, j) / length;
    R_(j, j) = length;
    g_(j + 1) = 0;
    turn(j, g_(j), g_(j + 1));
    ++columns_;
    return true;
  }
  // y, a number for each direction but the last.
  Eigen::VectorXd solution() const {
    return R_.topLeftCorner(columns_, columns_).triangularView<Eigen::Upper>().solve(g_.head(columns_));
  }

 private:
  void turn(int i, double& upper, double& lower) const {
    const double u = upper;
    upper = cosines_[i] * u + sines_[i] * lower;
    lower = cosines_[i] * lower - sines_[i] * u;
  }
  Eigen::MatrixXd R_;
  Eigen::VectorXd g_;
  double cosines_[most_iterations], sines_[most_iterations];
  int columns_ = 0;
};

}  // namespace

IterativeInverse::IterativeInverse(Operator& A) : A_(A), factors_(A), weight_(2 * A.magnitude().size()) {
  const Index rows = A.num_harmonics() + 1;
  for (Index i = 0; i < A.num_modes(); ++i)
    for (Index k = 0; k < rows; ++k)
      weight_.segment<2>(2 * (rows * i + k)).setConstant((k > 0 ? std::sqrt(2.0) : 1) / A.magnitude()(k, i));
  inverse_weight_ = weight_.inverse();
}

// A X_j = W^-1 V_j+1 R_j with X_j = M^-1 W^-1 V_j, and y that makes |W r - V_j+1 R_j y| least: z + X_j y has a residual
// of that size.
bool IterativeInverse::reduce(const Spectrum& r, double aim, Spectrum& z) {
  const Index H = A_.num_harmonics(), n = weight_.size();
  thread_local Workspace directions;
  Eigen::Map<Eigen::MatrixXd> both = directions.matrix(n, 2 * most_iterations + 1);
  auto V = both.leftCols(most_iterations + 1);
  auto X = both.rightCols(most_iterations);
  V.col(0) = numbers(r) * weight_;
  const double size = V.col(0).norm();
  if (!(size > 0) || !std::isfinite(size)) return size == 0;
  V.col(0) /= size;
  HessenbergSquares squares(size);
  bool reached = false;
  direction_.resize(H + 1, A_.num_modes());
  while (!reached && squares.columns() < most_iterations) {
    const int j = squares.columns();
    numbers(direction_) = V.col(j).array() * inverse_weight_;
    factors_.solve_in_place(direction_);
    X.col(j) = numbers(direction_);
    A_.couple(direction_, H, product_);
    product_ += A_.D().cwiseProduct(direction_);
    V.col(j + 1) = numbers(product_) * weight_;
    auto column = squares.next();
    double* const w = V.col(j + 1).data();
    double product = V.col(0).dot(V.col(j + 1));
    for (int i = 0; i <= j; ++i) {
      column(i) = product;
      product = taken_away(product, V.col(i).data(), V.col(i + 1).data(), w, n);
    }
    const double rest = column(j + 1) = std::sqrt(product);
    if (!std::isfinite(rest)) return false;
    if (!squares.add()) break;
    reached = squares.rest() <= aim;
    if (!(rest > 0)) break;
    V.col(j + 1) /= rest;
  }
  Eigen::Map<Eigen::VectorXd>(numbers(z).data(), n).noalias() += X.leftCols(squares.columns()) * squares.solution();
  return reached;
}

// What iterations say of the residual is not asked again, unless rounding of a large z may hide it.
bool IterativeInverse::solve(const Spectrum& rhs, double relative, Spectrum& z) {
  const Index H = A_.num_harmonics();
  constexpr int most_restarts = 4;
  constexpr double rounding = 8 * eps;
  Spectrum r = rhs.topRows(H + 1);
  z.setZero(H + 1, A_.num_modes());
  const auto size = [&] { return (numbers(r) * weight_).matrix().norm(); };
  const double load = size();
  if (!(load > 0)) return load == 0;
  double last = HUGE_VAL;
  for (int restart = 0;; ++restart) {
    const double now = size();
    if (now <= relative * load) return true;
    if (restart == most_restarts || !(now < 0.5 * last)) return false;
    last = now;
    const bool reached = reduce(r, relative * load, z);
    if (!z.allFinite()) return false;
    if (reached && rounding * z.norm() <= relative * load) return true;
    A_.couple(z, H, r);
    r = rhs.topRows(H + 1) - A_.D().cwiseProduct(z) - r;
  }
}

}  // namespace hb::steady
