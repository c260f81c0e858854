#include "hb/engine/steady/steady_iterative.hpp"

#include <algorithm>
#include <cmath>

#include "lib/modulus.hpp"
#include "lib/workspace.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;
using std::sqrt;

// Break-even between fixed point and GMRES with a core, per iteration: an experience with elastic rods.
constexpr double largest_contraction = 0.35;
// Pairs with (largest own coupling)/|D| above this enter the core; below 0.1 the core costs more than it saves.
constexpr double core_threshold = 0.5;
constexpr std::size_t largest_core = 96;  // pairs
constexpr int most_iterations = 60;

double turn_norm(const Spectrum& x) { return sqrt(2 * x.squaredNorm() - x.row(0).squaredNorm()); }

}  // namespace

IterativeInverse::IterativeInverse(Operator& A) : A_(A), D_inverse_(A.D()) {
  const Index H = A.num_harmonics();
  double contraction = 0;
  for (Index i = 0; i < A.num_modes(); ++i)
    for (Index k = 0; k <= H; ++k) {
      const std::complex<double> d = A.D()(k, i);
      const double size = modulus(d);
      // A vanishing diagonal belongs to the core; outside it this keeps the preconditioner finite.
      D_inverse_(k, i) = size > 1e-8 * A.magnitude()(k, i) ? 1.0 / d : 1.0 / std::max(A.magnitude()(k, i), 1e-300);
      if (!(size > 1e-8 * A.magnitude()(k, i))) contraction = HUGE_VAL;
      contraction = std::max(contraction, A.system().own_coupling(i) / size);
    }
  // The bound is pessimistic: several times the true contraction is common.
  try_fixed_point_ = contraction < 3;
}

// A restricted to the core, real unknowns Re, Im per pair (Im of harmonic 0 absent):
// row (i,k), column (j,l): (A_{k-l} + [l>0] K_{k+l}) on Re x, i (A_{k-l} - K_{k+l}) on Im x.
void IterativeInverse::make_core() {
  core_known_ = true;
  const WeightedSystem& s = A_.system();
  const Index I = s.I, H = A_.num_harmonics();
  std::vector<std::pair<double, Pair>> candidates;
  for (Index i = 0; i < I; ++i)
    for (Index k = 0; k <= H; ++k) {
      const double size = modulus(A_.D()(k, i)), magnitude = A_.magnitude()(k, i);
      const double ratio = std::max(s.own_coupling(i), 1e-8 * magnitude) / std::max(size, 1e-300);
      if (ratio > core_threshold) candidates.push_back({ratio, {i, k}});
    }
  if (candidates.size() > largest_core) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    candidates.resize(largest_core);
  }
  core_.clear();
  for (const auto& [ratio, pair] : candidates) core_.push_back(pair);
  const Index n = 2 * static_cast<Index>(core_.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (Index c = 0; c < n / 2; ++c) {
    const auto [j, l] = core_[static_cast<std::size_t>(c)];
    for (Index r = 0; r < n / 2; ++r) {
      const auto [i, k] = core_[static_cast<std::size_t>(r)];
      const Index m = k - l;
      std::complex<double> direct = 0, conjugate = 0;
      if (std::abs(m) <= s.P) direct = m >= 0 ? s.K(i + I * j, m) : std::conj(s.K(i + I * j, -m));
      if (m == 0) {
        const double harmonic = static_cast<double>(k);
        direct += std::complex<double>(0, harmonic * s.G(i, j));
        if (i == j) direct -= harmonic * harmonic;
      }
      if (l > 0 && k + l <= s.P) conjugate = s.K(i + I * j, k + l);
      const std::complex<double> cosine = direct + conjugate, sine = direct - conjugate;
      a(2 * r, 2 * c) = cosine.real();
      a(2 * r + 1, 2 * c) = k > 0 ? cosine.imag() : 0;
      a(2 * r, 2 * c + 1) = l > 0 ? -sine.imag() : 0;
      a(2 * r + 1, 2 * c + 1) = k > 0 && l > 0 ? sine.real() : 0;
      if (r == c && k == 0) a(2 * r + 1, 2 * c + 1) = 1;
    }
  }
  if (n > 0) core_lu_.compute(a);
}

void IterativeInverse::precondition(Spectrum& r) const {
  const Index n = 2 * static_cast<Index>(core_.size());
  Eigen::VectorXd core(n);
  for (Index c = 0; c < n / 2; ++c) {
    const auto [i, k] = core_[static_cast<std::size_t>(c)];
    core(2 * c) = r(k, i).real();
    core(2 * c + 1) = r(k, i).imag();
  }
  r.array() *= D_inverse_.array();
  if (n == 0) return;
  core = core_lu_.solve(core).eval();
  for (Index c = 0; c < n / 2; ++c) {
    const auto [i, k] = core_[static_cast<std::size_t>(c)];
    r(k, i) = {core(2 * c), core(2 * c + 1)};
  }
}

void IterativeInverse::apply(const Spectrum& x, Spectrum& y) {
  A_.couple(x, A_.num_harmonics(), y);
  y.array() += A_.D().array() * x.array();
  precondition(y);
}

