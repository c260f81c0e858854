#include "hb/engine/time/variational_integration.hpp"

#include "hb/engine/time/sundials_session.hpp"
#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct VariationalProblem {
  const NonlinearMotion& motion;
  const std::function<bool()>& stop;
  void* cvode = nullptr;
  bool stopped = false, missing = false;
  AccelerationSamples at;  // of the last right-hand side
  MatrixXd K, G;  // x' = W u,  u' = -K x - G u for variations

  Index rows() const { return 2 * motion.num_unknowns(); }
  Eigen::Map<MatrixXd> matrix(N_Vector y) const { return {N_VGetArrayPointer(y), rows(), rows() + 1}; }
};

int variational_rhs(realtype tau, N_Vector y, N_Vector slope, void* data) {
  auto& problem = *static_cast<VariationalProblem*>(data);
  if (problem.stop && problem.stop()) {
    problem.stopped = true;
    return -1;
  }
  const NonlinearMotion& motion = problem.motion;
  const VectorXd& w = motion.w;
  const Index n = motion.num_unknowns();
  const auto Y = problem.matrix(y);
  auto D = problem.matrix(slope);
  const VectorXd q = motion.q_scale * Y.col(0).head(n), v = motion.q_scale * w.cwiseProduct(Y.col(0).tail(n));
  // Recoverable: a shorter step may stay where a exists.
  if (!Y.allFinite() || !motion.acceleration(tau, q, v, problem.at)) {
    problem.missing = true;
    return 1;
  }
  problem.missing = false;
  problem.K = -(w.cwiseInverse().asDiagonal() * problem.at.by_q);
  problem.G = -(w.cwiseInverse().asDiagonal() * problem.at.by_v * w.asDiagonal());
  D.topRows(n) = w.asDiagonal() * Y.bottomRows(n);
  D.col(0).tail(n) = problem.at.a.cwiseQuotient(w) / motion.q_scale;
  const auto variations = Y.rightCols(2 * n);
  D.bottomRightCorner(n, 2 * n).noalias() = -problem.K * variations.topRows(n);
  D.bottomRightCorner(n, 2 * n).noalias() -= problem.G * variations.bottomRows(n);
  return D.allFinite() ? 0 : 1;
}

// Newton's matrix 1 - gamma J with J of the last right-hand side, alike for the state and every variation; that the
// variations' slopes change with the state is left to the iteration. With dx = bx + gamma W du,
//     (1 + gamma G + gamma^2 K W) du = bu - gamma K bx.
int solve_variational_newton(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, realtype) {
  auto& problem = *static_cast<VariationalProblem*>(solver->content);
  const auto place = newton_place(problem.cvode);
  if (!place) return SUNLS_PACKAGE_FAIL_UNREC;
  const double gamma = place->gamma;
  const VectorXd& w = problem.motion.w;
  const Index n = problem.motion.num_unknowns();
  const MatrixXd A = MatrixXd::Identity(n, n) + gamma * problem.G + gamma * gamma * problem.K * w.asDiagonal();
  const auto B = problem.matrix(b);
  auto X = problem.matrix(x);
  const MatrixXd right = B.bottomRows(n) - gamma * problem.K * B.topRows(n);
  X.bottomRows(n) = dense::Lu<double>(A).solve(right);
  X.topRows(n) = B.topRows(n) + gamma * w.asDiagonal() * X.bottomRows(n);
  return SUNLS_SUCCESS;
}

}  // namespace

Trajectory integrate_variations(const NonlinearMotion& motion, Integrator method, double tolerance, double tau0,
                                const VectorXd& state, std::span<const double> outputs,
                                const std::function<bool()>& stop) {
  const Index rows = 2 * motion.num_unknowns();
  SundialsSession sundials(method, rows * (rows + 1));
  VariationalProblem problem{motion, stop, sundials.cvode(), false, false, {}, {}, {}};
  auto Y = problem.matrix(sundials.y());
  Y.col(0) = state;
  Y.rightCols(rows).setIdentity();
  sundials.start({variational_rhs, solve_variational_newton, &problem}, tau0, tolerance, outputs.back());
  // Where the equations end the steps shrink without an end of their own.
  constexpr long most_steps = 200000;  // to an output
  constexpr double shortest = 1e-10;  // rad of crank angle
  require_success(CVodeSetMaxNumSteps(sundials.cvode(), most_steps), "CVodeSetMaxNumSteps");
  require_success(CVodeSetMinStep(sundials.cvode(), shortest), "CVodeSetMinStep");
  return sundials.follow(
      outputs, [&](N_Vector y) { return problem.matrix(y); },
      [&](std::string word) -> SundialsSession::Failure {
        if (problem.stopped) return {IntegrationStatus::time_limit, "stopped"};
        return {IntegrationStatus::failed, problem.missing ? "the equations do not exist" : std::move(word)};
      });
}

}  // namespace hb
