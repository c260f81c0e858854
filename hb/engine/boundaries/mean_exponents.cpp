#include "hb/engine/boundaries/mean_exponents.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/frozen_frequencies.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/modulus.hpp"
#include "lib/parts.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// Ways that turn round more than once are not in the sums (chosen by experiment).
constexpr double margin = 3;
// Where the sum of all ways is asked for a way through a resonance counts much, not infinitely.
constexpr double least_detuning = 0.25;
constexpr std::size_t most_modes_frozen = 8;
// Per radian; growth below 1e-9 is not looked for.
constexpr double negligible_harmonic = 1e-12;
// Ways past an order and back are followed this far beyond it and beyond all harmonics.
constexpr int farthest_past = 16;

// Exponents mu of the mean with moduli of their right vectors (positions, columns of X) and left ones (what a force
// does to them, rows of Y), scaled alike: E_k = Y |K_k| X.
struct MeanModes {
  VectorXcd mu;
  MatrixXd X, Y;
};

// What a way of strength a brings to an exponent that it misses by the detuning: no more than that exponent itself, or
// the detuning 1/4 where a is stronger.
double on_the_way(double a, double detuning) { return a / std::max({detuning, std::min(least_detuning, a), 1e-300}); }

double largest_off_diagonal(const MatrixXd& A) {
  double largest = 0;
  for (Index i = 0; i < A.rows(); ++i)
    for (Index j = 0; j < A.cols(); ++j)
      if (i != j) largest = std::max(largest, std::abs(A(i, j)));
  return largest;
}

