// Modes that feel little of each other, one line of theirs order by order: hb/engine/README.md (E22)-(E24). Everything
// at M equally spaced angles of the turn, M >= 16 of fast_length.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lib/fourier/fourier.hpp"
#include "lib/fourier/split_transform.hpp"

namespace hb::mode_lines {

// M x components, of a series cut to what M angles tell apart.
[[nodiscard]] Eigen::MatrixXd at_angles(const FourierSeries& series, Eigen::Index M);

// Modes i alone, x_i'' + b_i x_i' + (k_i - r_i) x_i = 0: x_i = psi_i^-1/2 e^{-b_i tau/2 +- i int psi_i}.
struct LoneModes {
  Eigen::VectorXd damping, mean_frequency;  // b, mean psi
  Eigen::MatrixXd frequency, rate;  // psi; Re x'/x = -b/2 - psi'/(2 psi); M x n
  Eigen::MatrixXd left_out;  // r
  Eigen::MatrixXd cosine, sine;  // of int (psi - mean psi)
  Eigen::MatrixXd weight;  // (2 psi)^-1/2

  Eigen::Index num_modes() const { return damping.size(); }
  Eigen::Index num_angles() const { return frequency.rows(); }
  LoneModes part(Eigen::Index first, Eigen::Index count) const;
};

// Of k, M x n, and b. Empty where a mode does not oscillate all over the turn.
[[nodiscard]] std::optional<LoneModes> lone_modes(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& damping);

// What modes feel beside what they do alone: g_i = sum_j a_ij (z_j + z_-j) + i b_ij (z_j - z_-j).
struct Coupling {
  Eigen::MatrixXd a, b;  // M x n*n

  // alpha and beta, M x n*n, without what the modes alone feel.
  Coupling(const LoneModes& modes, const Eigen::MatrixXd& alpha, const Eigen::MatrixXd& beta);
};

// The line of mode l, z_l = 1, order by order (E24). Lines 0..n-1 are those of the modes, n..2n-1 their conjugates.
class Line {
 public:
  // Both stay where they are.
  Line(const LoneModes& modes, const Coupling& coupling, Eigen::Index l);

  // Re s, with one order more each time.
  double next();
  // Largest |z_j| of the other lines.
  double mixed() const;
  // From here on with another coupling.
  void feel(const Coupling& coupling) { coupling_ = &coupling; }

 private:
  void turn_against();
  void invert();
  void couple();
  void answer();

  const LoneModes& modes_;
  const Coupling* coupling_;
  Eigen::Index l_, n_, M_;
  Eigen::MatrixXd cosine_, sine_;  // M x 2n
  Eigen::MatrixXd p_re_, p_im_, q_re_, q_im_;  // 2n x (M/2 + 1)
  Eigen::MatrixXd sum_, difference_, effect_;  // z_j + z_-j, z_j - z_-j, g: n real parts, n imaginary ones
  fourier::SplitTransform z_;  // real parts of the lines, then imaginary ones
};

}  // namespace hb::mode_lines
