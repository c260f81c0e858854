// The block Hill operator of x'' + G x' + K(tau) x = f(tau) on a window of harmonics 0..H,
//     (A x)_k = D(k) x_k + (E x)_k,    D_i(k) = -k^2 + i k G_ii + mean K_ii,    E = everything else,
// with E x by convolution or by FFT, which needs K at the nodes only. Components are weighted by powers of two so that
// the size of x_i is about the size of what it adds to q.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <vector>

#include "hb/engine/system/scaled_system.hpp"

namespace hb::steady {

// Half spectrum of I real functions: (H+1) x I, column i holds harmonics 0..H of component i.
using Spectrum = Eigen::MatrixXcd;

// Sum over all harmonics (both signs) of |x_k| per component; zero for no harmonics.
[[nodiscard]] Eigen::VectorXd wiener_norms(const Spectrum& x);

// Scaled system in weighted coordinates y = weight * x; shared by all windows.
struct WeightedSystem {
  Eigen::Index I = 0, P = 0;  // components; harmonics of K
  Eigen::VectorXd weight;  // powers of two
  Eigen::MatrixXcd K;  // I*I x (P+1)
  Modulation modulation;  // of K
  Eigen::MatrixXd G, G_off;  // damping; the same without its diagonal
  bool diagonal_damping = true;
  bool symmetric = false;  // K, exactly; not looked for where it has a modulation
  Eigen::VectorXd mean;  // w_i^2 = mean K_ii
  Spectrum f;  // (F+1) x I
  Eigen::MatrixXd K_rounding;  // sum over harmonics of |error| of K, entry by entry
  Eigen::VectorXd f_rounding;  // the same of f
  Eigen::VectorXd coupling;  // upper bound of sum_k max_tau |E_ik|, the largest part of row i
  Eigen::VectorXd within, across;  // sums over j != i of |mean K_ij| and of |G_ij|

  std::complex<double> D(Eigen::Index i, Eigen::Index k) const {
    const double n = static_cast<double>(k);
    return {mean(i) - n * n, n * G(i, i)};
  }
  // |D| without cancellation.
  double magnitude(Eigen::Index i, Eigen::Index k) const {
    const double n = static_cast<double>(k);
    const double size = std::abs(mean(i)) + n * n + n * std::abs(G(i, i));
    return size > 0 ? size : (coupling(i) > 0 ? coupling(i) : 1);
  }
  // B(k), what of A couples harmonic k to itself: D(k), K's mean off the diagonal, and i k G_off.
  [[nodiscard]] Eigen::MatrixXcd block(Eigen::Index k) const;
  // Upper bound of the largest sum over j != i of |B_ij/B_ii|.
  [[nodiscard]] double coupled_within(Eigen::Index k) const;
  // Size of |D_i(k)| away from resonance, smallest over k: for judging what is negligible.
  double smallest_diagonal(Eigen::Index i) const { return std::max(std::abs(mean(i)), 1.0); }
};

[[nodiscard]] WeightedSystem weighted(const ScaledSystem& system);

class Operator {
 public:
  Operator(const WeightedSystem& system, Eigen::Index num_harmonics);

  Eigen::Index num_modes() const { return system_->I; }
  Eigen::Index num_harmonics() const { return H_; }
  Eigen::Index last_row() const { return H_ + system_->P; }  // A x is zero beyond
  const WeightedSystem& system() const { return *system_; }
  const Spectrum& D() const { return D_; }  // (H+1) x I
  const Eigen::MatrixXd& magnitude() const { return magnitude_; }  // (H+1) x I, |D| without cancellation

  // E x, rows 0..num_rows (at most last_row()) of any x with rows up to last_row(); free of aliasing: by FFT or, of few
  // components and harmonics of K, by convolution.
  void couple(const Spectrum& x, Eigen::Index num_rows, Spectrum& result);
  // f - A x, rows 0..max(last_row(), harmonics of f).
  [[nodiscard]] Spectrum residual(const Spectrum& x);
  // 2-norm over the turn of the window's rows of r, divided by |D| without cancellation.
  [[nodiscard]] double scaled_norm(const Spectrum& r) const;
  // Bound on the rounding error of `residual(x)`, divided by |D| and summed over harmonics, per component: of the
  // data, of the products and of the transforms.
  [[nodiscard]] Eigen::VectorXd rounding(const Spectrum& x) const;
  // The part of it that is alike on all harmonics, per component: rows below this say nothing.
  [[nodiscard]] const Eigen::VectorXd& noise() const { return noise_; }
  int num_products() const { return num_products_; }

 private:
  // E at N nodes, `together` neighbours of every entry after each other: E_11, E_12, ... of those, then of the next.
  static constexpr Eigen::Index together = 8;
  using Neighbours = Eigen::Array<double, together, 1>;
  struct Nodes {
    Eigen::Index N = 0;
    std::vector<Neighbours> E;
  };
  const Nodes& nodes(Eigen::Index N);
  void by_modulation(Eigen::Index N, std::vector<Neighbours>& E) const;
  // `full`: with the noise.
  void couple(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result);
  void convolve(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result);
  void multiply(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result);

  const WeightedSystem* system_;
  Eigen::Index H_;
  Spectrum D_;
  Eigen::MatrixXd magnitude_;
  std::vector<Nodes> nodes_;  // of the window, of all rows, of all harmonics: one for each length
  std::vector<Neighbours> here_;  // of all components of x
  Eigen::VectorXd noise_;  // of the last exact residual
  int num_products_ = 0;
};

// Largest |x_i| at sample points (at least four per shortest wave): at most the maximum over the turn.
[[nodiscard]] double largest_over_turn(const Spectrum& x, Eigen::Index* component = nullptr);

// Approximate inverse of A on the window.
class Inverse {
 public:
  virtual ~Inverse() = default;
  // z with |rhs - A z| <= relative |rhs|, each divided by |D| without cancellation (2-norm over the turn); false if
  // that was not reached, with the best z found. Rows of rhs beyond H are ignored.
  virtual bool solve(const Spectrum& rhs, double relative, Spectrum& z) = 0;
};

}  // namespace hb::steady