bool is_symmetric(const MatrixXd& A) {
  return (A - A.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * A.cwiseAbs().maxCoeff();
}

// Imaginary part ascending, then real part; one by one, since there are few.
void sort(MeanModes& modes) {
  const auto before = [&](Index a, Index b) {
    const cplx p = modes.mu(a), q = modes.mu(b);
    return p.imag() != q.imag() ? p.imag() < q.imag() : p.real() < q.real();
  };
  for (Index sorted = 1; sorted < modes.mu.size(); ++sorted)
    for (Index n = sorted; n > 0 && before(n, n - 1); --n) {
      std::swap(modes.mu(n), modes.mu(n - 1));
      modes.X.col(n).swap(modes.X.col(n - 1));
      modes.Y.row(n).swap(modes.Y.row(n - 1));
    }
}

// Real modes q of the mean stiffness, their own damping: s^2 + b s + w^2 = 0 each.
MeanModes by_modes(const MatrixXd& Q, const VectorXd& w2, const VectorXd& b) {
  const Index I = w2.size();
  MeanModes modes{VectorXcd(2 * I), MatrixXd(I, 2 * I), MatrixXd(2 * I, I)};
  for (Index i = 0; i < I; ++i) {
    const cplx root = std::sqrt(cplx(b(i) * b(i) / 4 - w2(i), 0));
    const double size = 1 / std::sqrt(std::max(2 * std::abs(root), 1e-3));
    for (const Index side : {0, 1}) {
      modes.mu(2 * i + side) = -b(i) / 2 + (side == 0 ? root : -root);
      modes.X.col(2 * i + side) = size * Q.col(i).cwiseAbs();
      modes.Y.row(2 * i + side) = size * Q.col(i).cwiseAbs().transpose();
    }
  }
  return modes;
}

// Any stiffness and damping: vectors of [0 1; -K_0 -G].
MeanModes by_companion(const MatrixXd& K0, const MatrixXd& G) {
  const Index I = G.rows();
  MatrixXd A = MatrixXd::Zero(2 * I, 2 * I);
  A.topRightCorner(I, I).setIdentity();
  A.bottomLeftCorner(I, I) = -K0;
  A.bottomRightCorner(I, I) = -G;
  const std::optional<dense::Eigenpairs> spectrum = dense::eigenpairs(A);
  if (!spectrum)
    return {VectorXcd::Constant(2 * I, nan), MatrixXd::Constant(I, 2 * I, nan), MatrixXd::Constant(2 * I, I, nan)};
  const MatrixXcd& V = spectrum->vectors;
  MeanModes modes{spectrum->values, V.topRows(I).cwiseAbs(), MatrixXcd(dense::inverse(V).rightCols(I)).cwiseAbs()};
  for (Index n = 0; n < 2 * I; ++n) {
    const double ratio = std::sqrt(modes.Y.row(n).norm() / modes.X.col(n).norm());
    modes.X.col(n) *= ratio;
    modes.Y.row(n) /= ratio;
  }
  return modes;
}

MeanModes mean_modes(const ScaledSystem& system) {
  const Index I = system.num_modes();
  const MatrixXd K0 = system.mean_stiffness(), &G = system.G;
  MeanModes modes;
  if (largest_off_diagonal(K0) == 0 && system.diagonal_damping) {
    modes = by_modes(MatrixXd::Identity(I, I), K0.diagonal(), G.diagonal());
  } else if (is_symmetric(K0) && is_symmetric(G)) {
    const dense::SymmetricEigenpairs spectrum = dense::symmetric_eigenpairs(K0);
    const MatrixXd& Q = spectrum.vectors;
    modes = by_modes(Q, spectrum.values, (Q.transpose() * G * Q).diagonal());
  } else {
    modes = by_companion(K0, G);
  }
  sort(modes);
  return modes;
}

MatrixXd harmonic(const ScaledSystem& system, const MeanModes& modes, Index k) {
  const Index I = system.num_modes();
  const Eigen::Map<const MatrixXcd> K(system.K.c.col(k).data(), I, I);
  return modes.Y * K.cwiseAbs() * modes.X;
}

bool symmetric_stiffness(const ScaledSystem& system) {
  const Index I = system.num_modes();
  double largest = 0, apart = 0;  // squares of moduli
  for (Index k = 0; k <= system.K.num_harmonics(); ++k) {
    const Eigen::Map<const MatrixXcd> K(system.K.c.col(k).data(), I, I);
    largest = std::max(largest, K.cwiseAbs2().maxCoeff());
    for (Index j = 0; j < I; ++j)
      for (Index i = 0; i < j; ++i) apart = std::max(apart, std::norm(K(i, j) - K(j, i)));
  }
  return apart <= 1e-24 * largest;
}

bool passive_damping(const ScaledSystem& system) {
  return system.diagonal_damping ||
         (is_symmetric(system.G) && dense::symmetric_eigenpairs(system.G).values.minCoeff() >= 0);
}

// Of a system with symmetric stiffness.
void add_frozen(std::vector<MeanExponent>& mean, const ScaledSystem& system) {
  const auto I = static_cast<std::size_t>(system.num_modes());
  // Mean exponents name those that modulation shifts less.
  constexpr double named_by_means = 0.5;
  if (I < 2 || I > most_modes_frozen ||
      std::ranges::none_of(mean, [](const MeanExponent& m) { return shift_by_modulation(m) > named_by_means; }) ||
      !passive_damping(system))
    return;
  VectorXd b(system.num_modes());
  for (std::size_t i = 0; i < I; ++i) {
    const cplx mu = mean[I + i].value;
    if (!(mu.imag() > 0)) return;
    b(static_cast<Index>(i)) = -2 * mu.real();
  }
  const VectorXd w = frozen_frequencies(system.K, b);
  for (std::size_t i = 0; i < I && w.size() > 0; ++i) {
    mean[I + i].frozen = w(static_cast<Index>(i));
    mean[I - 1 - i].frozen = -w(static_cast<Index>(i));
  }
}

// Of one mode both vectors are 1 in size and all C_ij one number c: C (1 - C/delta)^-1 = C/(1 - 2 c/delta).
std::vector<MeanExponent> of_one_mode(const ScaledSystem& system) {
  const double b = system.G(0, 0), w2 = system.K.c(0, 0).real();
  const cplx root = std::sqrt(cplx(b * b / 4 - w2, 0));
  std::vector<MeanExponent> result(2);
  result[0].value = -b / 2 - root;
  result[1].value = -b / 2 + root;
  double sizes = 0;
  for (Index k = 1; k <= system.K.num_harmonics(); ++k) sizes += modulus(system.K.c(0, k));
  const double c = sizes / std::max(2 * std::abs(root), 1e-3), left = 1 - 2 * c / least_detuning;
  for (MeanExponent& mean : result) {
    mean.modulation = c;
    mean.coupling = margin * (left > 0 ? c / left : HUGE_VAL);
  }
  return result;
}

}  // namespace

bool are_conjugate(cplx a, cplx b) { return a.imag() != 0 && std::abs(a - std::conj(b)) <= 1e-9 * std::abs(a); }

double shift_by_modulation(const MeanExponent& mean) {
  constexpr double detuning = 0.25;  // (coupling/margin)^2/detuning
  return mean.coupling * mean.coupling / (margin * margin * detuning);
}

double frequency(const MeanExponent& mean) { return mean.frozen != 0 ? mean.frozen : mean.value.imag(); }

