#include "lib/exact/exact_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/exact/bent_rod.hpp"
#include "lib/exact/rod_quadrature.hpp"
#include "lib/stop_wish.hpp"
#include "lib/workspace.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using exact::BentRod;
using exact::RodDerivatives;
using exact::RodSurroundings;

struct ExactModel::Impl {
  Linkage linkage;
  std::vector<Rod> rods;
  std::vector<Index> first;  // rows of each rod's first mode; behind them the number of all
  std::vector<int> rod_of;  // by body
  std::vector<RodQuadrature> rules;
  std::vector<exact::RodConstants> constants;

  Index num_modes() const { return first.back(); }
};

namespace {

std::vector<BentRod> bent_rods(const ExactModel::Impl& model, const RitzSamples& motion) {
  std::vector<BentRod> rods;
  rods.reserve(model.rods.size());
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    const Index first = model.first[r], count = model.rods[r].num_modes;
    rods.emplace_back(model.rules[r], model.constants[r], motion.q.middleRows(first, count),
                      motion.q1.middleRows(first, count), motion.q2.middleRows(first, count));
  }
  return rods;
}

void check_shapes(const ExactModel::Impl& model, const CrankAngles& angles, const RitzSamples& motion) {
  for (const MatrixXd* samples : {&motion.q, &motion.q1, &motion.q2})
    if (samples->rows() != model.num_modes() || samples->cols() != angles.size())
      throw std::invalid_argument(fmt::format("exact model: samples are {} x {}, must be {} x {}", samples->rows(),
                                              samples->cols(), model.num_modes(), angles.size()));
}

// First angle at which a rod is too steep.
std::optional<ExactBreakdown> folded(const ExactModel::Impl& model, const std::vector<BentRod>& rods,
                                     const CrankAngles& angles) {
  for (Index j = 0; j < angles.size(); ++j)
    for (std::size_t r = 0; r < rods.size(); ++r)
      if (const double slope = rods[r].steepest()(j); !(slope < 1))
        return ExactBreakdown{ExactBreakdown::Kind::slope, model.rods[r].link, angles.tau(j), slope};
  return std::nullopt;
}

template <class T>
std::optional<ExactBreakdown> opened(const exact::BentMechanism<T>& mechanism, double crank_angle) {
  for (std::size_t body = 1; body < mechanism.motion.size(); body += 2)
    if (!std::isfinite(value_of(norm(mechanism.motion[body].e))))
      return ExactBreakdown{ExactBreakdown::Kind::open, static_cast<int>(body), crank_angle, 0};
  return std::nullopt;
}

// The whole mechanism at one angle: motion, loads, joint forces.
template <class T>
void solve(const ExactModel::Impl& model, const CrankAngles& angles, Index angle, const T& speed,
           exact::BentMechanism<T>& mechanism) {
  exact::move(model.linkage, model.rod_of, angles.direction(angle), speed, mechanism);
  exact::load(model.linkage, model.rod_of, model.constants, angles.slider_forces.col(angle), mechanism);
  exact::balance(model.linkage, model.rod_of, mechanism);
}

void place_rods(const std::vector<BentRod>& rods, Index angle, exact::BentMechanism<double>& mechanism) {
  mechanism.rods.resize(rods.size());
  for (std::size_t r = 0; r < rods.size(); ++r) {
    mechanism.rods[r].chord = rods[r].chord(angle);
    mechanism.rods[r].shape = rods[r].shape(angle);
  }
}

