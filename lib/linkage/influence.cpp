#include "lib/linkage/influence.hpp"

#include <cassert>

#include "lib/constants.hpp"
#include "lib/linkage/joint_rows.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

// Joints cancel in the sum over all bodies: what a load asks of pivots, guides and motor they take from the frame,
//     -load.force,   -(load.moment + (z - O) x load.force).
Eigen::Vector3d on_frame(const Linkage& linkage, const BodyMotion& motion, const BodyLoad& load) {
  const double moment = load.moment + (std::conj(motion.z - linkage.crank.pivot) * load.force).imag();
  return {-load.force.real(), -load.force.imag(), -moment};
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
    motion_at(linkage_, two_pi * static_cast<double>(j) / static_cast<double>(table.num_samples()), motion_);
    rigid_loads(linkage_, motion_, no_slider_forces_, powers_);
    for (std::size_t p = 0; p < powers_.size(); ++p) {
      auto quantities = table.rigid[p].col(j);
      quantities.tail<3>().setZero();
      for (std::size_t b = 0; b < motion_.size(); ++b)
        quantities.tail<3>() += on_frame(linkage_, motion_[b], powers_[p][b]);
      balance_joints(powers_[p], quantities);
    }
    // What applies the force stands on the frame, too.
    for (Influence::AppliedForce& applied : table.applied) {
      const int slider = closing_index(static_cast<int>(applied.dyad));
      balance_joints(alone(slider, {-motion_[at(slider)].e, 0}), applied.unit.col(j));
      applied.unit.col(j).tail<3>().setZero();
    }
    for (Influence::Rod& rod : table.rods) {
      const BodyMotion& motion = motion_[at(rod.link)];
      rod.motion[static_cast<std::size_t>(j)] = rod_motion(motion);
      const BodyLoad of_one[] = {{motion.e, 0}, {Complex(0, 1) * motion.e, 0}, {0, 1}};
      for (std::size_t c = 0; c < rod.unit.size(); ++c) {
        balance_joints(alone(rod.link, of_one[c]), rod.unit[c].col(j));
        rod.unit[c].col(j).tail<3>() = on_frame(linkage_, motion, of_one[c]);
      }
    }
  }

 private:
  // Until the next.
  std::vector<BodyLoad>& alone(int body, const BodyLoad& load) {
    loads_.assign(motion_.size(), {});
    loads_[at(body)] = load;
    return loads_;
  }

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
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing);
    if (slider && slider->force.c.size() > 0) table.applied.push_back({d, Eigen::MatrixXd(turn.num_quantities(), N)});
  }
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
    for (std::size_t a = 0; a < table.applied.size(); ++a)
      table.applied[a].unit.col(j) = coarse->applied[a].unit.col(same);
    for (std::size_t r = 0; r < table.rods.size(); ++r) {
      table.rods[r].motion[static_cast<std::size_t>(j)] = coarse->rods[r].motion[static_cast<std::size_t>(same)];
      for (std::size_t c = 0; c < 3; ++c) table.rods[r].unit[c].col(j) = coarse->rods[r].unit[c].col(same);
    }
  }
  return table;
}

}  // namespace

std::shared_ptr<const Influence> InfluenceTable::at(Eigen::Index num_samples) const {
  assert(num_samples > 0 && (num_samples & (num_samples - 1)) == 0);
  const std::lock_guard lock(mutex_);
  if (!finest_ || finest_->num_samples() < num_samples)
    finest_ = std::make_shared<const Influence>(influence(linkage_, num_samples, finest_.get()));
  return finest_;
}

}  // namespace hb
