// The invariance equations of slaving (hb/engine/README.md (E5)-(E7)) on samples of the turn, solved by iteration.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "hb/engine/exponents/slaving.hpp"
#include "hb/engine/exponents/slaving_pairs.hpp"
#include "lib/fourier/split_transform.hpp"

namespace hb::slaving {

// Of the bound on the rounding errors of K, that they do not all have at once (a choice).
constexpr double given_rounding = 0.5;

// Root of D(z) = z^2 + b z + w2 with the larger imaginary part, or the slower one of two real roots.
std::complex<double> root(double b, double w2);

// Kept modes and all others.
struct Partition {
  std::vector<Eigen::Index> S, F;
};
Partition partition(Eigen::Index I, std::span<const Eigen::Index> slow);

// The series of harmonics 0.. (rows) of m*m components without trailing ones that together matter less than the error
// of the others; what they are is added to it.
FourierSeries without_tail(const Eigen::Ref<const Eigen::MatrixXcd>& harmonics, Eigen::MatrixXd& error);

// One attempt with N samples of the turn; stiffness and partition have to stay. One per thread at a time, since its
// numbers are in memory that the thread keeps.
class Iteration {
 public:
  Iteration(SampledStiffness& stiffness, const Partition& p, Eigen::Index num_samples)
      : Iteration(stiffness.system(), stiffness.at(num_samples), p, num_samples) {}
  Iteration(const Iteration&) = delete;
  Iteration& operator=(const Iteration&) = delete;

  // Called first, this or start_from: starts from what fewer samples gave.
  void refine(const SlavingStart& coarse);

  // Starts from a neighbour's solution, if there is one, of no more harmonics than these samples show, and unless it is
  // rough changes no more than that has: those beyond them judge it.
  void start_from(const SlavingStart& start);

  // Whether the start solves the equations with these samples, more than it was found with: then nothing was
  // folded back or cut off that matters.
  bool solved_by_start(double tolerance);

  // Solves for A, C with these samples; false if it diverges, or would take too long. change_ is then what remains of
  // alpha's error but for that of too few samples.
  bool run(double tolerance, int& iterations, int most_iterations = 80);

  // Amplifies what is left where pairs with their modulation answer it with more than the constant part does, (E29).
  void see_shifted_resonances();

  ReducedSystem result(bool bounds_others);

  SlavingStart solved() const { return {x_.head(changed_), amplification_, change_}; }

 private:
  using Column = Eigen::Map<Eigen::VectorXd>;
  using Columns = Eigen::Map<Eigen::MatrixXd>;

  Iteration(const ScaledSystem& system, const SampledStiffness::Samples& samples, const Partition& p,
            Eigen::Index num_samples);

  // Samples of k_ij over the turn.
  auto K(Eigen::Index i, Eigen::Index j) const { return samples_.K.col(i + I_ * j).array(); }
  double largest_K(Eigen::Index i, Eigen::Index j) const { return samples_.largest(i + I_ * j); }
  // Means of K and G on the diagonal.
  double w2(Eigen::Index i) const { return given_.c(i + I_ * i, 0).real(); }
  double b(Eigen::Index i) const { return G_(i, i); }
  double weight_max() const { return weight_.maxCoeff(); }

  void weigh_residuals();
  // Bound on what is wrong with alpha, to first order, but for the amplification by repeated passes.
  double alpha_change() const { return effect_.cwiseProduct(residual_).sum(); }
  // The same in the end, harmonic by harmonic and with rounding as independent; hb/engine/README.md (E7). Harmonics of
  // alpha by rows.
  double carried_change(const Eigen::Ref<const Eigen::MatrixXcd>& alpha);
  double others_below() const;
  Eigen::MatrixXd start() const;

  // max over (j, l) of sum_k |a_k| + weight |c_k|, both signs of k, of x and of x - y.
  double length(const Column& x) const;
  double distance(const Column& x, const Column& y) const;
  template <class Part>
  double largest_pair(const Part& part) const;

  // Residual of the two invariance equations, pushed through the inverse of their constant part:
  //   x_S'' = -alpha x_S - beta x_S',     alpha = K_SS + K_SF A + G_SF P,   beta = G_SS + K_SF C + G_SF R
  //   x_F'  = P x_S + R x_S',             P = A' - C alpha,   R = A + C' - C beta
  //   0 = P' - R alpha + G_FF P + K_FS + K_FF A,   0 = P + R' - R beta + G_FS + G_FF R + K_FF C
  // x_ gives f_ and residual_.
  void correction();
  // A, C, C' over the turn; A' where damping couples: elsewhere the equations are linear in it.
  void sample();
  // The same where they are zero, and the residuals' harmonics.
  void sample_nothing();
  // alpha, beta, P and R over the turn; false if they are not found.
  bool reduce();
  void sample_slow();  // alpha, beta
  void sample_rates();  // P, R; without A' where damping is diagonal
  // The residuals over the turn, but for what is linear in P and R of the same mode: push_through adds that.
  void sample_residual();
  void push_through();
  // What each pair feels of itself with alpha and beta as they are now, and the inverse of that.
  PairInverse::Equations own_equations() const;
  PairInverse inverse_of(const PairInverse::Equations& own) const;
  // The residuals through that: step_, of the harmonics that are solved for.
  void push_through(const PairInverse& pairs);
  // By how much of itself modulation changes the resonant harmonic's part of the equations, to second order.
  double resonance_shift(const PairInverse::Equations& own) const;
  void invert_constant_part();

  const std::vector<Eigen::Index>& S_;
  const std::vector<Eigen::Index>& F_;
  Eigen::Index m_, n_, N_, H_;
  const Eigen::MatrixXd &G_, &rounding_, &G_error_;
  const FourierSeries& given_;  // K as it is given
  bool diagonal_damping_;
  Eigen::Index I_;
  const SampledStiffness::Samples& samples_;
  // Samples of K_ij at j + n i: i of all modes, the slow ones first, j of the fast ones.
  std::vector<const double*> K_F_;
  // Pairs q = j + n l of a fast mode j and a slow one l lie side by side in all that is told by harmonics.
  fourier::SplitTransform back_, forward_;  // columns A, C, C', A'; P, R and the rest of r1, r2, in the end r1, r2
  Columns A_, C_, C1_, A1_, P_, R_;  // N x n*m samples; C1 = C', A1 = A'
  Columns room_;  // of what follows
  Columns alpha_, beta_;  // N x m*m
  // Of each harmonic k: real parts of A_k, of weight C_k, then the imaginary parts.
  Column x_, f_, step_, last_x_, last_f_;  // 4 n*m (H+1)
  Eigen::Index changed_;  // so many of x_ are solved for
  // Inverse M of the constant part, per harmonic: M_11, M_12, weight M_21, weight M_22, of each the real parts, then
  // the imaginary ones.
  Columns inverse_;  // 8 n*m x (H+1)
  Columns inverse_size_;  // |M_1c| + weight |M_2c|, c = 1, then c = 2; 2 n*m x (H+1)
  // Of what follows, each 2 n*m: of A or the first invariance equation, then of C or the second.
  Eigen::MatrixXd columns_;
  Column weight_;  // of the slow mode
  Column scale_;  // 1 of A, 1/weight of C
  Column gain_, rate_;  // largest inverse_size_, and so of the rate of change
  Column residual_, effect_;  // sum_k |r_k|, and what each does to alpha
  Column damping_;  // G of the fast mode
  double kappa_ = 0, change_ = 0, amplification_ = 1;
  double enough_ = 0;  // of change_: what the start's own solution came to
};

}  // namespace hb::slaving