std::vector<RodSurroundings> surroundings(const ExactModel::Impl& model, const std::vector<BentRod>& rods,
                                          const CrankAngles& angles, double speed,
                                          std::optional<ExactBreakdown>& breakdown) {
  std::vector<RodSurroundings> result(rods.size());
  for (RodSurroundings& at : result) {
    at.base.resize(6, angles.size());
    at.axial_force.resize(angles.size());
  }
  exact::BentMechanism<double> mechanism;
  for (Index j = 0; j < angles.size(); ++j) {
    place_rods(rods, j, mechanism);
    solve(model, angles, j, speed, mechanism);
    if (!breakdown) breakdown = opened(mechanism, angles.tau(j));
    for (std::size_t r = 0; r < rods.size(); ++r) {
      const exact::BaseMotion<double>& b = mechanism.rods[r].base;
      result[r].base.col(j) << b.v_x, b.v_y, b.a_x, b.a_y, b.phi1, b.phi2;
      result[r].axial_force(j) = mechanism.rods[r].axial_force;
    }
  }
  return result;
}

// Directions of Dual when rod s is varied: its chord with two rates, then its load along, across, moment; the speed.
constexpr Index chord_direction = 0, load_direction = 3, speed_direction = 6;

constexpr Index axial_force_answer = 6;

// What the answers of rod r, base motion and X, do when the chord and the load of rod s change, and with the speed.
using Influence = Eigen::Matrix<double, 7, 7>;

class Influences {
 public:
  Influences(const ExactModel::Impl& model, const std::vector<BentRod>& rods, const CrankAngles& angles, double speed)
      : rods_(static_cast<Index>(rods.size())),
        all_(kept().matrix(Influence::SizeAtCompileTime, rods_ * rods_ * angles.size())) {
    exact::BentMechanism<Dual> mechanism;
    mechanism.rods.resize(rods.size());
    for (Index j = 0; j < angles.size(); ++j)
      for (std::size_t s = 0; s < rods.size(); ++s) {
        for (std::size_t r = 0; r < rods.size(); ++r) place(rods[r], j, mechanism.rods[r], r == s);
        solve(model, angles, j, varied(speed, speed_direction, true), mechanism);
        for (std::size_t r = 0; r < rods.size(); ++r)
          read(mechanism.rods[r], Eigen::Map<Influence>(all_.col(index(j, r, s)).data()));
      }
  }

  Eigen::Map<const Influence> operator()(Index angle, std::size_t r, std::size_t s) const {
    return Eigen::Map<const Influence>(all_.col(index(angle, r, s)).data());
  }

 private:
  // A thread has one of them at a time.
  static Workspace& kept() {
    thread_local Workspace workspace;
    return workspace;
  }

  static Dual varied(double value, Index direction, bool yes) {
    Dual dual(value);
    if (yes) dual.slope(direction) = 1;
    return dual;
  }

  static void place(const BentRod& rod, Index angle, exact::RodState<Dual>& state, bool yes) {
    const exact::Chord<double> chord = rod.chord(angle);
    state.chord = {varied(chord.c, chord_direction, yes), varied(chord.c1, chord_direction + 1, yes),
                   varied(chord.c2, chord_direction + 2, yes)};
    state.shape = rod.shape(angle);
    state.added_force = {varied(0, load_direction, yes), varied(0, load_direction + 1, yes)};
    state.added_moment = varied(0, load_direction + 2, yes);
  }

  static void read(const exact::RodState<Dual>& state, Eigen::Map<Influence> out) {
    const exact::BaseMotion<Dual>& b = state.base;
    Index row = 0;
    for (const Dual* answer : {&b.v_x, &b.v_y, &b.a_x, &b.a_y, &b.phi1, &b.phi2, &state.axial_force})
      out.row(row++) = answer->slope.head<7>().transpose();
  }

  Index index(Index angle, std::size_t r, std::size_t s) const {
    return (angle * rods_ + static_cast<Index>(r)) * rods_ + static_cast<Index>(s);
  }

  Index rods_;
  Eigen::Map<Eigen::MatrixXd> all_;  // a column each
};

