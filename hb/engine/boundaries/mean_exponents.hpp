// Where the exponents would be if the stiffness were its mean over the turn, and what its harmonics can do to them:
//     z' = (diag(mu) + sum_k E_k e^{ik tau}) z,     mu the 2I exponents of x'' + G x' + K_0 x = 0.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <tuple>
#include <vector>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

struct MeanExponent {
  std::complex<double> value;  // mu, per radian of crank angle; its imaginary part is not folded
  // Upper estimate of the growth that any resonance with another one can reach, whatever its order; per radian.
  double coupling = 0;
  double modulation = 0;  // the largest sum_k E_k,nr, of all r
  // Upper estimate of how far modulation moves the real part of the exponent off Re mu otherwise than by sharing
  // damping or locking, per radian: as `coupling`, without its conjugate; 0 where the stiffness is symmetric at all
  // angles. hb/engine/README.md (B15).
  double drift = 0;
  // Im mu with the stiffness of each angle in turn, to second order, hb/engine/README.md (B13): nearer to what slow
  // modulation makes of the exponent, however strong it is. Computed where modulation may shift one by half a turn; 0:
  // not known, or modulation is not slow.
  double frozen = 0;
};

// Of one mode that oscillates.
[[nodiscard]] bool are_conjugate(std::complex<double> a, std::complex<double> b);

// What modulation may shift an exponent by, of second order: hb/engine/README.md (B4).
[[nodiscard]] double shift_by_modulation(const MeanExponent& mean);

// The frequency that a mean exponent stands for, and how far from it modulation may shift the exponent.
[[nodiscard]] double frequency(const MeanExponent& mean);
[[nodiscard]] double most_shift(const MeanExponent& mean);

// How far an exponent moves along the imaginary axis between two places where its mean one is p and q, with what
// modulation may shift it, at most half a turn or (B4) where that is more: hb/engine/README.md (B10).
[[nodiscard]] double moved(const MeanExponent& p, const MeanExponent& q);

// 2I of them, imaginary part ascending, then real part: each is continuous along a parameter.
[[nodiscard]] std::vector<MeanExponent> mean_exponents(const ScaledSystem& system);

// How strongly the resonance of order k >= 1 between two mean exponents n and r, Im mu_r - Im mu_n near k, pulls the
// two apart, per radian: the growth that it would reach without damping. An estimate from above: with moduli
// throughout,
//     a_k(r) = E_k,rn + sum_{0<m<k} sum_l E_k-m,rl a_m(l)/|mu_n + im - mu_l|
// sums all ways of harmonics that add up to k; those that turn round once are added, hb/engine/README.md (B4). Forth
// and back give the root of the product, with a margin for ways that turn round more often. Where stiffness and damping
// are symmetric two exponents on the same side of the real axis do not excite each other: zero. They share their
// damping all the same, as `either_way` tells: one that grows may be quenched.
class ParametricCoupling {
 public:
  ParametricCoupling(const ScaledSystem& system, int max_order);
  double operator()(std::size_t n, std::size_t r, int k) const;
  double either_way(std::size_t n, std::size_t r, int k) const;
  // Exponents that meet in the mean (k = 0) are harmless.
  bool symmetric() const { return symmetric_; }

 private:
  const Eigen::MatrixXd& from(std::size_t n, int k) const;
  const Eigen::MatrixXd& back_to(std::size_t r) const;
  double ways(std::size_t n, std::size_t r, int k) const;

  Eigen::VectorXcd mu_;
  std::vector<std::size_t> conjugate_;
  Eigen::MatrixXd beside_;  // E_k, k = 1, 2, .. harmonics_, one beside the other
  int harmonics_ = 0;
  // What an exponent's own phase modulation does, y a harmonic: exp(sum_k (2 E_k,nn/k) y^k) = sum_j past_[j] y^j takes
  // a way past the order by j and back; turning_, the sum of all.
  Eigen::VectorXd past_;
  double turning_ = 1;
  bool symmetric_ = false;
  int max_order_;
  mutable std::vector<Eigen::MatrixXd> from_;  // a_k(r) in (k - 1, r), as far as it was asked for
  mutable std::vector<Eigen::MatrixXd> back_;  // b_j(l, r) in (j - 1, l)
  mutable std::map<std::tuple<std::size_t, std::size_t, int>, double> strength_;
};

}  // namespace hb
