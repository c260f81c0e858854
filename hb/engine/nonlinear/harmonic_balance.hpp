// Alternating frequency/time harmonic balance: Fourier coefficients of r along a motion that is given by its own,
//     q = sum_k c_k e^{i k sigma},  c_-k = conj(c_k),     R_k = (1/N) sum_j r(sigma_j) e^{-i k sigma_j},   k = 0..H,
// sigma = tau/T = omega t over T turns, omega = Omega/T, by N samples of the time domain; with the exact derivative of
// these sums, the block Hill matrix (T. M. Cameron, J. H. Griffin, J. Appl. Mech. 56 (1989) 149,
// https://hal.science/hal-01333697).
#pragma once

#include <optional>

#include "hb/engine/nonlinear/nonlinear_system.hpp"
#include "lib/fourier/fourier.hpp"

namespace hb::nonlinear {

// Coefficients as n(2H+1) real unknowns: c_0, Re c_1, Im c_1, Re c_2, ...; residuals R_k alike.
[[nodiscard]] Eigen::VectorXd to_unknowns(const FourierSeries& q, Eigen::Index num_harmonics);
[[nodiscard]] FourierSeries to_series(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Index num_components);
// Per component the sum over all harmonics (both signs) of |c_k|: at least the maximum over the turn.
[[nodiscard]] Eigen::VectorXd sizes(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Index num_components);
[[nodiscard]] inline double size(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Index num_components) {
  return sizes(u, num_components).maxCoeff();
}
// sum over both signs of conj(a_k) b_k: the mean over the period of the product of two motions.
[[nodiscard]] double mean_product(const Eigen::Ref<const Eigen::VectorXd>& a,
                                  const Eigen::Ref<const Eigen::VectorXd>& b, Eigen::Index num_components);

// r along a motion to first order, per unit time: sum of mass q_tt, damping q_t and stiffness q changes.
struct Linearisation {
  ResidualSamples samples;  // at the N angles
  FourierSeries mass, damping, stiffness;  // n*n components, harmonics 0..N/2-1
};

class HarmonicBalance {
 public:
  // num_samples > 2 num_harmonics, even; for a jacobian() > 4 num_harmonics, so that products of two series on the
  // window do not fold back onto it.
  HarmonicBalance(const NonlinearSystem& system, int turns, Eigen::Index num_harmonics, Eigen::Index num_samples);

  Eigen::Index num_unknowns() const { return n_ * (2 * H_ + 1); }
  Eigen::Index num_components() const { return n_; }
  Eigen::Index num_harmonics() const { return H_; }
  Eigen::Index num_samples() const { return N_; }
  int turns() const { return turns_; }
  double base_frequency(double p) const { return system_->speed(p) / turns_; }  // omega

  // The motion at the samples.
  [[nodiscard]] MotionSamples motion(const Eigen::VectorXd& u, double p) const;
  // R; or why r does not exist.
  [[nodiscard]] std::optional<EvaluationFailure> residual(const Eigen::VectorXd& u, double p, Eigen::VectorXd& R);
  // R and the derivatives of r.
  [[nodiscard]] std::optional<EvaluationFailure> linearise(const Eigen::VectorXd& u, double p, Eigen::VectorXd& R,
                                                           Linearisation& linear);
  // dR/du: blocks A_kl = C_{k-l} + i l omega B_{k-l} - l^2 omega^2 M_{k-l} in real form.
  [[nodiscard]] Eigen::MatrixXd jacobian(const Linearisation& linear, double p) const;
  // dR/dp at fixed coefficients, omega moving with p: exact where the system gives dr/dp and the speed is a polynomial
  // of degree two, else by central differences over +-1e-4 p_scale.
  [[nodiscard]] std::optional<EvaluationFailure> parameter_derivative(const Eigen::VectorXd& u, double p,
                                                                      double p_scale, const Linearisation& linear,
                                                                      Eigen::VectorXd& Rp);
  // Diagonal block A_kk, n x n, of the means over the period.
  [[nodiscard]] Eigen::MatrixXcd mean_block(const Linearisation& linear, double p, Eigen::Index k) const;

  long evaluated_samples() const { return evaluated_; }

 private:
  [[nodiscard]] std::optional<EvaluationFailure> evaluate(const Eigen::VectorXd& u, double p, Derivatives wanted,
                                                          ResidualSamples& samples);
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::MatrixXd& r) const;  // of n x N samples, rows 0..H

  const NonlinearSystem* system_;
  int turns_;
  Eigen::Index n_, H_, N_;
  ResidualSamples samples_;
  long evaluated_ = 0;
};

// Fewest samples that H harmonics take, times `oversampling`.
[[nodiscard]] Eigen::Index samples_for(Eigen::Index num_harmonics, Eigen::Index oversampling = 1);

}  // namespace hb::nonlinear
