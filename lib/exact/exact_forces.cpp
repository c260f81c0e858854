#include "lib/exact/exact_forces.hpp"

#include <algorithm>

#include "lib/linkage/joint_rows.hpp"

namespace hb {

using Eigen::Index;

ForceSamples exact_forces(const ExactModel& model, double speed, const CrankAngles& angles, const RitzSamples& motion) {
  const std::vector<JointRow> rows = joint_rows(model.linkage());
  const auto components = [](const JointRow& row) { return row.kind == JointRow::Kind::guide ? 1 : 2; };
  Index size = 1;
  for (const JointRow& row : rows) size += components(row);

  const ExactModel::Forces all = model.forces(speed, angles, motion);
  ForceSamples samples{Eigen::MatrixXd(size, angles.size()), all.breakdown};
  for (Index j = 0; j < angles.size(); ++j) {
    const auto angle = static_cast<std::size_t>(j);
    Index next = 0;
    for (const JointRow& row : rows) {
      const std::complex<double> force = resolved(row, all.forces[angle], all.motion[angle]);
      if (components(row) == 2) samples.values(next++, j) = force.real();
      samples.values(next++, j) = force.imag();
    }
    samples.values(next, j) = all.forces[angle].torque;
  }
  return samples;
}

Eigen::MatrixXd force_samples(const JointForces& forces, Index num_samples) {
  Index size = 1;
  for (const JointForce& joint : forces.joints) size += joint.elastic.num_components();
  Eigen::MatrixXd samples(size, num_samples);
  Index next = 0;
  for (const JointForce& joint : forces.joints) {
    const Index count = joint.elastic.num_components();
    samples.middleRows(next, count) = fourier::synthesise(joint.elastic, num_samples);
    next += count;
  }
  samples.row(next) = fourier::synthesise(forces.torque, num_samples);
  return samples;
}

}  // namespace hb
