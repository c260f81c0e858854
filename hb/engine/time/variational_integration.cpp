#include "hb/engine/time/variational_integration.hpp"

#include <cstdlib>
#include <limits>

#include "hb/engine/time/sundials_session.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

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
  realtype tau, gamma, rl1;
  N_Vector predicted, iterate, f, zn1;
  void* user;
  if (CVodeGetNonlinearSystemData(problem.cvode, &tau, &predicted, &iterate, &f, &gamma, &rl1, &zn1, &user) != 0)
    return SUNLS_PACKAGE_FAIL_UNREC;
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
  VariationalProblem problem{motion, stop, nullptr, false, false, {}, {}, {}};
  SundialsSession sundials;
  const Index rows = problem.rows();
  sundials.y = N_VNew_Serial(rows * (rows + 1), sundials.context);
  sundials.solver = SUNLinSolNewEmpty(sundials.context);
  sundials.cvode = CVodeCreate(method == Integrator::adams ? CV_ADAMS : CV_BDF, sundials.context);
  if (sundials.y == nullptr || sundials.solver == nullptr || sundials.cvode == nullptr) throw std::bad_alloc();
  void* cvode = problem.cvode = sundials.cvode;
  sundials.solver->content = &problem;
  sundials.solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
  sundials.solver->ops->solve = solve_variational_newton;
  auto Y = problem.matrix(sundials.y);
  Y.col(0) = state;
  Y.rightCols(rows).setIdentity();

  require_success(CVodeInit(cvode, variational_rhs, tau0, sundials.y), "CVodeInit");
  require_success(CVodeSetErrHandlerFn(
                      cvode, [](int, const char*, const char*, char*, void*) {}, nullptr),
                  "CVodeSetErrHandlerFn");
  require_success(CVodeSetUserData(cvode, &problem), "CVodeSetUserData");
  require_success(CVodeSStolerances(cvode, tolerance, tolerance), "CVodeSStolerances");
  // Where the equations end the steps shrink without an end of their own.
  constexpr long most_steps = 200000;  // to an output
  constexpr double shortest = 1e-10;  // rad of crank angle
  require_success(CVodeSetMaxNumSteps(cvode, most_steps), "CVodeSetMaxNumSteps");
  require_success(CVodeSetMinStep(cvode, shortest), "CVodeSetMinStep");
  require_success(CVodeSetStopTime(cvode, outputs.back()), "CVodeSetStopTime");
  require_success(CVodeSetLinearSolver(cvode, sundials.solver, nullptr), "CVodeSetLinearSolver");
  require_success(CVodeSetEpsLin(cvode, 1e-14), "CVodeSetEpsLin");

  Trajectory trajectory;
  trajectory.states.reserve(outputs.size());
  for (const double tau : outputs) {
    realtype reached = tau0;
    const StopHeld held;
    const int flag = CVode(cvode, tau, sundials.y, &reached, CV_NORMAL);
    CVodeGetNumSteps(cvode, &trajectory.steps);
    if (flag < 0) {
      trajectory.status = problem.stopped ? IntegrationStatus::time_limit : IntegrationStatus::failed;
      char* name = CVodeGetReturnFlagName(flag);
      trajectory.message = problem.stopped   ? "stopped"
                           : problem.missing ? "the equations do not exist"
                                             : std::string(name);
      trajectory.message += " at crank angle " + std::to_string(reached) + " rad";
      std::free(name);
      return trajectory;
    }
    trajectory.states.emplace_back(problem.matrix(sundials.y));
  }
  trajectory.status = IntegrationStatus::finished;
  return trajectory;
}

}  // namespace hb