double most_shift(const MeanExponent& mean) {
  return mean.frozen != 0 ? 0 : std::min(shift_by_modulation(mean), mean.modulation);
}

double moved(const MeanExponent& p, const MeanExponent& q) {
  if (p.frozen != 0 && q.frozen != 0) return std::abs(q.frozen - p.frozen);
  const MeanExponent &weak = p.modulation < q.modulation ? p : q, &strong = p.modulation < q.modulation ? q : p;
  const double mean = std::abs((q.value - p.value).imag());
  if (weak.modulation == strong.modulation) return mean;
  const double shift = std::max({0.5, most_shift(p), most_shift(q)}), ratio = strong.modulation / weak.modulation;
  return mean + shift * std::min(1.0, ratio * ratio - 1);
}

std::vector<MeanExponent> mean_exponents(const ScaledSystem& system) {
  if (system.num_modes() == 1) return of_one_mode(system);
  const MeanModes modes = mean_modes(system);
  const Index n = modes.mu.size(), H = system.K.num_harmonics();
  std::vector<MeanExponent> result(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) result[static_cast<std::size_t>(i)].value = modes.mu(i);
  if (H == 0) return result;
  const MatrixXd sizes = sums_of_moduli(system.K.c, 1, H).reshaped(system.num_modes(), system.num_modes());
  // All ways of all orders: C + C C/delta + ... = C (1 - C/delta)^-1, which is positive where the sum converges.
  const MatrixXd C = modes.Y * sizes * modes.X;
  const MatrixXd ways = dense::inverse(MatrixXd(MatrixXd::Identity(n, n) - C / least_detuning));
  const bool converges = ways.allFinite() && ways.minCoeff() >= 0;
  const MatrixXd all = converges ? MatrixXd(C * ways) : MatrixXd::Constant(n, n, HUGE_VAL);
  const bool symmetric = symmetric_stiffness(system);
  for (Index i = 0; i < n; ++i) {
    MeanExponent& mean = result[static_cast<std::size_t>(i)];
    mean.modulation = C.row(i).maxCoeff();
    for (Index j = 0; j < n; ++j) {
      if (j == i) continue;
      const double pulled = margin * std::sqrt(all(i, j) * all(j, i));
      mean.coupling = std::max(mean.coupling, pulled);
      if (!symmetric && !are_conjugate(modes.mu(i), modes.mu(j))) mean.drift = std::max(mean.drift, pulled);
    }
  }
  if (symmetric) add_frozen(result, system);
  return result;
}

ParametricCoupling::ParametricCoupling(const ScaledSystem& system, int max_order)
    : symmetric_(symmetric_stiffness(system) && passive_damping(system)), max_order_(max_order) {
  const MeanModes modes = mean_modes(system);
  mu_ = modes.mu;
  std::vector<MatrixXd> E;
  for (Index k = 1; k <= system.K.num_harmonics(); ++k) E.push_back(harmonic(system, modes, k));
  while (!E.empty() && E.back().maxCoeff() < negligible_harmonic) E.pop_back();
  harmonics_ = static_cast<int>(E.size());
  beside_.resize(mu_.size(), mu_.size() * harmonics_);
  for (int k = 0; k < harmonics_; ++k) beside_.middleCols(k * mu_.size(), mu_.size()) = E[static_cast<std::size_t>(k)];
  for (Index n = 0; n < mu_.size(); ++n) {
    std::size_t nearest = 0;
    for (Index r = 0; r < mu_.size(); ++r)
      if (std::abs(mu_(r) - std::conj(mu_(n))) < std::abs(mu_(static_cast<Index>(nearest)) - std::conj(mu_(n))))
        nearest = static_cast<std::size_t>(r);
    conjugate_.push_back(nearest);
  }
  from_.resize(static_cast<std::size_t>(mu_.size()));
  back_.resize(from_.size());
  // exp(sum_m z_m y^m) = sum_j c_j y^j by c_j = sum_m m z_m c_(j-m)/j, down to where c_j is negligible.
  constexpr double negligible = 1e-10, most = 1e100;
  std::vector<double> slope;  // m z_m, z_m = 2 E_m,nn/m
  for (const MatrixXd& E_k : E) slope.push_back(2 * E_k.diagonal().maxCoeff());
  std::vector<double> past = {1};
  turning_ = 1;
  for (std::size_t j = 1; j < static_cast<std::size_t>(max_order_); ++j) {
    double sum = 0;
    for (std::size_t m = 1; m <= std::min(j, slope.size()); ++m) sum += slope[m - 1] * past[j - m];
    past.push_back(std::min(sum / static_cast<double>(j), most));
    turning_ += past.back();
  }
  while (past.back() < negligible && past.size() > 1) past.pop_back();
  past_ = Eigen::Map<const VectorXd>(past.data(), static_cast<Index>(past.size()));
}

