#include "hb/engine/exponents/hill_exponents.hpp"

#include <cmath>
#include <optional>

#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr Index most_window_unknowns = 600;

struct Found {
  cplx s;
  double error;
};

// Harmonics -N..N; unknowns of one harmonic stand together.
class Window {
 public:
  Window(const ScaledSystem& system, Index N) : system_(system), I_(system.num_modes()), N_(N) {
    const Index P = system.K.num_harmonics(), n = size();
    K_ = MatrixXcd::Zero(n + 2 * P * I_, n);  // rows -N-P..N+P: what leaves the window too
    for (Index l = -N; l <= N; ++l)
      for (Index m = -P; m <= P; ++m) {
        const MatrixXcd coefficient = system.K.c.col(std::abs(m)).reshaped(I_, I_);
        K_.block((l + m + N + P) * I_, (l + N) * I_, I_, I_) =
            m >= 0 ? coefficient : MatrixXcd(coefficient.conjugate());
      }
  }
  Index size() const { return I_ * (2 * N_ + 1); }

  std::optional<Found> newton(cplx s, Index mode) const {
    const Index n = size(), P = system_.K.num_harmonics();
    const cplx start = s;
    VectorXcd x = VectorXcd::Zero(n);
    x(N_ * I_ + mode) = 1;
    dense::Lu<cplx> lu;
    double change = HUGE_VAL;
    for (int iteration = 0; iteration < 30; ++iteration) {
      end_if_wished();
      lu.compute(matrix(s));
      const VectorXcd y = lu.solve(derivative(s, x));
      if (!y.allFinite()) {  // s hit the exponent to the last bit
        s += cplx(1, 1) * 1e-14 * (1.0 + std::abs(s));
        continue;
      }
      const cplx step = x.squaredNorm() / x.dot(y);
      const double size = std::abs(step);
      x = y.normalized();
      if (!std::isfinite(size)) return std::nullopt;
      s -= step;
      // No further than to the next mode's window.
      if (std::abs(s - start) > 0.6 * double(N_) + 10) return std::nullopt;
      if (size <= 4 * eps * (1 + std::abs(s)) || (size >= change && size <= 1e-9 * (1 + std::abs(s)))) break;
      change = size;
      if (iteration == 29) return std::nullopt;
    }
    // Left null vector by inverse iteration with the last factors.
    VectorXcd z = lu.solve_adjoint(x);
    if (!z.allFinite()) return std::nullopt;
    z = lu.solve_adjoint(z.normalized());
    if (!z.allFinite()) return std::nullopt;
    z.normalize();

    // Residual of all rows, and what rounding hides of it.
    const VectorXcd all = K_ * x, Lx = all.segment(P * I_, n) + diagonal(s, x);
    const VectorXd rounding =
        double(8 + 2 * P) * eps * (K_.middleRows(P * I_, n).cwiseAbs() * x.cwiseAbs() + diagonal_size(s, x.cwiseAbs()));
    double effect = std::abs(z.dot(Lx)) + z.cwiseAbs().dot(rounding);
    // Rows outside: r there acts through -(z K) (D + K)^-1, |(D + K)^-1 r| <= max |r/D|/(1 - |D^-1 K|).
    double back = 0, through = 0;  // sum of |z K| over the outer unknowns, max |r/D|
    for (Index k = -N_ - P; k <= N_ + P; ++k) {
      if (std::abs(k) <= N_) continue;
      for (Index i = 0; i < I_; ++i) {
        // K_(k-l) = conj(K_(l-k)) for real K(tau).
        for (Index l = std::max(-N_, k - P); l <= std::min(N_, k + P); ++l)
          for (Index j = 0; j < I_; ++j)
            back += std::abs(z((l + N_) * I_ + j)) * std::abs(system_.K.c(j + I_ * i, std::abs(k - l)));
        through = std::max(through, std::abs(all((k + N_ + P) * I_ + i)) / own(s, k, i));
      }
    }
    if (through > 0) effect += back * through / (1 - std::min(outer_coupling(s), 1.0));
    const double slope = std::abs(z.dot(derivative(s, x)));
    const double error = 4 * std::max(effect / slope, distance(s, x));
    if (std::isnan(error)) return std::nullopt;
    return Found{s, error};
  }

