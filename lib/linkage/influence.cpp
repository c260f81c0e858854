#include "lib/linkage/influence.hpp"

#include "lib/constants.hpp"
#include "lib/linkage/joint_rows.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

// Joints cancel in the sum over all bodies: what they ask of pivots, guides and motor is
//     G = sum of load,   M = sum of load.moment + (z - O) x load.force,
// a slider's applied force F, taken off its load there, being given back to the frame:  -(G + F),  -(M + (z - O) x F).
Eigen::Vector3d on_frame(const Linkage& linkage, const BodyMotion& motion, const BodyLoad& load) {
  const double moment = load.moment + (std::conj(motion.z - linkage.crank.pivot) * load.force).imag();
  return {-load.force.real(), -load.force.imag(), -moment};
}

Eigen::Vector3d on_frame(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                         const std::vector<BodyLoad>& loads, const Eigen::VectorXd& slider_forces) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t b = 0; b < loads.size(); ++b) sum += on_frame(linkage, motion[b], loads[b]);
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const std::size_t body = at(closing_index(static_cast<int>(d)));
    if (std::holds_alternative<Slider>(linkage.dyads[d].closing))
      sum += on_frame(linkage, motion[body], {slider_forces(static_cast<Eigen::Index>(d)) * motion[body].e, 0});
  }
  return sum;
}

// One crank angle after the other.
class Turn {
 public:
  explicit Turn(const Linkage& linkage)
      : linkage_(linkage),
        rows_(joint_rows(linkage)),
        no_slider_forces_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(linkage.dyads.size()))) {}

  Eigen::Index num_quantities() const { return 2 * static_cast<Eigen::Index>(rows_.size()) + 4; }

  void fill(Influence& table, Eigen::Index j) {
    const double tau = two_pi * static_cast<double>(j) / static_cast<double>(table.num_samples());
    motion_at(linkage_, tau, motion_);
    const Eigen::VectorXd slider_forces = slider_forces_at(linkage_, tau);
    rigid_loads(linkage_, motion_, slider_forces, powers_);
    for (std::size_t p = 0; p < powers_.size(); ++p) {
      auto quantities = table.rigid[p].col(j);
      quantities.tail<3>() = on_frame(linkage_, motion_, powers_[p], p == 0 ? slider_forces : no_slider_forces_);
      balance_joints(powers_[p], quantities);
    }
    for (Influence::Rod& rod : table.rods) {
      const BodyMotion& motion = motion_[at(rod.link)];
      rod.motion[static_cast<std::size_t>(j)] = rod_motion(motion);
      const BodyLoad of_one[] = {{motion.e, 0}, {Complex(0, 1) * motion.e, 0}, {0, 1}};
      for (std::size_t c = 0; c < rod.unit.size(); ++c) {
        auto quantities = rod.unit[c].col(j);
        quantities.tail<3>() = on_frame(linkage_, motion, of_one[c]);
        loads_.assign(motion_.size(), {});
        loads_[at(rod.link)] = of_one[c];
        balance_joints(loads_, quantities);
      }
    }
  }

 private:
  // All but those of the frame. Uses up `loads`.
  void balance_joints(std::vector<BodyLoad>& loads, Eigen::Ref<Eigen::VectorXd> quantities) {
    balance(linkage_, motion_, loads, forces_);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Complex f = resolved(rows_[i], forces_, motion_);
      quantities.segment<2>(2 * static_cast<Eigen::Index>(i)) << f.real(), f.imag();
    }
    quantities(2 * static_cast<Eigen::Index>(rows_.size())) = forces_.torque;
  }

  const Linkage& linkage_;
  std::vector<JointRow> rows_;
  Eigen::VectorXd no_slider_forces_;
  std::vector<BodyMotion> motion_;
  std::array<std::vector<BodyLoad>, 3> powers_;
  std::vector<BodyLoad> loads_;
  MechanismForces forces_;
};

// With the angles of `coarse`, if there are any.
Influence influence(const Linkage& linkage, Eigen::Index N, const Influence* coarse) {
  constexpr Eigen::Index often = 256;
  Turn turn(linkage);
  Influence table;
  const auto sized = [&](std::array<Eigen::MatrixXd, 3>& answers) {
    for (Eigen::MatrixXd& each : answers) each.resize(turn.num_quantities(), N);
  };
  sized(table.rigid);
  for (const int link : elastic_links(linkage)) {
    Influence::Rod& rod = table.rods.emplace_back();
    rod.link = link;
    rod.motion.resize(static_cast<std::size_t>(N));
    sized(rod.unit);
  }
  const Eigen::Index step = coarse != nullptr ? N / coarse->num_samples() : 0;
  for (Eigen::Index j = 0; j < N; ++j) {
    if (j % often == 0) end_if_wished();
    if (step == 0 || j % step != 0) {
      turn.fill(table, j);
      continue;
    }
    const Eigen::Index same = j / step;
    for (std::size_t p = 0; p < 3; ++p) table.rigid[p].col(j) = coarse->rigid[p].col(same);
    for (std::size_t r = 0; r < table.rods.size(); ++r) {
      table.rods[r].motion[static_cast<std::size_t>(j)] = coarse->rods[r].motion[static_cast<std::size_t>(same)];
      for (std::size_t c = 0; c < 3; ++c) table.rods[r].unit[c].col(j) = coarse->rods[r].unit[c].col(same);
    }
  }
  return table;
}

}  // namespace

std::shared_ptr<const Influence> InfluenceTable::at(Eigen::Index num_samples) const {
  const std::lock_guard lock(mutex_);
  if (!finest_ || finest_->num_samples() < num_samples)
    finest_ = std::make_shared<const Influence>(influence(linkage_, num_samples, finest_.get()));
  return finest_;
}

}  // namespace hb