// dr/dq of rod r by rod s: its own part, then through base motion b and axial force X of the mechanism,
//     dr_r/dz_s += G_r [ d(b, X)_r/d(c, c', c'')_s  d(c, c', c'')_s/dz_s + d(b, X)_r/d(load)_s  d(load)_s/dz_s ],
// G_r = dr_r/d(b, X)_r; z = q, q', q''.
void assemble(const ExactModel::Impl& model, const std::vector<RodDerivatives>& own, const Influences& influences,
              Index num_angles, ExactResidual& out) {
  const Index n = model.num_modes();
  const std::array<MatrixXd*, 3> by = {&out.by_q, &out.by_q1, &out.by_q2};
  for (MatrixXd* matrix : by) matrix->resize(n * n, num_angles);
  out.by_speed.resize(n, num_angles);
  for (std::size_t s = 0; s < own.size(); ++s) {
    const Index first_s = model.first[s], I_s = model.rods[s].num_modes;
    // Rows: c, c', c'', F_x, F_y, moment of rod s; by q, q', q''.
    std::array<MatrixXd, 3> cause;
    for (MatrixXd& matrix : cause) matrix = MatrixXd::Zero(6, I_s);
    MatrixXd through;
    Eigen::MatrixXd effect;
    for (Index j = 0; j < num_angles; ++j) {
      const auto& chord = own[s].chord;
      cause[0].row(0) = cause[1].row(1) = cause[2].row(2) = chord[0].col(j).transpose();
      cause[0].row(1) = chord[1].col(j).transpose();
      cause[1].row(2) = 2 * chord[1].col(j).transpose();
      cause[0].row(2) = chord[2].col(j).transpose();
      for (std::size_t z = 0; z < 3; ++z)
        for (Index k = 0; k < 3; ++k)
          cause[z].row(3 + k) = own[s].load[static_cast<std::size_t>(k)][z].col(j).transpose();
      for (std::size_t r = 0; r < own.size(); ++r) {
        const Index first_r = model.first[r], I_r = model.rods[r].num_modes;
        effect.resize(I_r, 7);
        for (Index k = 0; k < 6; ++k) effect.col(k) = own[r].by_base[static_cast<std::size_t>(k)].col(j);
        effect.col(6) = own[r].by_axial_force.col(j);
        through.noalias() = effect.lazyProduct(influences(j, r, s));
        if (s == 0) out.by_speed.col(j).segment(first_r, I_r) = through.col(speed_direction);
        for (std::size_t z = 0; z < 3; ++z) {
          Eigen::Map<MatrixXd> whole(by[z]->col(j).data(), n, n);
          auto block = whole.block(first_r, first_s, I_r, I_s);
          block.noalias() = through.leftCols<6>().lazyProduct(cause[z]);
          if (r == s) block += Eigen::Map<const MatrixXd>(own[r].residual[z].col(j).data(), I_r, I_r);
        }
      }
    }
  }
}

ExactResidual evaluate(const ExactModel::Impl& model, double speed, const CrankAngles& angles,
                       const RitzSamples& motion, bool derivatives) {
  const std::vector<BentRod> rods = bent_rods(model, motion);
  ExactResidual result;
  result.breakdown = folded(model, rods, angles);
  const std::vector<RodSurroundings> at = surroundings(model, rods, angles, speed, result.breakdown);
  result.r.resize(model.num_modes(), angles.size());
  for (std::size_t r = 0; r < rods.size(); ++r)
    result.r.middleRows(model.first[r], model.rods[r].num_modes) = rods[r].residual(at[r]);
  if (!derivatives) return result;

  std::vector<RodDerivatives> own;
  for (std::size_t r = 0; r < rods.size(); ++r) own.push_back(rods[r].derivatives(at[r]));
  assemble(model, own, Influences(model, rods, angles, speed), angles.size(), result);
  return result;
}

std::complex<double> number(const Plane<double>& z) { return {z.x, z.y}; }

}  // namespace

