#include "lib/exact/exact_forces.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/lanes.hpp"
#include "lib/linkage/joint_rows.hpp"

namespace hb {

using Eigen::Index;

namespace {

using Mechanism = exact::BentMechanism<Lanes>;
using Vector = Plane<Lanes>;

// On the frame: pivots, guides and the motor as the bodies push back, and what applies the sliders' forces,
//     -(R + F),   -(T + sum (z - O) x (R_d + F_d)),   z the pivot or the slider's joint.
// `applied`: F by dyad.
template <class Applied>
std::array<Lanes, 3> on_frame(const Linkage& linkage, const Mechanism& mechanism, const Applied& applied) {
  const Vector pivot = exact::plane<Lanes>(linkage.crank.pivot);
  Vector sum = mechanism.crank_pivot;
  Lanes moment = mechanism.torque;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    Vector force = mechanism.forces[d].ground;
    const exact::BentMotion<Lanes>& closing =
        mechanism.motion[static_cast<std::size_t>(closing_index(static_cast<int>(d)))];
    if (std::holds_alternative<Slider>(linkage.dyads[d].closing))
      force = force + applied(static_cast<Index>(d)) * closing.e;
    sum = sum + force;
    moment += cross(closing.z - pivot, force);
  }
  return {-sum.x, -sum.y, -moment};
}

// Along its guide, from the guide's point.
Lanes slider_position(const Slider& slider, const exact::BentMotion<Lanes>& body) {
  return dot(body.e, body.z - exact::plane<Lanes>(slider.guide));
}

}  // namespace

ForceSamples exact_forces(const ExactModel& model, double speed, const CrankAngles& angles, const RitzSamples& motion) {
  const Linkage& linkage = model.linkage();
  const std::vector<JointRow> rows = joint_rows(linkage);
  const auto components = [](const JointRow& row) { return row.kind == JointRow::Kind::guide ? 1 : 2; };
  Index size = 1;
  for (const JointRow& row : rows) size += components(row);
  const Index sliders = std::ranges::count_if(
      linkage.dyads, [](const Dyad& dyad) { return std::holds_alternative<Slider>(dyad.closing); });
  ForceSamples samples{Eigen::MatrixXd(size, angles.size()), Eigen::Matrix3Xd(3, angles.size()),
                       Eigen::MatrixXd(sliders, angles.size()), std::nullopt};
  const auto visit = [&](Index first, Index count, const Mechanism& mechanism) {
    const auto put = [&](const Lanes& lanes, auto& to, Index row) {
      const Lanes::Values values = lanes.values();
      for (Index lane = 0; lane < count; ++lane) to(row, first + lane) = values[static_cast<std::size_t>(lane)];
    };
    Index next = 0;
    for (const JointRow& row : rows) {
      const Vector force = conj(mechanism.motion[static_cast<std::size_t>(row.frame)].e) *
                           force_of(row, mechanism.crank_pivot, mechanism.forces);
      if (components(row) == 2) put(force.x, samples.values, next++);
      put(force.y, samples.values, next++);
    }
    put(mechanism.torque, samples.values, next);
    const auto applied = [&](Index dyad) {
      return Lanes::of([&](Index lane) { return angles.slider_forces(dyad, first + std::min(lane, count - 1)); });
    };
    const std::array<Lanes, 3> frame = on_frame(linkage, mechanism, applied);
    for (Index i = 0; i < 3; ++i) put(frame[static_cast<std::size_t>(i)], samples.frame, i);
    next = 0;
    for (std::size_t d = 0; d < linkage.dyads.size(); ++d)
      if (const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing))
        put(slider_position(*slider, mechanism.motion[static_cast<std::size_t>(closing_index(static_cast<int>(d)))]),
            samples.sliders, next++);
  };
  samples.breakdown = model.visit_forces(speed, angles, motion, visit);
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