const MatrixXd& ParametricCoupling::from(std::size_t n, int k) const {
  MatrixXd& a = from_[n];
  const Index count = mu_.size(), H = harmonics_, known = a.rows();
  if (k <= known) return a;
  const Index wanted = std::min<Index>(std::max<Index>(k, 2 * known), max_order_);
  a.conservativeResize(wanted, count);
  MatrixXd relative(count, wanted);  // a_m(l)/|mu_n + im - mu_l| in column wanted - m, so that sums run on in memory
  const cplx start = mu_(static_cast<Index>(n));
  const VectorXd away = (start - mu_.array()).real().square(), turns = (start - mu_.array()).imag();
  for (Index m = 1; m <= wanted; ++m) {
    if (m > known) {
      VectorXd sum =
          m <= H ? VectorXd(beside_.col((m - 1) * count + static_cast<Index>(n))) : VectorXd(VectorXd::Zero(count));
      const Index terms = count * std::min(H, m - 1);
      const Eigen::Map<const VectorXd> before(relative.data() + count * (wanted - m + 1), terms);
      sum.noalias() += beside_.leftCols(terms) * before;
      a.row(m - 1) = sum.transpose();
    }
    for (Index l = 0; l < count; ++l) {
      const double turned = turns(l) + static_cast<double>(m);
      relative(l, wanted - m) = on_the_way(a(m - 1, l), std::sqrt(away(l) + turned * turned));
    }
  }
  return a;
}

const MatrixXd& ParametricCoupling::back_to(std::size_t r) const {
  MatrixXd& b = back_[r];
  if (b.size() > 0) return b;
  const int farthest = std::min(max_order_, harmonics_ + farthest_past);
  b = MatrixXd::Zero(farthest, mu_.size());
  for (std::size_t l = 0; l < back_.size(); ++l) {
    if (l == r) continue;
    const cplx apart = mu_(static_cast<Index>(r)) - mu_(static_cast<Index>(l));
    const auto way = from(conjugate_[l], farthest).col(static_cast<Index>(conjugate_[r]));
    for (Index j = 1; j <= farthest; ++j)
      b(j - 1, static_cast<Index>(l)) = on_the_way(way(j - 1), std::abs(apart + cplx(0, static_cast<double>(j))));
  }
  return b;
}

// sum_j [c_j a_(k+j)(r) + sum_l (a_(k+j)(l) b_j(l, r) + b_j(n, l) a_(k+j)(l, r))], b_j(l, l) = 0.
double ParametricCoupling::ways(std::size_t n, std::size_t r, int k) const {
  const int H = harmonics_, farthest = std::min(max_order_, std::max(k, H) + farthest_past);
  const Index past = std::min<Index>(max_order_ - k + 1, past_.size()), most = farthest - k;
  const auto to_n = static_cast<Index>(n), to_r = static_cast<Index>(r);
  double sum = from(n, k + static_cast<int>(past) - 1).col(to_r).segment(k - 1, past).dot(past_.head(past));
  // back_to may lengthen what from gives a reference to: it comes first.
  const MatrixXd& back = back_to(r);
  sum += from(n, farthest).middleRows(k, most).cwiseProduct(back.topRows(most)).sum();
  for (std::size_t l = 0; l < from_.size(); ++l) {
    const auto first = back_to(l).col(to_n).head(most);
    sum += from(l, farthest).col(to_r).segment(k, most).dot(first);
  }
  return sum;
}

double ParametricCoupling::operator()(std::size_t n, std::size_t r, int k) const {
  const auto p = static_cast<Index>(n), q = static_cast<Index>(r);
  return symmetric_ && mu_(p).imag() * mu_(q).imag() > 0 ? 0 : either_way(n, r, k);
}

double ParametricCoupling::either_way(std::size_t n, std::size_t r, int k) const {
  if (harmonics_ == 0 || k > max_order_) return 0;
  const auto [known, is_new] = strength_.try_emplace({n, r, k}, 0);
  if (is_new)
    known->second = margin * turning_ * std::sqrt(ways(n, r, k)) * std::sqrt(ways(conjugate_[r], conjugate_[n], k));
  return known->second;
}

}  // namespace hb