CrankAngles::CrankAngles(const Linkage& linkage, Eigen::VectorXd crank_angles)
    : tau(std::move(crank_angles)),
      direction(tau.size()),
      slider_forces(MatrixXd::Zero(static_cast<Index>(linkage.dyads.size()), tau.size())) {
  for (Index j = 0; j < tau.size(); ++j) direction(j) = std::polar(1.0, tau(j));
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d)
    if (const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing); slider && slider->force.c.size() > 0)
      for (Index j = 0; j < tau.size(); ++j)
        slider_forces(static_cast<Index>(d), j) = fourier::evaluate(slider->force, tau(j))(0);
}

CrankAngles::CrankAngles(const Linkage& linkage, Index num_samples, int num_turns)
    : CrankAngles(
          linkage,
          Eigen::VectorXd(
              Eigen::VectorXd::LinSpaced(num_samples + 1, 0, 2 * std::numbers::pi * num_turns).head(num_samples))) {}

CrankAngles CrankAngles::part(Index begin, Index count) const {
  CrankAngles angles;
  angles.tau = tau.segment(begin, count);
  angles.direction = direction.segment(begin, count);
  angles.slider_forces = slider_forces.middleCols(begin, count);
  return angles;
}

ExactModel::ExactModel(Linkage linkage, std::vector<Rod> rods, Index num_points) {
  auto impl = std::make_unique<Impl>();
  std::vector<int> links;
  for (const Rod& rod : rods) links.push_back(rod.link);
  if (links != elastic_links(linkage))
    throw std::invalid_argument("exact model: the rods must be all elastic links in the linkage's order");
  impl->rod_of.assign(static_cast<std::size_t>(linkage.num_bodies()), -1);
  impl->first.push_back(0);
  for (std::size_t r = 0; r < rods.size(); ++r) {
    if (rods[r].num_modes < 1) throw std::invalid_argument("exact model: a rod without modes");
    const Body& body = *body_at(linkage, rods[r].link);
    impl->rod_of[static_cast<std::size_t>(rods[r].link)] = static_cast<int>(r);
    impl->first.push_back(impl->first.back() + rods[r].num_modes);
    impl->rules.emplace_back(body.length, rods[r].num_modes, num_points);
    impl->constants.push_back(exact::constants_of(body));
  }
  impl->linkage = std::move(linkage);
  impl->rods = std::move(rods);
  impl_ = std::move(impl);
}

ExactModel::~ExactModel() = default;
ExactModel::ExactModel(ExactModel&&) noexcept = default;
ExactModel& ExactModel::operator=(ExactModel&&) noexcept = default;

const Linkage& ExactModel::linkage() const { return impl_->linkage; }
const std::vector<ExactModel::Rod>& ExactModel::rods() const { return impl_->rods; }
Index ExactModel::num_modes() const { return impl_->num_modes(); }
Index ExactModel::first_mode(std::size_t rod) const { return impl_->first[rod]; }
double ExactModel::force_per_residual(std::size_t rod) const {
  return impl_->constants[rod].bending * impl_->constants[rod].length / 2;
}

double ExactModel::driven_mass(std::size_t rod) const {
  constexpr Index num_angles = 64;
  const CrankAngles angles(linkage(), num_angles);
  const MatrixXd zero = MatrixXd::Zero(num_modes(), num_angles);
  const std::vector<BentRod> rods = bent_rods(*impl_, {zero, zero, zero});
  const Influences influences(*impl_, rods, angles, 1);
  double mass = 0;
  for (Index j = 0; j < num_angles; ++j)
    mass = std::max(mass, std::abs(influences(j, rod, rod)(axial_force_answer, chord_direction + 2)));
  return mass;
}

