#include <algorithm>
#include <cmath>

#include "hb/engine/nonlinear/branch_tracer.hpp"
#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nonlinear::BranchTracer;
using nonlinear::combination;
using nonlinear::CorrectionStatus;
using nonlinear::HarmonicBalance;
using nonlinear::Linearisation;
using nonlinear::Metric;
using nonlinear::Trace;
using nonlinear::Unknowns;

namespace {

// First distance from the bifurcation, in lengths of the branch; quartered where no point is found.
constexpr double first_distance = 0.05;
constexpr int most_tries = 6;

// Direction that a nearly singular matrix of harmonic balance shrinks most, by inverse iteration with A' A from a fixed
// start. harmonic(row) is the row's harmonic: inertia makes the equations of one component grow like its square; their
// size is taken from the largest of them, since the singular row may be small all over.
VectorXd null_vector(MatrixXd A, Index num_components, const std::vector<Index>& harmonic) {
  VectorXd size = VectorXd::Zero(num_components);
  const auto square = [&](Index row) { return 1 + double(harmonic[std::size_t(row)] * harmonic[std::size_t(row)]); };
  const auto rows = Index(harmonic.size());
  for (Index row = 0; row < rows; ++row)
    size(row % num_components) =
        std::max(size(row % num_components), A.row(row).head(rows).cwiseAbs().maxCoeff() / square(row));
  for (Index row = 0; row < rows; ++row) A.row(row) /= square(row) * std::max(size(row % num_components), 1e-300);
  const dense::Lu<double> lu(A);
  VectorXd x(A.rows());
  for (Index i = 0; i < x.size(); ++i) x(i) = 1 + 0.5 * std::sin(double(i));
  for (int iteration = 0; iteration < 4; ++iteration) {
    x = lu.solve(lu.solve_transposed(x));
    if (!x.allFinite()) return {};
    x.normalize();
  }
  return x;
}

// The first point at a distance along `direction`, which stays turned away from the bifurcation.
std::optional<BranchPoint> step_off(BranchTracer& tracer, const Unknowns& from, Unknowns direction, bool exponents) {
  const Metric metric = tracer.metric(from);
  const double length = metric.length(direction);
  direction.u /= length;
  direction.p /= length;
  double distance = first_distance;
  for (int attempt = 0; attempt < most_tries; ++attempt, distance /= 4) {
    tracer.set_harmonics((direction.u.size() / metric.num_components - 1) / 2);
    Trace trace = tracer.trace(combination(1, from, distance, direction), direction, false, exponents);
    if (trace.status == CorrectionStatus::stopped) return std::nullopt;
    if (trace.status != CorrectionStatus::converged) continue;
    const Unknowns moved = combination(1, nonlinear::place_of(trace.point), -1, from);
    if (metric.product(moved, direction) > 0.5 * distance && metric.length(moved) < 4 * distance) return trace.point;
  }
  return std::nullopt;
}

// Over twice the turns the bifurcating motion shows in odd harmonics alone, which the motion itself does not have.
std::vector<BranchPoint> doubled(const NonlinearSystem& system, const BranchPoint& at, ContinuationOptions options) {
  const Index n = system.num_unknowns, H = 2 * at.motion.num_harmonics;
  options.motion.turns = 2 * at.motion.turns;
  if (options.motion.num_harmonics > 0) options.motion.num_harmonics = int(H);
  HarmonicBalance balance(system, options.motion.turns, H, nonlinear::samples_for(H));
  const Unknowns x{nonlinear::to_unknowns(repeated(at.motion.q, 2), H), at.motion.parameter};
  Linearisation linear;
  VectorXd R;
  if (balance.linearise(x.u, x.p, R, linear)) return {};
  const MatrixXd J = balance.jacobian(linear, x.p);
  std::vector<Index> odd, harmonic;
  for (Index k = 1; k <= H; k += 2)
    for (Index i = 0; i < 2 * n; ++i) {
      odd.push_back(n * (2 * k - 1) + i);
      harmonic.push_back(k);
    }
  const VectorXd shape = null_vector(J(odd, odd), n, harmonic);
  if (shape.size() == 0) return {};
  Unknowns direction{VectorXd::Zero(x.u.size()), 0};
  direction.u(odd) = shape;
  BranchTracer tracer(system, options);
  if (auto point = step_off(tracer, x, direction, options.stability)) return {*std::move(point)};
  return {};
}

// The two directions in which F = 0 can be left to first order: the branch's tangent t, and the one across it.
std::vector<BranchPoint> crossing(const NonlinearSystem& system, const BranchPoint& at,
                                  const ContinuationOptions& options) {
  const Index n = system.num_unknowns, H = at.motion.num_harmonics;
  HarmonicBalance balance(system, at.motion.turns, H, at.motion.num_samples);
  const Unknowns x = nonlinear::with_harmonics(nonlinear::place_of(at), n, H);
  BranchTracer tracer(system, options);
  const Metric metric = tracer.metric(x);
  Linearisation linear;
  VectorXd R, Rp;
  if (balance.linearise(x.u, x.p, R, linear)) return {};
  if (balance.parameter_derivative(x.u, x.p, metric.parameter, linear, Rp)) return {};
  const nonlinear::Constraint across = metric.across(nonlinear::with_harmonics(nonlinear::tangent_of(at), n, H));
  const Index m = x.u.size();
  MatrixXd A(m + 1, m + 1);
  A << balance.jacobian(linear, x.p), Rp, across.row.transpose(), across.row_p;
  std::vector<Index> harmonic;
  for (Index row = 0; row < m; ++row) harmonic.push_back((row / n + 1) / 2);
  const VectorXd shape = null_vector(std::move(A), n, harmonic);
  if (shape.size() == 0) return {};
  std::vector<BranchPoint> points;
  for (const double sign : {1.0, -1.0}) {
    const Unknowns direction{sign * shape.head(m), sign * shape(m)};
    if (auto point = step_off(tracer, x, direction, options.stability)) points.push_back(*std::move(point));
  }
  return points;
}

}  // namespace

std::vector<BranchPoint> branches_at(const NonlinearSystem& system, const Bifurcation& bifurcation,
                                     const ContinuationOptions& options) {
  switch (bifurcation.kind) {
    case BifurcationKind::period_doubling:
      return doubled(system, bifurcation.point, options);
    case BifurcationKind::branch_point:
      return crossing(system, bifurcation.point, options);
    case BifurcationKind::fold:
    case BifurcationKind::neimark_sacker:
      return {};
  }
  return {};
}

}  // namespace hb
