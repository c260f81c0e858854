// The linear answer of a linkage at one speed, and the motion without linearisation that lies next to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "hb/engine/steady/steady_state.hpp"
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

// By rod: max over i and t of |q_i of the motion without linearisation - q_i| over max over i and t of |q_i|. Newton's
// method from the linear answer; empty where it finds no motion.
[[nodiscard]] inline std::optional<std::vector<double>> true_changes(const LinearAnswer& answer, double speed) {
  using Eigen::Index;
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
  const auto largest = [](const FourierSeries& series, Index first, Index count) {
    double value = 0;
    for (Index i = first; i < first + count; ++i) value = std::max(value, fourier::max_abs(series, i).value);
    return value;
  };
  std::vector<double> changes;
  for (std::size_t r = 0; r < answer.q.size(); ++r) {
    const Index first = answer.model.first_mode(r), count = answer.q[r].num_components();
    changes.push_back(largest(change, first, count) / largest(start, first, count));
  }
  return changes;
}

}  // namespace hb
