#include "lib/exact/exact_forces.hpp"

#include <algorithm>

#include "lib/linkage/joint_rows.hpp"

namespace hb {

using Eigen::Index;

namespace {

// On the frame at one angle: pivots, guides and the motor as the bodies push back, and what applies the sliders'
// forces,
//     -(R + F),   -(T + sum (z - O) x (R_d + F_d)),   z the pivot or the slider's joint.
Eigen::Vector3d on_frame(const Linkage& linkage, const MechanismForces& forces, const std::vector<BodyMotion>& motion,
                         const Eigen::Ref<const Eigen::VectorXd>& applied) {
  std::complex<double> sum = forces.crank_pivot;
  double moment = forces.torque;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    std::complex<double> force = forces.dyads[d].ground;
    const BodyMotion& closing = motion[static_cast<std::size_t>(closing_index(static_cast<int>(d)))];
    if (std::holds_alternative<Slider>(linkage.dyads[d].closing)) force += applied(static_cast<Index>(d)) * closing.e;
    sum += force;
    moment += (std::conj(closing.z - linkage.crank.pivot) * force).imag();
  }
  return {-sum.real(), -sum.imag(), -moment};
}

Eigen::VectorXd slider_positions(const Linkage& linkage, const std::vector<BodyMotion>& motion) {
  std::vector<double> positions;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d)
    if (const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing)) {
      const BodyMotion& body = motion[static_cast<std::size_t>(closing_index(static_cast<int>(d)))];
      positions.push_back((std::conj(body.e) * (body.z - slider->guide)).real());
    }
  return Eigen::Map<const Eigen::VectorXd>(positions.data(), static_cast<Index>(positions.size()));
}

}  // namespace

ForceSamples exact_forces(const ExactModel& model, double speed, const CrankAngles& angles, const RitzSamples& motion) {
  const std::vector<JointRow> rows = joint_rows(model.linkage());
  const auto components = [](const JointRow& row) { return row.kind == JointRow::Kind::guide ? 1 : 2; };
  Index size = 1;
  for (const JointRow& row : rows) size += components(row);

  const ExactModel::Forces all = model.forces(speed, angles, motion);
  const Linkage& linkage = model.linkage();
  const Index sliders = std::ranges::count_if(
      linkage.dyads, [](const Dyad& dyad) { return std::holds_alternative<Slider>(dyad.closing); });
  ForceSamples samples{Eigen::MatrixXd(size, angles.size()), Eigen::Matrix3Xd(3, angles.size()),
                       Eigen::MatrixXd(sliders, angles.size()), all.breakdown};
  for (Index j = 0; j < angles.size(); ++j) {
    const auto angle = static_cast<std::size_t>(j);
    Index next = 0;
    for (const JointRow& row : rows) {
      const std::complex<double> force = resolved(row, all.forces[angle], all.motion[angle]);
      if (components(row) == 2) samples.values(next++, j) = force.real();
      samples.values(next++, j) = force.imag();
    }
    samples.values(next, j) = all.forces[angle].torque;
    samples.frame.col(j) = on_frame(linkage, all.forces[angle], all.motion[angle], angles.slider_forces.col(j));
    samples.sliders.col(j) = slider_positions(linkage, all.motion[angle]);
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
