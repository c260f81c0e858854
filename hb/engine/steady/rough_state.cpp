#include "hb/engine/steady/rough_state.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/steady/steady_iterative.hpp"
#include "hb/engine/steady/truncation.hpp"
#include "lib/dense.hpp"

namespace hb {

// L M T = 1, y = weight T^-1 q:  y'' + G y' + K y = weight L load/Omega^2.
struct RoughSolver::Impl {
  steady::WeightedSystem weighted;
  Eigen::MatrixXd L, T;  // with the weights
  Eigen::MatrixXd T_inverse;
  std::optional<steady::Operator> A;
  std::optional<steady::IterativeInverse> inverse;
  double tolerance = 0;  // that the window of A was made for

  explicit Impl(const ScaledSystem& scaled, const Eigen::MatrixXd& mass) : weighted(steady::weighted(scaled)) {
    L = weighted.weight.asDiagonal() * dense::inverse(Eigen::MatrixXd(mass * scaled.T)) / (scaled.speed * scaled.speed);
    T = scaled.T * weighted.weight.cwiseInverse().asDiagonal();
    T_inverse = scaled.speed * scaled.speed * L * mass;
  }

  // y/scale of `near` on the window, and f - A y of f there; empty where that is no smaller than f. The tolerance
  // becomes that of what is left: so that the whole keeps its own, and the difference from `near` shows to at least its
  // root.
  steady::Spectrum begun(const FourierSeries& near, double scale, steady::Spectrum& f, double& tolerance) {
    const Eigen::Index H = A->num_harmonics(), known = std::min(H + 1, near.c.cols());
    steady::Spectrum y = steady::Spectrum::Zero(H + 1, weighted.I), left;
    y.topRows(known) = (T_inverse.leftCols(near.num_components()) * near.c.leftCols(known)).transpose() * (1 / scale);
    A->couple(y, H, left);
    left = f - A->D().cwiseProduct(y) - left;
    const double load = A->scaled_norm(f), rest = A->scaled_norm(left);
    if (!(rest < load)) return {};
    tolerance = std::min(tolerance * load / rest, std::sqrt(tolerance));
    f = std::move(left);
    return y;
  }
};

RoughSolver::RoughSolver(const HillSystem& system, double speed)
    : RoughSolver(scale_unloaded(system, speed), system.mass) {}

RoughSolver::RoughSolver(const ScaledSystem& scaled, const Eigen::MatrixXd& mass)
    : impl_(std::make_unique<Impl>(scaled, mass)) {}

RoughSolver::~RoughSolver() = default;
RoughSolver::RoughSolver(RoughSolver&&) noexcept = default;
RoughSolver& RoughSolver::operator=(RoughSolver&&) noexcept = default;

std::optional<FourierSeries> RoughSolver::solve(const FourierSeries& load, double tolerance,
                                                const FourierSeries* near) {
  constexpr Eigen::Index most_harmonics = 256;
  constexpr double negligible = 1e-3;  // of the load; a sharper resonance at so high a harmonic is not looked for
  steady::WeightedSystem& system = impl_->weighted;
  system.f = (impl_->L * load.c).transpose();
  // Moduli of extreme size overflow or vanish in squares: then the iteration says no.
  const double scale = std::sqrt(system.f.cwiseAbs2().maxCoeff());
  if (scale == 0) return FourierSeries(system.I, 0);
  if (!std::isfinite(scale)) return std::nullopt;
  system.f *= 1 / scale;
  const double floor = std::pow(negligible * tolerance, 2);
  Eigen::Index last = system.f.rows() - 1;
  while (last > 0 && !(system.f.row(last).cwiseAbs2().maxCoeff() > floor)) --last;
  system.f.conservativeResize(last + 1, Eigen::NoChange);
  if (!impl_->A || tolerance < impl_->tolerance) {
    const Eigen::Index H = steady::predicted_harmonics(system, tolerance, most_harmonics);
    if (H >= most_harmonics) return std::nullopt;
    impl_->inverse.reset();
    impl_->A.emplace(system, H);
    impl_->inverse.emplace(*impl_->A);
    impl_->tolerance = tolerance;
  }
  const Eigen::Index window = impl_->A->num_harmonics();
  steady::Spectrum f = steady::Spectrum::Zero(window + 1, system.I), x;
  const Eigen::Index rows = std::min(window + 1, system.f.rows());
  f.topRows(rows) = system.f.topRows(rows);
  steady::Spectrum start;
  if (near != nullptr) start = impl_->begun(*near, scale, f, tolerance);
  if (!impl_->inverse->solve(f, tolerance, x) || !x.allFinite()) return std::nullopt;
  if (start.size() > 0) x += start;
  FourierSeries q(Eigen::MatrixXcd(scale * impl_->T * x.transpose()));
  q.c.col(0) = q.c.col(0).real().cast<std::complex<double>>().eval();
  return q;
}

double nearest_amplification(const HillSystem& system, double speed) {
  const Eigen::Index I = system.num_modes();
  double largest = 1;
  for (Eigen::Index i = 0; i < I; ++i) {
    double c = 0, power = 1;
    for (const FourierSeries& C : system.stiffness) {
      if (C.c.size() > 0) c += power * C.c(i + I * i, 0).real();
      power *= speed;
    }
    const double m = system.mass(i, i), b = system.damping(i, i);
    const double nearest = std::round(std::sqrt(std::max(0.0, c / m)) / speed);
    for (const double n : {nearest - 1, nearest, nearest + 1}) {
      const double omega = n * speed, inertia = m * omega * omega, damping = std::abs(b * omega);
      largest = std::max(largest, (std::abs(c) + inertia + damping) / std::hypot(c - inertia, damping));
    }
  }
  return largest;
}

}  // namespace hb
