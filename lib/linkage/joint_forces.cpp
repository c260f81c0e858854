#include "lib/linkage/joint_forces.hpp"

#include <algorithm>
#include <memory>

#include "lib/fourier/moduli.hpp"
#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/force_table.hpp"

namespace hb {

namespace {

using Eigen::Index;

// Next to a resonance rigid forces are rounding beside elastic ones, and yet known: they have a group of their own.
constexpr int rigid_group = 0, elastic_group = 1, torque_group = 2;

// Sum over both signs of the coefficients of one row beyond its length, twice. Of a row that has not decayed the last
// eighth stands for what is missing.
double left_out(const TurnSeries& turn, Eigen::Index row) {
  const Eigen::Index size = turn.series.c.cols();
  const Eigen::Index length = std::min(turn.length[static_cast<std::size_t>(row)], size - size / 8);
  return 4 * fourier::moduli(turn.series.c.row(row).tail(size - length)).sum();
}

// Of one row, as it stands in JointForces: a guide has its normal force alone.
Eigen::Index first_component(const JointRow& row) { return row.kind == JointRow::Kind::guide ? 1 : 0; }

TurnSamplingOptions sampling_options(const Linkage& linkage, const std::vector<LinkResponse>& responses,
                                     double tolerance) {
  Eigen::Index H = slider_force_harmonics(linkage);
  for (const LinkResponse& response : responses) H = std::max(H, response.q.num_harmonics());
  TurnSamplingOptions options{.tolerance = tolerance};
  while (options.first < 2 * H + 2) options.first *= 2;
  options.last = std::max(options.last, 2 * options.first);
  return options;
}

double longest_body(const Linkage& linkage) {
  double longest = 0;
  for (int i = 0; i < linkage.num_bodies(); ++i)
    if (const Body* body = body_at(linkage, i)) longest = std::max(longest, body->length);
  return longest;
}

// ForceTable's components at one speed.
class ForcesOverTurn {
 public:
  using Angles = ForceTable::Angles;

  ForcesOverTurn(const ForceTable& table, double speed, const std::vector<LinkResponse>& responses)
      : table_(table), speed_(speed), responses_(responses) {
    for (const LinkResponse& response : responses_)
      places_.push_back(
          static_cast<std::size_t>(std::ranges::find(table.links(), response.link) - table.links().begin()));
  }

  // take(j, at) for the samples that are asked for, at.rigid(i) and at.added(i) those of component i at tau_j,
  // tau_(j + step), ... side by side.
  template <class Take>
  void along(Index N, Index begin, Index step, const Take& take) {
    constexpr Index most_at_once = 2048;
    std::vector<Eigen::MatrixXd> deflections;
    for (const LinkResponse& response : responses_)
      deflections.push_back(deflection_samples(table_.linkage(), response, N));
    loads_.resize(responses_.size());
    for (Index first = begin; first < N; first += most_at_once * step) {
      const Index count = std::min(most_at_once, (N - first + step - 1) / step);
      const std::shared_ptr<const ForceTable::Turn> turn = table_.at(N, first, step, count);
      Index j = first;
      for (const ForceTable::Samples& samples : *turn) {
        for (std::size_t r = 0; r < responses_.size(); ++r)
          loads_[r] = load(samples.rods[places_[r]], responses_[r].link, deflections[r], j, step);
        take(j, At{*this, samples});
        j += ForceTable::together * step;
      }
    }
  }

 private:
  struct At {
    const ForcesOverTurn& of;
    const ForceTable::Samples& samples;

    Angles rigid(Index component) const {
      const auto i = static_cast<std::size_t>(component);
      return samples.rigid[0][i] + of.speed_ * (samples.rigid[1][i] + of.speed_ * samples.rigid[2][i]);
    }
    Angles added(Index component) const {
      Angles sum = Angles::Zero();
      for (std::size_t r = 0; r < of.loads_.size(); ++r) {
        const RodLoad<Angles>&unit = samples.rods[of.places_[r]].forces[static_cast<std::size_t>(component)],
              &load = of.loads_[r];
        sum += unit.along * load.along + unit.across * load.across + unit.moment * load.moment;
      }
      return sum;
    }
  };

