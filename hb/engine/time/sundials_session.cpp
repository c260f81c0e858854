#include "hb/engine/time/sundials_session.hpp"

#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>

#include "lib/stop_wish.hpp"

namespace hb {

void require_success(int flag, const char* call) {
  if (flag != CV_SUCCESS) throw std::runtime_error(std::string(call) + " failed with " + std::to_string(flag));
}

std::optional<NewtonPlace> newton_place(void* cvode) {
  realtype tau, gamma, rl1;
  N_Vector predicted, iterate, f, zn1;
  void* user;
  if (CVodeGetNonlinearSystemData(cvode, &tau, &predicted, &iterate, &f, &gamma, &rl1, &zn1, &user) != 0)
    return std::nullopt;
  return NewtonPlace{tau, gamma};
}

SundialsSession::SundialsSession(Integrator method, Eigen::Index size) {
  if (SUNContext_Create(nullptr, &context_) != 0) throw std::bad_alloc();
  y_ = N_VNew_Serial(size, context_);
  solver_ = SUNLinSolNewEmpty(context_);
  cvode_ = CVodeCreate(method == Integrator::adams ? CV_ADAMS : CV_BDF, context_);
  if (y_ != nullptr && solver_ != nullptr && cvode_ != nullptr) return;
  release();
  throw std::bad_alloc();
}
SundialsSession::~SundialsSession() { release(); }

void SundialsSession::release() {
  if (cvode_ != nullptr) CVodeFree(&cvode_);
  if (solver_ != nullptr) SUNLinSolFreeEmpty(solver_);
  if (y_ != nullptr) N_VDestroy(y_);
  SUNContext_Free(&context_);
}

void SundialsSession::start(const SundialsProblem& problem, double tau0, double tolerance, double end) {
  solver_->content = problem.data;
  solver_->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_MATRIX_EMBEDDED; };
  solver_->ops->solve = problem.newton;
  require_success(CVodeInit(cvode_, problem.slope, tau0, y_), "CVodeInit");
  require_success(CVodeSetErrHandlerFn(
                      cvode_, [](int, const char*, const char*, char*, void*) {}, nullptr),
                  "CVodeSetErrHandlerFn");
  require_success(CVodeSetUserData(cvode_, problem.data), "CVodeSetUserData");
  require_success(CVodeSStolerances(cvode_, tolerance, tolerance), "CVodeSStolerances");
  require_success(CVodeSetMaxNumSteps(cvode_, std::numeric_limits<long>::max() / 2), "CVodeSetMaxNumSteps");
  require_success(CVodeSetStopTime(cvode_, end), "CVodeSetStopTime");
  require_success(CVodeSetLinearSolver(cvode_, solver_, nullptr), "CVodeSetLinearSolver");
  // The linear solve is exact; never let CVODE skip it as "small enough".
  require_success(CVodeSetEpsLin(cvode_, 1e-14), "CVodeSetEpsLin");
}

Trajectory SundialsSession::follow(std::span<const double> outputs,
                                   const std::function<Eigen::Map<Eigen::MatrixXd>(N_Vector)>& matrix,
                                   const std::function<Failure(std::string)>& failure) {
  Trajectory trajectory;
  trajectory.states.reserve(outputs.size());
  for (const double tau : outputs) {
    realtype reached = 0;
    int flag = 0;
    {
      const StopHeld held;
      flag = CVode(cvode_, tau, y_, &reached, CV_NORMAL);
    }
    CVodeGetNumSteps(cvode_, &trajectory.steps);
    if (flag < 0) {
      char* name = CVodeGetReturnFlagName(flag);
      const std::string word = name;
      std::free(name);
      const Failure why = failure(word);
      trajectory.status = why.status;
      trajectory.message = why.words + " at crank angle " + std::to_string(reached) + " rad";
      return trajectory;
    }
    trajectory.states.emplace_back(matrix(y_));
  }
  trajectory.status = IntegrationStatus::finished;
  return trajectory;
}

}  // namespace hb