// Blocks of angles whose arrays stay in the cache.
ExactResidual ExactModel::residual(double speed, const CrankAngles& angles, const RitzSamples& motion,
                                   bool derivatives) const {
  check_shapes(*impl_, angles, motion);
  constexpr Index most = 64;
  const Index n = num_modes(), N = angles.size();
  ExactResidual result;
  result.r.resize(n, N);
  if (derivatives) {
    result.by_speed.resize(n, N);
    for (MatrixXd* by : {&result.by_q, &result.by_q1, &result.by_q2}) by->resize(n * n, N);
  }
  for (Index begin = 0; begin < N; begin += most) {
    end_if_wished();
    const Index count = std::min(most, N - begin);
    const CrankAngles part = angles.part(begin, count);
    const auto columns = [&](const MatrixXd& all) { return all.middleCols(begin, count); };
    const ExactResidual block =
        evaluate(*impl_, speed, part, {columns(motion.q), columns(motion.q1), columns(motion.q2)}, derivatives);
    result.r.middleCols(begin, count) = block.r;
    if (!result.breakdown) result.breakdown = block.breakdown;
    if (!derivatives) continue;
    result.by_speed.middleCols(begin, count) = block.by_speed;
    result.by_q.middleCols(begin, count) = block.by_q;
    result.by_q1.middleCols(begin, count) = block.by_q1;
    result.by_q2.middleCols(begin, count) = block.by_q2;
  }
  return result;
}

ExactModel::Forces ExactModel::forces(double speed, const CrankAngles& angles, const RitzSamples& motion) const {
  check_shapes(*impl_, angles, motion);
  const std::vector<BentRod> rods = bent_rods(*impl_, motion);
  Forces result;
  result.breakdown = folded(*impl_, rods, angles);
  exact::BentMechanism<double> mechanism;
  for (Index j = 0; j < angles.size(); ++j) {
    place_rods(rods, j, mechanism);
    solve(*impl_, angles, j, speed, mechanism);
    if (!result.breakdown) result.breakdown = opened(mechanism, angles.tau(j));
    MechanismForces& forces = result.forces.emplace_back();
    for (const exact::BentDyadForces<double>& dyad : mechanism.forces)
      forces.dyads.push_back({number(dyad.joint0), number(dyad.joint1), number(dyad.ground)});
    forces.crank_pivot = number(mechanism.crank_pivot);
    forces.torque = mechanism.torque;
    std::vector<BodyMotion>& bodies = result.motion.emplace_back();
    for (const exact::BentMotion<double>& m : mechanism.motion)
      bodies.push_back({number(m.z), number(m.z1), number(m.z2), number(m.e), m.phi1, m.phi2});
  }
  return result;
}

RitzSamples ritz_samples(std::span<const FourierSeries> q, double speed, Index num_samples, int num_turns) {
  Index n = 0;
  for (const FourierSeries& series : q) n += series.num_components();
  RitzSamples samples{MatrixXd(n, num_samples), MatrixXd(n, num_samples), MatrixXd(n, num_samples)};
  const double Omega = speed / num_turns;
  Index row = 0;
  for (const FourierSeries& series : q) {
    const Index I = series.num_components();
    samples.q.middleRows(row, I) = fourier::synthesise(series, num_samples);
    samples.q1.middleRows(row, I) = Omega * fourier::synthesise(fourier::derivative(series), num_samples);
    samples.q2.middleRows(row, I) = Omega * Omega * fourier::synthesise(fourier::derivative(series, 2), num_samples);
    row += I;
  }
  return samples;
}

std::string describe(const ExactBreakdown& breakdown, const Linkage& linkage) {
  const double turn = breakdown.crank_angle * 180 / std::numbers::pi;
  if (breakdown.kind == ExactBreakdown::Kind::slope)
    return fmt::format("{} is bent to a slope of {:.3g} at crank angle {:.4g} deg; at 1 it stands across its chord",
                       body_name(linkage, breakdown.body), breakdown.slope, turn);
  return fmt::format("the dyad of {} and {} does not close with its links bent, at crank angle {:.4g} deg",
                     body_name(linkage, breakdown.body), body_name(linkage, breakdown.body + 1), turn);
}

}  // namespace hb
