#include "lib/linkage/joint_forces.hpp"

#include <algorithm>
#include <numbers>

#include "lib/fourier/moduli.hpp"
#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/balance.hpp"
#include "lib/linkage/joint_rows.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

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

// Calls at(j) for those of the turn's samples that are asked for, with the motion at tau_j.
template <class At>
void along_turn(const Linkage& linkage, Eigen::Index N, Eigen::Index begin, Eigen::Index step,
                std::vector<BodyMotion>& motion, const At& at) {
  constexpr Eigen::Index often = 256;
  for (Eigen::Index j = begin; j < N; j += step) {
    if (j % often == begin) end_if_wished();
    motion_at(linkage, 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N), motion);
    at(j);
  }
}

void add_deflections(const Linkage& linkage, const std::vector<BodyMotion>& motion, double speed,
                     const std::vector<DeflectionSamples>& deflections, Eigen::Index j, std::vector<BodyLoad>& loads) {
  for (const DeflectionSamples& rod : deflections) {
    const BodyLoad added = deflection_load(linkage, motion, rod.link, speed, rod.integrals.col(j));
    loads[at(rod.link)].force += added.force;
    loads[at(rod.link)].moment += added.moment;
  }
}

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
      add(body, slider_forces(static_cast<Eigen::Index>(d)) * motion[body].e);
  }
  return {-force.real(), -force.imag(), -moment};
}

double longest_body(const Linkage& linkage) {
  double longest = 0;
  for (int i = 0; i < linkage.num_bodies(); ++i)
    if (const Body* body = body_at(linkage, i)) longest = std::max(longest, body->length);
  return longest;
}

}  // namespace

// Sampled per crank angle: rigid and elastic (x, y) of every row, rigid and elastic torque, both of the frame.
JointForces joint_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses,
                         double tolerance) {
  const std::vector<JointRow> rows = joint_rows(linkage);
  const auto num_rows = static_cast<Eigen::Index>(rows.size());
  std::vector<TurnComponent> components;
  for (Eigen::Index i = 0; i < num_rows; ++i)
    for (const int group : {rigid_group, rigid_group, elastic_group, elastic_group}) components.push_back({group, 1});
  components.insert(components.end(), 2, {torque_group, 1});
  // Forces on the frame of a balanced linkage are what joint forces leave of each other.
  for (const int group : {rigid_group, elastic_group})
    for (const double unit : {1.0, 1.0, 1 / longest_body(linkage)}) components.push_back({group, unit});

  std::vector<BodyMotion> motion;
  std::array<std::vector<BodyLoad>, 3> powers;
  std::vector<BodyLoad> rigid, elastic;
  MechanismForces forces_rigid, forces;
  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    const Eigen::MatrixXd slider_forces = slider_force_samples(linkage, samples.cols());
    const std::vector<DeflectionSamples> deflections = deflection_samples(linkage, responses, samples.cols());
    along_turn(linkage, samples.cols(), begin, step, motion, [&](Eigen::Index j) {
      rigid_loads(linkage, motion, slider_forces.col(j), powers);
      rigid.resize(motion.size());
      for (std::size_t b = 0; b < motion.size(); ++b)
        rigid[b] = {powers[0][b].force + speed * (powers[1][b].force + speed * powers[2][b].force),
                    powers[0][b].moment + speed * (powers[1][b].moment + speed * powers[2][b].moment)};
      elastic = rigid;
      auto frame = samples.col(j).tail<6>();
      frame.head<3>() = on_frame(linkage, motion, rigid, slider_forces.col(j));
      balance(linkage, motion, rigid, forces_rigid);
      if (!deflections.empty()) {
        add_deflections(linkage, motion, speed, deflections, j, elastic);
        frame.tail<3>() = on_frame(linkage, motion, elastic, slider_forces.col(j));
        balance(linkage, motion, elastic, forces);
      } else {
        frame.tail<3>() = frame.head<3>();
        forces = forces_rigid;
      }
      for (Eigen::Index i = 0; i < num_rows; ++i) {
        const JointRow& row = rows[static_cast<std::size_t>(i)];
        const Complex f_rigid = resolved(row, forces_rigid, motion), f = resolved(row, forces, motion);
        samples.col(j).segment<4>(4 * i) << f_rigid.real(), f_rigid.imag(), f.real(), f.imag();
      }
      samples.col(j).segment<2>(4 * num_rows) << forces_rigid.torque, forces.torque;
    });
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(linkage, responses, tolerance));

  JointForces result;
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const JointRow& row = rows[static_cast<std::size_t>(i)];
    const Eigen::Index skipped = first_component(row), first = 4 * i + skipped, count = 2 - skipped;
    result.joints.push_back({row.name, cut_rows(turn, first, count), cut_rows(turn, first + 2, count)});
    for (Eigen::Index c = 0; c < count; ++c)
      result.force_error = std::max({result.force_error, left_out(turn, first + c), left_out(turn, first + 2 + c)});
  }
  result.torque_rigid = cut_rows(turn, 4 * num_rows, 1);
  result.torque = cut_rows(turn, 4 * num_rows + 1, 1);
  result.frame = {cut_rows(turn, 4 * num_rows + 2, 3), cut_rows(turn, 4 * num_rows + 5, 3)};
  result.torque_error = std::max(left_out(turn, 4 * num_rows), left_out(turn, 4 * num_rows + 1));
  return result;
}

// Sampled per crank angle: (x, y) of every row, then the torque.
JointForces deflection_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses,
                              double tolerance) {
  const std::vector<JointRow> rows = joint_rows(linkage);
  const auto num_rows = static_cast<Eigen::Index>(rows.size());
  std::vector<TurnComponent> components(2 * rows.size(), TurnComponent{elastic_group, 1});
  components.push_back({torque_group, 1});

  std::vector<BodyMotion> motion;
  std::vector<BodyLoad> loads;
  MechanismForces forces;
  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    const std::vector<DeflectionSamples> deflections = deflection_samples(linkage, responses, samples.cols());
    along_turn(linkage, samples.cols(), begin, step, motion, [&](Eigen::Index j) {
      loads.assign(motion.size(), BodyLoad{});
      add_deflections(linkage, motion, speed, deflections, j, loads);
      balance(linkage, motion, loads, forces);
      for (Eigen::Index i = 0; i < num_rows; ++i) {
        const Complex f = resolved(rows[static_cast<std::size_t>(i)], forces, motion);
        samples.col(j).segment<2>(2 * i) << f.real(), f.imag();
      }
      samples(2 * num_rows, j) = forces.torque;
    });
  };
  const TurnSeries turn = sample_turn(components, fill, sampling_options(linkage, responses, tolerance));

  JointForces result;
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    const JointRow& row = rows[static_cast<std::size_t>(i)];
    const Eigen::Index skipped = first_component(row);
    result.joints.push_back({row.name, {}, cut_rows(turn, 2 * i + skipped, 2 - skipped)});
  }
  result.torque = cut_rows(turn, 2 * num_rows, 1);
  return result;
}

}  // namespace hb
