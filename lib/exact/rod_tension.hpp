// The axial force along the bent rods of a motion, by the exact model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lib/exact/exact_model.hpp"

namespace hb {

// Of one rod, tension positive: at Gauss points and both ends x (distance along the rod from joint 0), a column per
// angle.
struct RodTension {
  Eigen::VectorXd x;
  Eigen::MatrixXd N;

  // At other places, by the polynomial through these; a row for each.
  [[nodiscard]] Eigen::MatrixXd at(const Eigen::Ref<const Eigen::VectorXd>& places) const;
};

// Of every rod of the model, in its order. Not finite where the model breaks down.
[[nodiscard]] std::vector<RodTension> rod_tensions(const ExactModel& model, double speed, const CrankAngles& angles,
                                                   const RitzSamples& motion);

}  // namespace hb