 private:
  cplx at(cplx s, Index k) const { return s + cplx(0, double(k)); }
  // |x|/|L^-1 L' x|, (E19); zero where L is singular.
  double distance(cplx s, const VectorXcd& x) const {
    const VectorXcd y = dense::Lu<cplx>(matrix(s)).solve(derivative(s, x));
    return y.allFinite() ? x.norm() / y.norm() : 0;
  }
  // |D| of one unknown.
  double own(cplx s, Index k, Index i) const {
    return std::abs(at(s, k) * at(s, k) + at(s, k) * system_.G(i, i) + system_.K.c(i + I_ * i, 0));
  }
  // Largest row of |D^-1 (K + (s + ik) G - D)| over as many harmonics outside the window as are inside: what lies
  // farther acts through a power of it.
  double outer_coupling(cplx s) const {
    double largest = 0;
    for (Index i = 0; i < I_; ++i) {
      double stiffness = -std::abs(system_.K.c(i + I_ * i, 0));
      for (Index j = 0; j < I_; ++j) stiffness += fourier::wiener_norm(system_.K, i + I_ * j);
      const double damping = system_.G.row(i).cwiseAbs().sum() - std::abs(system_.G(i, i));
      for (Index k = -2 * N_; k <= 2 * N_; ++k)
        if (std::abs(k) > N_) largest = std::max(largest, (stiffness + damping * std::abs(at(s, k))) / own(s, k, i));
    }
    return largest;
  }
  VectorXcd diagonal(cplx s, const VectorXcd& x) const {
    VectorXcd result(x.size());
    for (Index k = -N_; k <= N_; ++k) {
      const auto part = x.segment((k + N_) * I_, I_);
      result.segment((k + N_) * I_, I_) = at(s, k) * at(s, k) * part + at(s, k) * (system_.G.cast<cplx>() * part);
    }
    return result;
  }
  VectorXd diagonal_size(cplx s, const VectorXd& x) const {
    VectorXd result(x.size());
    for (Index k = -N_; k <= N_; ++k) {
      const double size = std::abs(s) + std::abs(double(k));
      const auto part = x.segment((k + N_) * I_, I_);
      result.segment((k + N_) * I_, I_) = size * size * part + size * (system_.G.cwiseAbs() * part);
    }
    return result;
  }
  VectorXcd derivative(cplx s, const VectorXcd& x) const {  // L'(s) x
    VectorXcd result(x.size());
    for (Index k = -N_; k <= N_; ++k) {
      const auto part = x.segment((k + N_) * I_, I_);
      result.segment((k + N_) * I_, I_) = 2.0 * at(s, k) * part + system_.G.cast<cplx>() * part;
    }
    return result;
  }
  MatrixXcd matrix(cplx s) const {
    const Index P = system_.K.num_harmonics();
    MatrixXcd L = K_.middleRows(P * I_, size());
    for (Index k = -N_; k <= N_; ++k) {
      auto block = L.block((k + N_) * I_, (k + N_) * I_, I_, I_);
      block += at(s, k) * system_.G.cast<cplx>();
      block.diagonal().array() += at(s, k) * at(s, k);
    }
    return L;
  }

  const ScaledSystem& system_;
  Index I_, N_;
  MatrixXcd K_;
};

}  // namespace

HillExponents hill_exponents(const ScaledSystem& system) {
  const Index I = system.num_modes(), P = system.K.num_harmonics();
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  // The better of two windows in a row, as long as the next one improves it.
  const auto exponent = [&](cplx from, Index mode) {
    std::optional<Found> best;
    for (Index N = std::max<Index>(8, P); I * (2 * N + 1) <= most_window_unknowns; N *= 2) {
      const std::optional<Found> found = Window(system, N).newton(best ? best->s : from, mode);
      if (!found || (best && std::isfinite(best->error) && !(found->error < 0.5 * best->error))) break;
      best = found;
      if (best->error <= 1e-13 * (1 + std::abs(best->s))) break;
    }
    return best && std::isfinite(best->error) ? best : std::nullopt;
  };
  HillExponents result;
  const auto add = [&](const Found& found, Index mode) {
    result.s.push_back(found.s);
    result.error.push_back(found.error);
    result.mode.push_back(mode);
  };
  for (Index i = 0; i < I; ++i) {
    const cplx root = std::sqrt(cplx(b(i) * b(i) / 4 - w2(i), 0));
    // Off the line Re s = -b/2: inside a tongue Newton's method would stay on it, between two exponents.
    const std::optional<Found> first = exponent(-b(i) / 2 + root + 0.03, i);
    if (!first) continue;
    add(*first, i);
    // Its partner: the conjugate, unless s and conj s differ by a whole number of turns; then the other real one.
    const double twice = 2 * first->s.imag();
    if (std::abs(twice - std::round(twice)) > 1e-6 + 2 * first->error) {
      add({std::conj(first->s), first->error}, i);
      continue;
    }
    const std::optional<Found> second = exponent(-b(i) - std::conj(first->s), i);
    if (second && std::abs(second->s - first->s) > second->error + first->error) add(*second, i);
  }
  return result;
}

}  // namespace hb
