#include "lib/linkage/joint_forces.hpp"

#include <algorithm>

#include "lib/fourier/moduli.hpp"
#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/balance.hpp"
#include "lib/linkage/influence.hpp"
#include "lib/linkage/joint_rows.hpp"

namespace hb {

namespace {

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

// Rows are those of Influence: at column j of what `add` gets, the responses' answers are added at tau_j, every
// `step`th from `begin`; of Influence the first so many quantities.
void add_deflections(const InfluenceTable& table, const Influence& influence, double speed,
                     const std::vector<LinkResponse>& responses, Eigen::Index begin, Eigen::Index step,
                     Eigen::Ref<Eigen::MatrixXd> quantities) {
  const Eigen::Index n = quantities.rows(), N = quantities.cols(), finer = influence.num_samples() / N;
  for (const LinkResponse& response : responses) {
    const Eigen::MatrixXd integrals = deflection_samples(table.linkage(), response, N);
    const Body& link = *body_at(table.linkage(), response.link);
    const auto& rod = *std::ranges::find(influence.rods, response.link, &Influence::Rod::link);
    for (Eigen::Index j = begin; j < N; j += step) {
      const Eigen::Index there = j * finer;
      const RodMotion& motion = rod.motion[static_cast<std::size_t>(there)];
      const Eigen::Vector3d load = deflection_load(link, table.linkage().gravity, motion, speed, integrals.col(j));
      quantities.col(j) += load(0) * rod.unit[0].col(there).head(n) + load(1) * rod.unit[1].col(there).head(n) +
                           load(2) * rod.unit[2].col(there).head(n);
    }
  }
}

}  // namespace

JointForces joint_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses,
                         double tolerance) {
  return joint_forces(InfluenceTable(linkage), speed, responses, tolerance);
}

// Sampled per crank angle: the quantities of Influence, rigid ones, then elastic ones.
JointForces joint_forces(const InfluenceTable& table, double speed, const std::vector<LinkResponse>& responses,
                         double tolerance) {
  const Linkage& linkage = table.linkage();
  const std::vector<JointRow> rows = joint_rows(linkage);
  const auto num_rows = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index torque = 2 * num_rows, frame = torque + 1, all = torque + 4;
  std::vector<TurnComponent> components;
  for (const int group : {rigid_group, elastic_group}) {
    components.insert(components.end(), 2 * rows.size(), {group, 1});
    components.push_back({torque_group, 1});
    // Forces on the frame of a balanced linkage are what joint forces leave of each other.
    for (const double unit : {1.0, 1.0, 1 / longest_body(linkage)}) components.push_back({group, unit});
  }

  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    const Eigen::Index N = samples.cols();
    const std::shared_ptr<const Influence> influence = table.at(N);
    const Eigen::Index finer = influence->num_samples() / N;
    const Eigen::MatrixXd slider_forces = slider_force_samples(linkage, N);
    const auto& rigid = influence->rigid;
    for (Eigen::Index j = begin; j < N; j += step) {
      const Eigen::Index there = j * finer;
      samples.col(j).head(all) = rigid[0].col(there) + speed * (rigid[1].col(there) + speed * rigid[2].col(there));
      for (const Influence::AppliedForce& applied : influence->applied)
        samples.col(j).head(all) += slider_forces(static_cast<Eigen::Index>(applied.dyad), j) * applied.unit.col(there);
      samples.col(j).tail(all) = samples.col(j).head(all);
    }
    add_deflections(table, *influence, speed, responses, begin, step, samples.bottomRows(all));
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(linkage, responses, tolerance));

  JointForces result;
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const JointRow& row = rows[static_cast<std::size_t>(i)];
    const Eigen::Index skipped = first_component(row), first = 2 * i + skipped, count = 2 - skipped;
    result.joints.push_back({row.name, cut_rows(turn, first, count), cut_rows(turn, all + first, count)});
    for (Eigen::Index c = first; c < first + count; ++c)
      result.force_error = std::max({result.force_error, left_out(turn, c), left_out(turn, all + c)});
  }
  result.torque_rigid = cut_rows(turn, torque, 1);
  result.torque = cut_rows(turn, all + torque, 1);
  result.frame = {cut_rows(turn, frame, 3), cut_rows(turn, all + frame, 3)};
  result.torque_error = std::max(left_out(turn, torque), left_out(turn, all + torque));
  return result;
}

// Sampled per crank angle: (x, y) of every row, then the torque.
JointForces deflection_forces(const InfluenceTable& table, double speed, const std::vector<LinkResponse>& responses,
                              double tolerance) {
  const std::vector<JointRow> rows = joint_rows(table.linkage());
  const auto torque = 2 * static_cast<Eigen::Index>(rows.size());
  std::vector<TurnComponent> components(2 * rows.size(), TurnComponent{elastic_group, 1});
  components.push_back({torque_group, 1});
  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    for (Eigen::Index j = begin; j < samples.cols(); j += step) samples.col(j).setZero();
    add_deflections(table, *table.at(samples.cols()), speed, responses, begin, step, samples);
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(table.linkage(), responses, tolerance));

  JointForces result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Index skipped = first_component(rows[i]);
    result.joints.push_back(
        {rows[i].name, {}, cut_rows(turn, 2 * static_cast<Eigen::Index>(i) + skipped, 2 - skipped)});
  }
  result.torque = cut_rows(turn, torque, 1);
  return result;
}

}  // namespace hb
