#include "lib/linkage/force_table.hpp"

#include <complex>
#include <numbers>
#include <utility>

#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Joints cancel in the sum over all bodies: what they ask of pivots, guides and motor is
//     G = sum of load,   M = sum of load.moment + (z - O) x load.force,
// a slider's applied force F, taken off its load there, being given back to the frame:  -(G + F),  -(M + (z - O) x F).
Eigen::Vector3d on_frame(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                         const std::vector<BodyLoad>& loads, const Eigen::Ref<const Eigen::VectorXd>& slider_forces) {
  Complex force = 0;
  double moment = 0;
  const auto add = [&](std::size_t body, Complex its) {
    force += its;
    moment += (std::conj(motion[body].z - linkage.crank.pivot) * its).imag();
  };
  for (std::size_t b = 0; b < loads.size(); ++b) {
    add(b, loads[b].force);
    moment += loads[b].moment;
  }
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const std::size_t body = at(closing_index(static_cast<int>(d)));
    if (std::holds_alternative<Slider>(linkage.dyads[d].closing))
      add(body, slider_forces(static_cast<Index>(d)) * motion[body].e);
  }
  return {-force.real(), -force.imag(), -moment};
}

// The components of loads at one crank angle.
class Balanced {
 public:
  Balanced(const Linkage& linkage, const std::vector<JointRow>& rows)
      : linkage_(linkage), rows_(rows), components_(2 * static_cast<Index>(rows.size()) + 4) {}

  // Uses up `loads`.
  const Eigen::VectorXd& operator()(const std::vector<BodyMotion>& motion, std::vector<BodyLoad>& loads,
                                    const Eigen::Ref<const Eigen::VectorXd>& slider_forces) {
    components_.tail<3>() = on_frame(linkage_, motion, loads, slider_forces);
    balance(linkage_, motion, loads, forces_);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Complex f = resolved(rows_[i], forces_, motion);
      components_.segment<2>(2 * static_cast<Index>(i)) << f.real(), f.imag();
    }
    components_(components_.size() - 4) = forces_.torque;
    return components_;
  }

 private:
  const Linkage& linkage_;
  const std::vector<JointRow>& rows_;
  MechanismForces forces_;
  Eigen::VectorXd components_;
};

}  // namespace

ForceTable::ForceTable(Linkage linkage)
    : linkage_(std::move(linkage)), rows_(joint_rows(linkage_)), links_(elastic_links(linkage_)) {}

std::shared_ptr<const ForceTable::Turn> ForceTable::at(Index N, Index begin, Index step, Index count) const {
  constexpr Index most_kept = 512;
  if (N > most_kept) return std::make_shared<const Turn>(sampled(N, begin, step, count));
  const std::lock_guard lock(mutex_);
  std::shared_ptr<const Turn>& turn = kept_[{N, begin, step}];
  if (!turn) turn = std::make_shared<const Turn>(sampled(N, begin, step, count));
  return turn;
}

ForceTable::Turn ForceTable::sampled(Index N, Index begin, Index step, Index count) const {
  const auto n = static_cast<std::size_t>(num_components());
  const Eigen::MatrixXd slider_forces = slider_force_samples(linkage_, N);
  const Eigen::VectorXd no_forces = Eigen::VectorXd::Zero(slider_forces.rows());
  Turn turn(static_cast<std::size_t>(count / together));
  for (Samples& samples : turn) {
    samples.rigid.fill(std::vector<Angles>(n));
    samples.rods.assign(links_.size(), {{}, std::vector<RodLoad<Angles>>(n)});
  }
  Balanced balanced(linkage_, rows_);
  std::vector<BodyMotion> motion;
  std::array<std::vector<BodyLoad>, 3> powers;
  std::vector<BodyLoad> loads;
  for (Index k = 0; k < count; ++k) {
    const Index lane = k % together, j = begin + k * step;
    if (lane == 0) end_if_wished();
    Samples& samples = turn[static_cast<std::size_t>(k / together)];
    motion_at(linkage_, 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N), motion);
    rigid_loads(linkage_, motion, slider_forces.col(j), powers);
    for (std::size_t p = 0; p < 3; ++p) {
      const Eigen::VectorXd& forces =
          balanced(motion, powers[p], p == 0 ? Eigen::VectorXd(slider_forces.col(j)) : no_forces);
      for (std::size_t i = 0; i < n; ++i) samples.rigid[p][i](lane) = forces(static_cast<Index>(i));
    }
    for (std::size_t r = 0; r < links_.size(); ++r) {
      const std::size_t link = hb::at(links_[r]);
      const Complex e = motion[link].e;
      Rod& rod = samples.rods[r];
      const auto of_load = [&](const BodyLoad& load, Angles RodLoad<Angles>::*part) {
        loads.assign(motion.size(), BodyLoad{});
        loads[link] = load;
        const Eigen::VectorXd& forces = balanced(motion, loads, no_forces);
        for (std::size_t i = 0; i < n; ++i) (rod.forces[i].*part)(lane) = forces(static_cast<Index>(i));
      };
      of_load({e, 0}, &RodLoad<Angles>::along);
      of_load({e * Complex(0, 1), 0}, &RodLoad<Angles>::across);
      of_load({0, 1}, &RodLoad<Angles>::moment);
      const RodMotion<double> its = rod_motion(motion[link]);
      rod.motion.phi1(lane) = its.phi1;
      rod.motion.phi2(lane) = its.phi2;
      rod.motion.e_y(lane) = its.e_y;
      rod.motion.v_x(lane) = its.v_x;
      rod.motion.a_x(lane) = its.a_x;
    }
  }
  return turn;
}

}  // namespace hb
