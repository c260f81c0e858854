#include "hb/analysis/nearest_resonance.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/system/scaled_system.hpp"
#include "lib/dense.hpp"
#include "lib/positive_definite.hpp"

namespace hb {
namespace {

using Eigen::Index;

constexpr Index most_unknowns = 60;

// Omega with r(Omega) = n by Omega <- Omega r(Omega)/n, which is exact where omega_1 does not depend on the speed.
std::optional<NearestResonance> resonance_of(const HillSystem& system, double speed, int n) {
  constexpr int most_steps = 60;
  constexpr double tolerance = 1e-10;
  double Omega = speed;
  for (int step = 0; step < most_steps; ++step) {
    const double ratio = frequency_ratio(system, Omega);
    if (!(ratio > 0) || !std::isfinite(ratio)) return std::nullopt;
    const double next = Omega * ratio / n;
    if (!(next > 0) || !std::isfinite(next)) return std::nullopt;
    if (std::abs(next - Omega) <= tolerance * Omega) return NearestResonance{n, next, n * next};
    Omega = next;
  }
  return std::nullopt;
}

// N x components.
Eigen::MatrixXd by_angle(const Eigen::MatrixXcd& harmonics, Index N) {
  fourier::RealTransform& transform = fourier::thread_transform(N, harmonics.rows());
  auto spectrum = transform.spectrum();
  spectrum.topRows(harmonics.cols()) = harmonics.transpose();
  spectrum.bottomRows(spectrum.rows() - harmonics.cols()).setZero();
  transform.backward();
  return transform.samples();
}

// u at N angles, N x I; empty unless C is symmetric and positive definite at all of them.
std::optional<Eigen::MatrixXd> by_definite(const FourierSeries& C, const FourierSeries& h, Index N) {
  const Index I = h.num_components();
  std::vector<Index> lower;
  for (Index j = 0; j < I; ++j)
    for (Index i = j; i < I; ++i) {
      if (C.c.row(i + I * j) != C.c.row(j + I * i)) return std::nullopt;
      lower.push_back(i + I * j);
    }
  const Eigen::MatrixXd matrices = by_angle(C.c(lower, Eigen::all), N);
  Eigen::MatrixXd motion = by_angle(h.c, N);
  std::vector<Lanes> A(static_cast<std::size_t>(I * I)), u(static_cast<std::size_t>(I));
  for (Index first = 0; first < N; first += Lanes::width) {
    for (std::size_t e = 0; e < lower.size(); ++e)
      A[static_cast<std::size_t>(lower[e])] = Lanes::load(&matrices(first, static_cast<Index>(e)));
    for (Index i = 0; i < I; ++i) u[static_cast<std::size_t>(i)] = Lanes::load(&motion(first, i));
    if (!solve_positive_definite(I, A.data(), u.data())) return std::nullopt;
    for (Index i = 0; i < I; ++i) u[static_cast<std::size_t>(i)].store(&motion(first, i));
  }
  return motion;
}

// The same where the determinant keeps its sign over the turn; else C is singular between two angles.
std::optional<Eigen::MatrixXd> by_elimination(const FourierSeries& C, const FourierSeries& h, Index N) {
  const Index I = h.num_components();
  const Eigen::MatrixXd matrices = fourier::synthesise(C, N), loads = fourier::synthesise(h, N);
  Eigen::MatrixXd motion(N, I);
  dense::Lu<double> lu;
  int sign = 0;
  for (Index j = 0; j < N; ++j) {
    lu.compute(Eigen::Map<const Eigen::MatrixXd>(matrices.col(j).data(), I, I));
    const Eigen::VectorXd pivots = lu.pivots();
    const int now = lu.sign() * (((pivots.array() < 0).count() % 2 == 0) ? 1 : -1);
    if (!(pivots.cwiseAbs().minCoeff() > 0) || (j > 0 && now != sign)) return std::nullopt;
    sign = now;
    motion.row(j) = lu.solve(Eigen::VectorXd(loads.col(j))).transpose();
  }
  return motion;
}

}  // namespace

double frequency_ratio(const HillSystem& system, double speed) {
  const double w2 = squared_frequencies(system, speed)(0);
  return w2 > 0 ? std::sqrt(w2) : 0.0;
}

std::optional<NearestResonance> nearest_resonance(const HillSystem& system, double speed) {
  if (system.num_modes() > most_unknowns) return std::nullopt;
  const double ratio = frequency_ratio(system, speed);
  constexpr double most_orders = 1e6;
  if (!(ratio > 0 && ratio < most_orders)) return std::nullopt;
  const int below = std::max(1, static_cast<int>(std::floor(ratio)));
  std::optional<NearestResonance> nearest;
  for (const int n : {below, below + 1}) {
    const std::optional<NearestResonance> found = resonance_of(system, speed, n);
    if (found && (!nearest || std::abs(found->speed - speed) < std::abs(nearest->speed - speed))) nearest = found;
  }
  return nearest;
}

// Amplitudes 2 |c_k| against the bound on max |q|, of which sum_k 2 |c_k| is not less.
int highest_harmonic(const SteadyState& response) {
  const Eigen::MatrixXcd& c = response.q.c;
  Eigen::VectorXd amplitudes = Eigen::VectorXd::Zero(c.cols());
  for (Index k = 0; k < c.cols(); ++k) amplitudes(k) = (k == 0 ? 1 : 2) * c.col(k).cwiseAbs().maxCoeff();
  const double error = response.error_bound * amplitudes.sum();
  Index order = std::max<Index>(0, c.cols() - 1);
  while (order > 0 && !(amplitudes(order) > error)) --order;
  return static_cast<int>(order);
}

std::optional<Eigen::MatrixXd> quasi_static_motion(const HillSystem& system, Index num_modes, double speed) {
  const FourierSeries C = stiffness_at(system, speed), h = load_at(system, speed);
  const Index I = system.num_modes();
  if (h.c.size() == 0) return std::nullopt;
  const Index H = std::max(C.num_harmonics(), h.num_harmonics());
  const Index N = fourier::fast_length(std::max<Index>(4 * H + 2, 32));
  std::optional<Eigen::MatrixXd> u = by_definite(C, h, N);
  if (!u) u = by_elimination(C, h, N);
  if (!u || !u->allFinite()) return std::nullopt;
  Eigen::MatrixXd motion = u->leftCols(num_modes);
  if (I == 2 * num_modes) motion += u->rightCols(num_modes);
  return motion.transpose();
}

std::optional<double> quasi_static_response(const HillSystem& system, Index num_modes, double speed) {
  if (system.num_modes() > most_unknowns) return std::nullopt;
  const std::optional<Eigen::MatrixXd> motion = quasi_static_motion(system, num_modes, speed);
  if (!motion || !(motion->cwiseAbs().maxCoeff() > 0)) return std::nullopt;
  return motion->cwiseAbs().maxCoeff();
}

}  // namespace hb
