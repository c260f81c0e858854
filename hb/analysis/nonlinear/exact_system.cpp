#include "hb/analysis/nonlinear/exact_system.hpp"

#include <optional>
#include <utility>

namespace hb {

NonlinearSystem exact_system(std::shared_ptr<const ExactModel> model) {
  NonlinearSystem system;
  system.num_unknowns = model->num_modes();
  system.speed = [](double parameter) { return parameter; };
  // Solvers come back to the same angles.
  system.evaluate = [model = std::move(model), angles = std::optional<CrankAngles>()](
                        double speed, const MotionSamples& motion, Derivatives wanted,
                        ResidualSamples& out) mutable -> std::optional<EvaluationFailure> {
    const bool known = angles && angles->size() == motion.num_samples() && angles->tau == motion.angle;
    if (!known) angles.emplace(model->linkage(), motion.angle);
    ExactResidual at = model->residual(speed, *angles, {motion.q, motion.v, motion.a}, wanted == Derivatives::state);
    if (at.breakdown) return EvaluationFailure{describe(*at.breakdown, model->linkage()), at.breakdown->crank_angle};
    out.r = std::move(at.r);
    out.dq = std::move(at.by_q);
    out.dv = std::move(at.by_q1);
    out.da = std::move(at.by_q2);
    out.dp = std::move(at.by_speed);
    return std::nullopt;
  };
  return system;
}

}  // namespace hb
