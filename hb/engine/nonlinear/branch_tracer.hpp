// Single points of a branch: corrected onto it, with tangent, error and exponents, as many harmonics as they take.
#pragma once

#include <memory>
#include <optional>

#include "hb/engine/nonlinear/continuation.hpp"
#include "hb/engine/nonlinear/corrector.hpp"
#include "hb/engine/nonlinear/truncation_check.hpp"

namespace hb::nonlinear {

// Where lengths and angles are measured: <a, b> = mean of a.u b.u/motion^2 + a.p b.p/parameter^2.
struct Metric {
  double motion = 1, parameter = 1;
  Eigen::Index num_components = 1;

  double product(const Unknowns& a, const Unknowns& b) const;
  double length(const Unknowns& a) const { return std::sqrt(product(a, a)); }
  // <direction, x> as a constraint, scaled so that its entries are about one.
  Constraint across(const Unknowns& direction) const;
};

// Differences and combinations of points with different numbers of harmonics.
[[nodiscard]] Unknowns combination(double a, const Unknowns& x, double b, const Unknowns& y);
[[nodiscard]] Unknowns with_harmonics(const Unknowns& x, Eigen::Index num_components, Eigen::Index num_harmonics);

[[nodiscard]] Unknowns place_of(const BranchPoint& point);
[[nodiscard]] Unknowns tangent_of(const BranchPoint& point);

// Cubic through two points with their tangents, at arc length s behind the first.
[[nodiscard]] Unknowns between(const BranchPoint& a, const BranchPoint& b, double s);
[[nodiscard]] double parameter_between(const BranchPoint& a, const BranchPoint& b, double s);

struct Trace {
  CorrectionStatus status = CorrectionStatus::no_convergence;
  std::optional<EvaluationFailure> failure;
  BranchPoint point;
  double contraction = 0;  // of the first corrections
  double moved = 0;  // length from the prediction to the point
};

class BranchTracer {
 public:
  BranchTracer(const NonlinearSystem& system, const ContinuationOptions& options);

  // The metric at a motion.
  [[nodiscard]] Metric metric(const Unknowns& x) const;
  // The point of the branch that a prediction leads to, across `direction`; with its tangent, turned along it.
  // keep_factors: those of the last point serve, which were across nearly the same direction.
  [[nodiscard]] Trace trace(const Unknowns& prediction, const Unknowns& direction, bool keep_factors,
                            bool with_exponents) {
    return run(prediction, direction, false, keep_factors, with_exponents);
  }
  // The point at the prediction's own parameter.
  [[nodiscard]] Trace trace_at_parameter(const Unknowns& prediction, const Unknowns& direction, bool with_exponents) {
    return run(prediction, direction, true, false, with_exponents);
  }

  Eigen::Index num_harmonics() const { return H_; }
  Eigen::Index harmonics_needed() const { return needed_; }  // by the last point
  void set_harmonics(Eigen::Index num_harmonics);
  long evaluations() const { return evaluations_ + (balance_ ? balance_->evaluated_samples() : 0); }
  int factorisations() const { return factorisations_; }

 private:
  [[nodiscard]] Trace run(const Unknowns& prediction, const Unknowns& direction, bool hold_parameter, bool keep_factors,
                          bool with_exponents);
  void take_harmonics(Eigen::Index num_harmonics);
  [[nodiscard]] bool stopped() const { return options_->stop && options_->stop(); }
  // Tangent, error, exponents at a solution; more harmonics are wanted if it returns a number above H.
  [[nodiscard]] Eigen::Index finish(Trace& trace, const Unknowns& x, const Unknowns& direction, double last_correction,
                                    bool hold_parameter, bool with_exponents);

  const NonlinearSystem* system_;
  const ContinuationOptions* options_;
  double parameter_scale_;
  Eigen::Index H_ = 0, oversampling_ = 1;
  std::unique_ptr<HarmonicBalance> balance_;
  std::unique_ptr<Corrector> corrector_;
  Eigen::Index needed_ = 0;  // harmonics that the last point took
  long evaluations_ = 0;
  int factorisations_ = 0;
};

}  // namespace hb::nonlinear
