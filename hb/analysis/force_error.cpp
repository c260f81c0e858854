#include "hb/analysis/force_error.hpp"

#include <algorithm>

namespace hb {
namespace {

// Largest value over the turn of any component of any joint force, and of the torque.
struct Largest {
  double force = 0, torque = 0;
};

// Bound on the largest value over the turn of a difference.
double difference(const FourierSeries& a, const FourierSeries& b) {
  const FourierSeries series = fourier::difference(a, b);
  double largest = 0;
  for (Eigen::Index c = 0; c < series.num_components(); ++c)
    largest = std::max(largest, fourier::wiener_norm(series, c));
  return largest;
}

Largest difference(const JointForces& a, const JointForces& b) {
  Largest largest{0, difference(a.torque, b.torque)};
  for (std::size_t j = 0; j < a.joints.size(); ++j)
    largest.force = std::max(largest.force, difference(a.joints[j].elastic, b.joints[j].elastic));
  return largest;
}

Largest sizes(const JointForces& forces) {
  Largest largest{0, fourier::max_abs(forces.torque, 0).value};
  for (const JointForce& joint : forces.joints)
    for (Eigen::Index c = 0; c < joint.elastic.num_components(); ++c)
      largest.force = std::max(largest.force, fourier::max_abs(joint.elastic, c).value);
  return largest;
}

// What the rods' deflection adds to the forces.
Largest elastic_part(const JointForces& forces) {
  Largest largest{0, difference(forces.torque, forces.torque_rigid)};
  for (const JointForce& joint : forces.joints)
    largest.force = std::max(largest.force, difference(joint.elastic, joint.rigid));
  return largest;
}

double relative(double error, double size) { return error == 0 ? 0 : error / size; }

}  // namespace

ForceErrors force_errors(const Linkage& linkage, double speed, const JointForces& forces, double response_error,
                         const std::vector<LinkResponse>& more_harmonics, const std::vector<LinkResponse>& more_modes) {
  // A difference of two answers nearly as accurate as each other is about the error of the worse one.
  constexpr double safety = 2;
  const Largest size = sizes(forces);
  const Largest elastic = elastic_part(forces);
  ForceErrors errors{forces.force_error + response_error * elastic.force,
                     forces.torque_error + response_error * elastic.torque, 0, 0};
  if (!more_harmonics.empty()) {
    const Largest change = difference(forces, joint_forces(linkage, speed, more_harmonics));
    errors.force += safety * change.force;
    errors.torque += safety * change.torque;
  }
  if (!more_modes.empty()) {
    const Largest change = difference(forces, joint_forces(linkage, speed, more_modes));
    errors.force_cut = safety * change.force;
    errors.torque_cut = safety * change.torque;
  }
  return {relative(errors.force, size.force), relative(errors.torque, size.torque),
          relative(errors.force_cut, size.force), relative(errors.torque_cut, size.torque)};
}

}  // namespace hb