bool IterativeInverse::fixed_point(const Spectrum& b, double relative, Spectrum& z, Spectrum& change, double& size) {
  z = b;
  change = b;
  size = turn_norm(b);
  const double aim = relative * size;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    A_.couple(change, A_.num_harmonics(), scratch_);
    change = -scratch_.cwiseProduct(D_inverse_);
    const double now = turn_norm(change);
    const double contraction = now / size;
    size = now;
    // `change` is the preconditioned residual of z; adding it gives the next z.
    if (now <= aim) {
      z += change;
      return true;
    }
    if (!(contraction <= (iteration < 2 ? 2 : 1) * largest_contraction)) return false;
    z += change;
  }
  return false;
}

bool IterativeInverse::gmres(const Spectrum& b, double relative, Spectrum& z) {
  const Index H = A_.num_harmonics(), I = A_.num_modes(), n = 2 * (H + 1) * I;
  const int most = most_iterations;
  Spectrum start = b, w;
  precondition(start);
  z.setZero(H + 1, I);
  // In `v`, harmonics k > 0 carry sqrt(2): dot products are those over the turn.
  const auto to_vector = [&](const Spectrum& x) {
    Eigen::VectorXd v = real(x) * sqrt(2.0);
    for (Index i = 0; i < I; ++i) v.segment(2 * (H + 1) * i, 2) /= sqrt(2.0);
    return v;
  };
  const auto to_spectrum = [&](const Eigen::Ref<const Eigen::VectorXd>& v, Spectrum& x) {
    x.resize(H + 1, I);
    Eigen::Map<Eigen::VectorXd>(reinterpret_cast<double*>(x.data()), n) = v / sqrt(2.0);
    x.row(0) *= sqrt(2.0);
  };
  thread_local Workspace directions;
  Eigen::Map<Eigen::MatrixXd> V = directions.matrix(n, most + 1);
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(most + 1, most);
  Eigen::VectorXd cosines(most), sines(most), g = Eigen::VectorXd::Zero(most + 1);
  V.col(0) = to_vector(start);
  const double size = V.col(0).norm();
  if (!(size > 0) || !std::isfinite(size)) return size == 0;
  const double aim = relative * size;
  V.col(0) /= size;
  g(0) = size;
  int used = 0;
  bool reached = false;
  Spectrum x;
  for (int j = 0; j < most && !reached; ++j) {
    to_spectrum(V.col(j), x);
    apply(x, w);
    V.col(j + 1) = to_vector(w);
    for (int i = 0; i <= j; ++i) {
      R(i, j) = V.col(i).dot(V.col(j + 1));
      V.col(j + 1) -= R(i, j) * V.col(i);
    }
    const double rest = V.col(j + 1).norm();
    if (!std::isfinite(rest)) return false;
    for (int i = 0; i < j; ++i) {
      const double upper = cosines(i) * R(i, j) + sines(i) * R(i + 1, j);
      R(i + 1, j) = cosines(i) * R(i + 1, j) - sines(i) * R(i, j);
      R(i, j) = upper;
    }
    const double length = std::hypot(R(j, j), rest);
    if (!(length > 0)) break;
    cosines(j) = R(j, j) / length;
    sines(j) = rest / length;
    R(j, j) = length;
    g(j + 1) = -sines(j) * g(j);
    g(j) *= cosines(j);
    used = j + 1;
    reached = std::abs(g(j + 1)) <= aim;
    if (rest > 0)
      V.col(j + 1) /= rest;
    else
      break;
  }
  const Eigen::VectorXd y = R.topLeftCorner(used, used).triangularView<Eigen::Upper>().solve(g.head(used));
  const Eigen::VectorXd combination = V.leftCols(used) * y;
  to_spectrum(combination, z);
  return reached || (used > 0 && std::abs(g(used)) <= aim);
}

bool IterativeInverse::solve(const Spectrum& rhs, double relative, Spectrum& z) {
  const Index H = A_.num_harmonics();
  Spectrum r = rhs.topRows(H + 1);
  z.setZero(H + 1, A_.num_modes());
  const double load = A_.scaled_norm(r);
  if (!(load > 0)) return load == 0;
  if (try_fixed_point_) {
    Spectrum change;
    double size = 0;
    if (fixed_point(r.cwiseProduct(D_inverse_), relative, z, change, size)) return true;
    try_fixed_point_ = false;
    // What is left for GMRES: the residual of z is D * change. A diverging start is thrown away.
    if (size <= turn_norm(r.cwiseProduct(D_inverse_)) && z.allFinite() && change.allFinite())
      r = change.cwiseQuotient(D_inverse_);
    else
      z.setZero();
  }
  if (!core_known_) make_core();
  // GMRES sees preconditioned residuals only: where |D| nearly vanishes they say little about the residual itself.
  // Where they have fallen as asked and the residual has not, they are taken further once, unless little was asked or
  // rounding may be the reason.
  constexpr int most_restarts = 4;
  constexpr double further = 1e-2, near_rounding = 1e-11, rough = 1e-4;
  Spectrum correction;
  double last = HUGE_VAL, share = 0.3;
  bool taken_further = relative < near_rounding || relative > rough;
  for (int restart = 0; restart <= most_restarts; ++restart) {
    const double now = A_.scaled_norm(r);
    if (now <= relative * load) return true;
    if (restart == most_restarts || !std::isfinite(now)) return false;
    if (!(now < 0.5 * last)) {
      if (taken_further) return false;
      taken_further = true;
      share *= further;
    }
    last = now;
    gmres(r, share * relative * load / now, correction);
    if (!correction.allFinite()) return false;
    z += correction;
    A_.couple(z, H, r);
    r = rhs.topRows(H + 1) - A_.D().cwiseProduct(z) - r;
  }
  return false;
}

}  // namespace hb::steady
