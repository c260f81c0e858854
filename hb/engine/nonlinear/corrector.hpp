// Newton's method on the equations of harmonic balance, with or without a constraint that lets the parameter move:
//     F(u, p) = 0,     row . (u - u_0) + row_p (p - p_0) = 0.
// Damped by the natural monotonicity test, which is free of the scaling of equations and unknowns, and with factors
// kept while the corrections contract (P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2011, sections 3.3
// and 2.1.4, doi:10.1007/978-3-642-23899-4).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "hb/engine/nonlinear/harmonic_balance.hpp"
#include "lib/dense.hpp"

namespace hb::nonlinear {

struct Unknowns {
  Eigen::VectorXd u;
  double p = 0;
};

// Empty row: the parameter is held.
struct Constraint {
  Eigen::VectorXd row;
  double row_p = 0;

  bool holds_parameter() const { return row.size() == 0; }
};

enum class CorrectionStatus {
  converged,
  no_convergence,  // damping below its limit, or too many iterations
  no_residual,  // r does not exist where the iteration began, or everywhere it tried to go
  singular,
  stopped,
};

struct Correction {
  CorrectionStatus status = CorrectionStatus::no_convergence;
  EvaluationFailure failure;  // the last one met; empty reason: none
  double last = 0;  // size of the last correction of u, see size(); what is left is below it, or is rounding
  double contraction = 0;  // first ratio of two corrections
  double first = 0;  // size of the first correction
  int factorisations = 0;
};

class Corrector {
 public:
  // `stop` is asked between evaluations.
  Corrector(HarmonicBalance& balance, double p_scale, std::function<bool()> stop);

  // From x to a solution, with errors of u below `tolerance` of its size or at rounding. Factors of an earlier call are
  // used while they serve if `keep_factors`; the constraint is then that of those factors.
  [[nodiscard]] Correction solve(Unknowns& x, const Constraint& constraint, double tolerance, bool keep_factors = false,
                                 int max_factorisations = 40);

  // Factors at x, with its linearisation.
  [[nodiscard]] Correction factorise(const Unknowns& x, const Constraint& constraint);
  // Solution of [dF/du F_p; row row_p] (du, dp) = (F, g); without the last row if the parameter is held.
  [[nodiscard]] Unknowns apply(const Eigen::VectorXd& F, double g = 0) const;
  [[nodiscard]] const Linearisation& linearisation() const { return linear_; }
  [[nodiscard]] bool has_factors() const { return factors_.size() > 0; }
  // Sign of the determinant of the factors.
  [[nodiscard]] int determinant_sign() const;
  HarmonicBalance& balance() { return *balance_; }

 private:
  double norm(const Unknowns& change) const;

  HarmonicBalance* balance_;
  double p_scale_, u_scale_ = 0;
  std::function<bool()> stop_;
  Constraint constraint_;
  Linearisation linear_;
  Eigen::VectorXd residual_;  // at the factors
  Eigen::VectorXd row_scale_;
  dense::Lu<double> factors_;
};

}  // namespace hb::nonlinear