  RodLoad<Angles> load(const ForceTable::Rod& rod, int link, const Eigen::MatrixXd& deflection, Index j,
                       Index step) const {
    DeflectionIntegrals<Angles> integrals;
    for (std::size_t i = 0; i < integrals.size(); ++i)
      for (Index k = 0; k < ForceTable::together; ++k)
        integrals[i](k) = deflection(static_cast<Index>(i), j + k * step);
    return deflection_load(*body_at(table_.linkage(), link), table_.linkage().gravity, speed_, rod.motion, integrals);
  }

  const ForceTable& table_;
  double speed_;
  const std::vector<LinkResponse>& responses_;
  std::vector<std::size_t> places_;  // of the responses' links in the table
  std::vector<RodLoad<Angles>> loads_;  // at the angles side by side
};

void put(const ForceTable::Angles& values, Index row, Index j, Index step, Eigen::MatrixXd& samples) {
  for (Index k = 0; k < ForceTable::together; ++k) samples(row, j + k * step) = values(k);
}

}  // namespace

// Sampled per crank angle: the rigid components of ForceTable, then the elastic ones.
JointForces joint_forces(const ForceTable& table, double speed, const std::vector<LinkResponse>& responses,
                         double tolerance) {
  const Linkage& linkage = table.linkage();
  const auto num_rows = static_cast<Index>(table.rows().size());
  const Index n = table.num_components(), torque = 2 * num_rows, frame = torque + 1;
  std::vector<TurnComponent> components;
  for (const int group : {rigid_group, elastic_group}) {
    components.insert(components.end(), table.rows().size() * 2, {group, 1});
    components.push_back({torque_group, 1});
    // Forces on the frame of a balanced linkage are what joint forces leave of each other.
    for (const double unit : {1.0, 1.0, 1 / longest_body(linkage)}) components.push_back({group, unit});
  }
  ForcesOverTurn forces(table, speed, responses);
  const auto fill = [&](Eigen::MatrixXd& samples, Index begin, Index step) {
    forces.along(samples.cols(), begin, step, [&](Index j, const auto& at) {
      for (Index i = 0; i < n; ++i) {
        const ForceTable::Angles rigid = at.rigid(i);
        put(rigid, i, j, step, samples);
        put(rigid + at.added(i), n + i, j, step, samples);
      }
    });
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(linkage, responses, tolerance));

  JointForces result;
  for (Index i = 0; i < num_rows; ++i) {
    const JointRow& row = table.rows()[static_cast<std::size_t>(i)];
    const Index skipped = first_component(row), first = 2 * i + skipped, count = 2 - skipped;
    result.joints.push_back({row.name, cut_rows(turn, first, count), cut_rows(turn, n + first, count)});
    for (Index c = first; c < first + count; ++c)
      result.force_error = std::max({result.force_error, left_out(turn, c), left_out(turn, n + c)});
  }
  result.torque_rigid = cut_rows(turn, torque, 1);
  result.torque = cut_rows(turn, n + torque, 1);
  result.frame = {cut_rows(turn, frame, 3), cut_rows(turn, n + frame, 3)};
  result.torque_error = std::max(left_out(turn, torque), left_out(turn, n + torque));
  return result;
}

JointForces joint_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses,
                         double tolerance) {
  return joint_forces(ForceTable(linkage), speed, responses, tolerance);
}

// Sampled per crank angle: what is added to the components of ForceTable, without those of the frame.
JointForces deflection_forces(const ForceTable& table, double speed, const std::vector<LinkResponse>& responses,
                              double tolerance) {
  const auto num_rows = static_cast<Index>(table.rows().size());
  const Index torque = 2 * num_rows;
  std::vector<TurnComponent> components(2 * table.rows().size(), TurnComponent{elastic_group, 1});
  components.push_back({torque_group, 1});
  ForcesOverTurn forces(table, speed, responses);
  const auto fill = [&](Eigen::MatrixXd& samples, Index begin, Index step) {
    forces.along(samples.cols(), begin, step, [&](Index j, const auto& at) {
      for (Index i = 0; i <= torque; ++i) put(at.added(i), i, j, step, samples);
    });
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(table.linkage(), responses, tolerance));

  JointForces result;
  for (Index i = 0; i < num_rows; ++i) {
    const JointRow& row = table.rows()[static_cast<std::size_t>(i)];
    const Index skipped = first_component(row);
    result.joints.push_back({row.name, {}, cut_rows(turn, 2 * i + skipped, 2 - skipped)});
  }
  result.torque = cut_rows(turn, torque, 1);
  return result;
}

}  // namespace hb
