// One integration by CVODE, whose parts are freed together. Used by the sources that integrate.
#pragma once

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "hb/engine/time/time_integration.hpp"

namespace hb {

// y' = slope(tau, y) as CVODE calls it, and the exact solution of Newton's equations (1 - gamma J) x = b; both are
// given `data`, the second as the solver's content.
struct SundialsProblem {
  CVRhsFn slope;
  int (*newton)(SUNLinearSolver, SUNMatrix, N_Vector x, N_Vector b, realtype tolerance);
  void* data;
};

class SundialsSession {
 public:
  // So many numbers, to be filled at y(); Adams or BDF.
  SundialsSession(Integrator method, Eigen::Index size);
  SundialsSession(const SundialsSession&) = delete;
  SundialsSession& operator=(const SundialsSession&) = delete;
  ~SundialsSession();

  void* cvode() const { return cvode_; }
  N_Vector y() const { return y_; }

  // From y at tau0 to `end`, local errors relative and absolute below `tolerance`.
  void start(const SundialsProblem& problem, double tau0, double tolerance, double end);

  // States at the outputs, seen through `matrix`, up to the first that cannot be reached; then `failure` says what
  // became of it, given CVODE's own word.
  struct Failure {
    IntegrationStatus status;
    std::string words;
  };
  Trajectory follow(std::span<const double> outputs, const std::function<Eigen::Map<Eigen::MatrixXd>(N_Vector)>& matrix,
                    const std::function<Failure(std::string)>& failure);

 private:
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;

  void release();
};

void require_success(int flag, const char* call);

// Crank angle and gamma of Newton's equations; nothing where CVODE does not tell.
struct NewtonPlace {
  double tau, gamma;
};
[[nodiscard]] std::optional<NewtonPlace> newton_place(void* cvode);

}  // namespace hb
