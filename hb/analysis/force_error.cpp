#include "hb/analysis/force_error.hpp"

#include <algorithm>

namespace hb {
namespace {

// Bound on the largest value over the turn of any component.
double bound(const FourierSeries& series) {
  double largest = 0;
  for (Eigen::Index c = 0; c < series.num_components(); ++c)
    largest = std::max(largest, fourier::wiener_norm(series, c));
  return largest;
}

// What better responses, with as many modes or more, add to the deflections.
std::vector<LinkResponse> changes(const std::vector<LinkResponse>& responses, const std::vector<LinkResponse>& better) {
  constexpr double small = 1e-10;  // harmonics that count for nothing, inertia with its k^2 included
  std::vector<LinkResponse> changes;
  for (std::size_t r = 0; r < responses.size(); ++r) {
    const FourierSeries &q = responses[r].q, &better_q = better[r].q;
    FourierSeries change = fourier::resized(better_q, std::max(q.num_harmonics(), better_q.num_harmonics()));
    change.c.topLeftCorner(q.c.rows(), q.c.cols()) -= q.c;
    changes.push_back({responses[r].link, fourier::resized(change, fourier::significant_harmonics(change, small))});
  }
  return changes;
}

// Forces are linear in the deflections.
LargestForces change(const InfluenceTable& influence, double speed, const std::vector<LinkResponse>& responses,
                     const std::vector<LinkResponse>& better) {
  constexpr double digits = 1e-5;  // enough of an estimate
  const JointForces added = deflection_forces(influence, speed, changes(responses, better), digits);
  LargestForces largest{0, bound(added.torque)};
  for (const JointForce& joint : added.joints) largest.force = std::max(largest.force, bound(joint.elastic));
  return largest;
}

// What the rods' deflection adds to the forces.
LargestForces elastic_part(const JointForces& forces) {
  LargestForces largest{0, bound(fourier::difference(forces.torque, forces.torque_rigid))};
  for (const JointForce& joint : forces.joints)
    largest.force = std::max(largest.force, bound(fourier::difference(joint.elastic, joint.rigid)));
  return largest;
}

// An error of q may stand in harmonics beyond its own H, up to N = 2 (H + 1) say, and forces weigh harmonic n by some
// 1 + n^2: what it counts for there,
//     (1 + N^2) sum |q_n| / sum (1 + n^2) |q_n|,     the largest of all rods.
double weight_beyond(const std::vector<LinkResponse>& responses) {
  double largest = 1;
  for (const LinkResponse& response : responses) {
    double sum = 0, weighed = 0;
    for (Eigen::Index n = 0; n <= response.q.num_harmonics(); ++n) {
      const double size = response.q.c.col(n).cwiseAbs().sum(), k = static_cast<double>(n);
      sum += size;
      weighed += (1 + k * k) * size;
    }
    const double N = 2 * static_cast<double>(response.q.num_harmonics() + 1);
    if (weighed > 0) largest = std::max(largest, (1 + N * N) * sum / weighed);
  }
  return largest;
}

double relative(double error, double size) { return error == 0 ? 0 : error / size; }

}  // namespace

LargestForces largest_of(const JointForces& forces) {
  LargestForces largest{0, fourier::max_abs(forces.torque, 0).value};
  for (const JointForce& joint : forces.joints)
    largest.force = std::max(largest.force, fourier::largest_values(joint.elastic).maxCoeff());
  return largest;
}

ForceErrors force_errors(const InfluenceTable& influence, double speed, const JointForces& forces,
                         const LargestForces& largest, double response_error,
                         const std::vector<LinkResponse>& responses, const std::vector<LinkResponse>& more_harmonics,
                         const std::vector<LinkResponse>& more_modes) {
  // A difference of two answers nearly as accurate as each other is about the error of the worse one.
  constexpr double safety = 2;
  const LargestForces elastic = elastic_part(forces);
  const double error = response_error * (more_harmonics.empty() ? safety * weight_beyond(responses) : 1);
  ForceErrors errors{forces.force_error + error * elastic.force, forces.torque_error + error * elastic.torque, 0, 0};
  if (!more_harmonics.empty()) {
    const LargestForces more = change(influence, speed, responses, more_harmonics);
    errors.force += safety * more.force;
    errors.torque += safety * more.torque;
  }
  if (!more_modes.empty()) {
    const LargestForces more = change(influence, speed, responses, more_modes);
    errors.force_cut = safety * more.force;
    errors.torque_cut = safety * more.torque;
  }
  return {relative(errors.force, largest.force), relative(errors.torque, largest.torque),
          relative(errors.force_cut, largest.force), relative(errors.torque_cut, largest.torque)};
}

}  // namespace hb
