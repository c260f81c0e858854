// Exact reduction of x'' + G x' + K(tau) x = 0 to a few modes S: the other modes F follow them,
//     x_F = A(tau) x_S + C(tau) x_S'     with periodic A, C,
// so that on an invariant subspace x_S'' + beta(tau) x_S' + alpha(tau) x_S = 0. Its 2m exponents are exponents of the
// whole system. Fast, stiff or overdamped modes cost nothing: they are never propagated.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// What slaving to some modes came to, for a neighbouring system to begin with.
struct SlavingStart {
  Eigen::VectorXd solution;  // A and C by harmonics, as slaving works on them; empty: zero
  double amplification = 1;  // of what a correction leaves, by repeated corrections
  double change = 0;  // of alpha, by the last correction
  bool diverges = false;  // so that there is no solution, nor is one expected nearby
  bool rough = false;  // too far off to be judged before it has had its corrections
  std::vector<Eigen::Index> modes = {};  // slaved to
};

struct ReducedSystem {
  bool converged = false;
  Eigen::Index num_modes = 0;  // m
  FourierSeries alpha, beta;  // m*m components, column-major
  // m x m, of max_tau |error| of each entry: what is left of truncation and iteration, estimated, and rounding.
  Eigen::MatrixXd alpha_error, beta_error;
  double iteration_share = 0;  // of these, what is left of the iteration
  // Upper bound on Re s of all the other 2(I - m) exponents (they belong to what is left when A, C are split off), by
  // the logarithmic norm in adiabatic coordinates averaged over the turn; infinite if no bound was found.
  double others_below = HUGE_VAL;
  // States (x, x') at tau = 0 of the invariant subspace, 2I x 2m: column l for x_S = e_l, column m + l for x_S' = e_l.
  Eigen::MatrixXd start;
  SlavingStart solved;
  int iterations = 0;
};

// The stiffness of one system over the turn, shared by its slavings.
class SampledStiffness {
 public:
  explicit SampledStiffness(const ScaledSystem& system) : system_(system) {}

  struct Samples {
    Eigen::MatrixXd K;  // N x I*I
    Eigen::VectorXd largest;  // max_tau |K_ij|, I*I
  };
  // At N equally spaced angles; the reference stays valid.
  const Samples& at(Eigen::Index num_samples);
  const ScaledSystem& system() const { return system_; }

 private:
  const ScaledSystem& system_;
  std::map<Eigen::Index, Samples> samples_;
};

// Keeps the modes listed in `slow` (indices of x). With all modes kept it returns K and G themselves. Not converged:
// the iteration diverges (a mode left out is in resonance with one that is kept) or is too slow. Iterates until alpha
// changes by less than `tolerance` relative to its largest value, or to rounding. `bounds_others`: others_below is
// looked for, and resonances that modulation shifts, (E29); else the caller has to see these, (E28). `start` decides
// how many corrections that takes; unless it is rough, a change of 1e-13, or four times what the neighbours came to, is
// then enough.
[[nodiscard]] ReducedSystem slave_to(SampledStiffness& stiffness, std::span<const Eigen::Index> slow, double tolerance,
                                     bool bounds_others, const SlavingStart& start = {});
[[nodiscard]] ReducedSystem slave_to(const ScaledSystem& system, std::span<const Eigen::Index> slow,
                                     double tolerance = 0);

// How strongly mode j pulls at the kept modes: largest |K_sj,k| |K_js,k|/|D_j(lambda_s + i k)|/|2 lambda_s + b_s| over
// kept modes s and harmonics k; the largest should be kept next.
[[nodiscard]] Eigen::VectorXd resonance_strength(const ScaledSystem& system, std::span<const Eigen::Index> slow);

}  // namespace hb
