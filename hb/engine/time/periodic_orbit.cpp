#include "hb/engine/time/periodic_orbit.hpp"

#include "lib/constants.hpp"

namespace hb {

PeriodicOrbit orbit_of(ScaledMotion& motion, const Eigen::MatrixXd& states) {
  const Eigen::Index I = motion.num_modes();
  PeriodicOrbit orbit;
  orbit.q = states.topRows(I) * motion.q_scale();
  orbit.q1 = motion.w().asDiagonal() * states.bottomRows(I) * motion.q_scale();
  orbit.q2.resize(I, states.cols());
  for (Eigen::Index j = 0; j < states.cols(); ++j) {
    motion.evaluate(two_pi * static_cast<double>(j) / static_cast<double>(states.cols()));
    orbit.q2.col(j) =
        motion.w().cwiseProduct(motion.f() - motion.K() * states.col(j).head(I) - motion.G() * states.col(j).tail(I)) *
        motion.q_scale();
  }
  return orbit;
}

}  // namespace hb
