#include "hb/engine/time/integration_cost.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "lib/constants.hpp"

namespace hb {

namespace {}

FrozenSpectrum frozen_spectrum(ScaledMotion& motion) {
  constexpr int num_looks = 16;
  FrozenSpectrum spectrum;
  double mean = 0;
  for (int j = 0; j < num_looks; ++j) {
    spectrum.eigenvalues.push_back(motion.frozen_eigenvalues(two_pi * j / num_looks));
    const Eigen::VectorXcd& lambda = spectrum.eigenvalues.back();
    mean += lambda.real().maxCoeff() / num_looks;
    spectrum.fastest = std::max(spectrum.fastest, lambda.cwiseAbs().maxCoeff());
  }
  spectrum.slowest = std::abs(mean);
  return spectrum;
}

// A mode lambda costs steps while it is larger than the tolerance, log(1/tol)/|Re lambda| after every start. Steps per
// radian of its phase: an order-p method holds (omega h)^(p+1) at the tolerance. The factors and the steps per start
// were measured on the six-link mechanism and Mathieu's equation; they are right to about a factor 2.
double predicted_steps(const FrozenSpectrum& spectrum, Integrator method, double tolerance, int num_segments) {
  const bool adams = method == Integrator::adams;
  const double per_radian = adams ? 0.6 * std::pow(tolerance, -1.0 / 11) : 0.8 * std::pow(tolerance, -1.0 / 6);
  const double per_start = adams ? 60 : 100 * std::pow(tolerance, -1.0 / 18);
  double oscillation = 0;
  for (const Eigen::VectorXcd& eigenvalues : spectrum.eigenvalues)
    for (const std::complex<double>& lambda : eigenvalues) {
      const double decay = std::max(-lambda.real(), 1e-300);
      const double alive = std::min(two_pi, num_segments * std::log(1 / tolerance) / decay);
      oscillation = std::max(oscillation, std::max(1.0, std::abs(lambda)) * alive);
    }
  const double steps = num_segments * per_start + per_radian * oscillation;
  // Adams is stable only up to h |lambda| of some tenths, whether the mode is alive or not.
  return adams ? std::max(steps, two_pi * spectrum.fastest / 0.3) : steps;
}

// Modes that die within a radian or so of their own phase need no resolving by an L-stable method; the others get 2
// rad of phase per cell of order 17, and the coefficients at least 32 cells per turn.
int collocation_cells(const FrozenSpectrum& spectrum, int num_outputs) {
  double rate = 32 / two_pi;
  const double slow = spectrum.slowest;
  for (const Eigen::VectorXcd& eigenvalues : spectrum.eigenvalues)
    for (const std::complex<double>& lambda : eigenvalues)
      if (-lambda.real() <= 4 * slow + 1) rate = std::max(rate, std::abs(lambda) / 2);
  const double cells = std::ceil(rate * two_pi / num_outputs);
  return static_cast<int>(std::min(cells, 1e9));
}

// CVODE: a fixed cost, and its vectors' length; BDF solves a system besides. Collocation: elimination of 9 I unknowns
// and as many right-hand sides as columns.
double work_per_step(Integrator method, Eigen::Index num_modes, Eigen::Index num_columns) {
  const auto I = static_cast<double>(num_modes), c = static_cast<double>(num_columns);
  switch (method) {
    case Integrator::collocation: {
      const double n = 9 * I;
      return 2e-5 + 1e-10 * (2.0 / 3 * n * n * n + 2 * n * n * c);
    }
    case Integrator::bdf:
      return 2e-5 + 6e-7 * I * c;
    default:
      return 2e-5 + 4e-7 * I * c;
  }
}

double seconds_per_step(ScaledMotion& motion, Integrator method, Eigen::Index num_columns) {
  using Clock = std::chrono::steady_clock;
  const Eigen::Index I = motion.num_modes();
  const Eigen::MatrixXd Y0 = Eigen::MatrixXd::Zero(2 * I, num_columns);
  const Eigen::VectorXd load = Eigen::VectorXd::Ones(num_columns);
  const std::vector<double> outputs = {1e-3};
  // Zero load and state would be free; the load makes CVODE take some dozens of steps.
  double best = 1e300;
  for (int repeat = 0; repeat < 2; ++repeat) {
    const auto start = Clock::now();
    const Deadline deadline = start + std::chrono::milliseconds(20);
    const Trajectory trajectory = method == Integrator::collocation
                                      ? integrate_collocation(motion, 2, 0, Y0, load, outputs, deadline)
                                      : integrate_cvode(motion, method, 1e-10, 0, Y0, load, outputs, deadline);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    best = std::min(best, seconds / static_cast<double>(std::max(1L, trajectory.steps)));
  }
  return best;
}

}  // namespace hb
