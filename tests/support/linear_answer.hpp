// The linear answer of a linkage at one speed, and the motion without linearisation that lies next to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/constants.hpp"
#include "lib/exact/exact_forces.hpp"
#include "lib/rod/rod.hpp"

namespace hb {

struct LinearAnswer {
  ExactModel model;
  std::vector<HillSystem> systems;
  std::vector<FourierSeries> q;
  std::vector<LinkResponse> responses;

  std::vector<LinearRod> rods() const {
    std::vector<LinearRod> all;
    for (std::size_t r = 0; r < q.size(); ++r) all.push_back({&systems[r], &q[r]});
    return all;
  }
};

// The largest of all rods.
struct LinearGrowth {
  double rate = -HUGE_VAL, error = 0;
};

[[nodiscard]] inline LinearGrowth linear_growth(const LinearAnswer& answer, double speed) {
  LinearGrowth growth;
  for (const HillSystem& system : answer.systems) {
    const Stability stability = analyse_stability(system, speed);
    if (stability.growth_rate > growth.rate) growth.rate = stability.growth_rate;
    growth.error = std::max(growth.error, stability.growth_error);
  }
  return growth;
}

[[nodiscard]] inline LinearAnswer linear_answer(const Linkage& linkage, double speed, Eigen::Index num_modes) {
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  std::vector<ExactModel::Rod> rods;
  for (const int link : coefficients.links) rods.push_back({link, num_modes});
  LinearAnswer answer{ExactModel(linkage, rods), {}, {}, {}};
  for (std::size_t r = 0; r < rods.size(); ++r) {
    answer.systems.push_back(ritz_system(*body_at(linkage, rods[r].link), coefficients.rods[r], num_modes));
    answer.q.push_back(solve_steady_state(answer.systems[r], speed).q);
    answer.responses.push_back({rods[r].link, answer.q[r]});
  }
  return answer;
}

// What the motion without linearisation changes of the linear answer, relative to its largest: by rod max over i and t
// of |q_i|, max over x and t of |w|; any joint force's component, of the largest of all; the torque. And the change of
// the mean torque, and of the largest growth rate, per unit time, with its own error and that of the linear one.
struct TrueChanges {
  std::vector<double> q, deflection;
  double force = 0, torque = 0;
  double mean_torque = 0;  // as it is, of the linear mean
  double linear_mean = 0, largest_torque = 0;
  std::optional<double> growth;
  double growth_error = 0;
};

enum class Growth { left_out, wanted };

namespace linear_answer_detail {

[[nodiscard]] inline double largest_component(const FourierSeries& series, Eigen::Index first, Eigen::Index count) {
  double value = 0;
  for (Eigen::Index i = first; i < first + count; ++i) value = std::max(value, fourier::max_abs(series, i).value);
  return value;
}

// max |sum_i q_i sin(i pi x/l)| of the rows of one rod.
[[nodiscard]] inline double largest_w(const FourierSeries& q, Eigen::Index first, Eigen::Index count) {
  const Eigen::MatrixXd samples = fourier::synthesise(q, fourier::fast_length(16 * q.num_harmonics() + 16));
  double value = 0;
  for (int k = 1; k < 40; ++k) {
    Eigen::RowVectorXd w = Eigen::RowVectorXd::Zero(samples.cols());
    for (Eigen::Index i = 0; i < count; ++i) w += std::sin(double(i + 1) * k * pi / 40) * samples.row(first + i);
    value = std::max(value, w.cwiseAbs().maxCoeff());
  }
  return value;
}

inline void change_of_forces(const LinearAnswer& answer, double speed, const FourierSeries& q, TrueChanges& changes) {
  const JointForces linear = joint_forces(answer.model.linkage(), speed, answer.responses);
  Eigen::Index H = std::max(q.num_harmonics(), linear.torque.num_harmonics());
  for (const JointForce& joint : linear.joints) H = std::max(H, joint.elastic.num_harmonics());
  const CrankAngles angles(answer.model.linkage(), fourier::fast_length(4 * H + 4));
  const std::vector<FourierSeries> all{q};
  const Eigen::MatrixXd exact =
      exact_forces(answer.model, speed, angles, ritz_samples(all, speed, angles.size())).values;
  const Eigen::MatrixXd before = force_samples(linear, angles.size()), change = exact - before;
  const Eigen::Index last = before.rows() - 1;
  changes.force = change.topRows(last).cwiseAbs().maxCoeff() / before.topRows(last).cwiseAbs().maxCoeff();
  changes.largest_torque = before.row(last).cwiseAbs().maxCoeff();
  changes.torque = change.row(last).cwiseAbs().maxCoeff() / changes.largest_torque;
  changes.mean_torque = std::abs(change.row(last).mean());
  changes.linear_mean = before.row(last).mean();
}

}  // namespace linear_answer_detail

// Newton's method from the linear answer; empty where it finds no motion.
[[nodiscard]] inline std::optional<TrueChanges> true_changes(const LinearAnswer& answer, double speed,
                                                             Growth growth = Growth::left_out) {
  using Eigen::Index;
  using namespace linear_answer_detail;
  Index H = 0;
  for (const FourierSeries& q : answer.q) H = std::max(H, q.num_harmonics());
  FourierSeries start(answer.model.num_modes(), H);
  for (std::size_t r = 0; r < answer.q.size(); ++r)
    start.c.middleRows(answer.model.first_mode(r), answer.q[r].num_components()) = fourier::resized(answer.q[r], H).c;
  const NonlinearSystem system =
      exact_system(std::make_shared<const ExactModel>(answer.model.linkage(), answer.model.rods()));
  const PeriodicMotion motion = solve_periodic_motion(system, speed, start);
  if (motion.status != MotionStatus::converged) return std::nullopt;
  const Index longest = std::max(H, motion.q.num_harmonics());
  const FourierSeries change(fourier::resized(motion.q, longest).c - fourier::resized(start, longest).c);
  TrueChanges changes;
  for (std::size_t r = 0; r < answer.q.size(); ++r) {
    const Index first = answer.model.first_mode(r), count = answer.q[r].num_components();
    changes.q.push_back(largest_component(change, first, count) / largest_component(start, first, count));
    changes.deflection.push_back(largest_w(change, first, count) / largest_w(start, first, count));
  }
  change_of_forces(answer, speed, motion.q, changes);
  if (growth == Growth::left_out) return changes;
  const Stability found = motion_stability(system, motion);
  const LinearGrowth linear = linear_growth(answer, speed);
  if (found.verdict == Verdict::undecided && !std::isfinite(found.growth_error)) return changes;
  changes.growth = std::abs(found.growth_rate - linear.rate);
  changes.growth_error = found.growth_error + linear.error;
  return changes;
}

}  // namespace hb
