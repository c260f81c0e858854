#include "lib/exact/exact_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/exact/bent_rod.hpp"
#include "lib/exact/chord_variation.hpp"
#include "lib/exact/rod_quadrature.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using exact::BentRod;
using exact::RodDerivatives;

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

void check_shapes(const ExactModel::Impl& model, const CrankAngles& angles, const RitzSamples& motion) {
  for (const MatrixXd* samples : {&motion.q, &motion.q1, &motion.q2})
    if (samples->rows() != model.num_modes() || samples->cols() != angles.size())
      throw std::invalid_argument(fmt::format("exact model: samples are {} x {}, must be {} x {}", samples->rows(),
                                              samples->cols(), model.num_modes(), angles.size()));
}

double in(const Lanes& lanes, Index lane) { return lanes.values()[static_cast<std::size_t>(lane)]; }

std::complex<double> number(const Plane<Lanes>& z, Index lane) { return {in(z.x, lane), in(z.y, lane)}; }

// Directions when a rod is varied: its chord with two rates; the speed.
constexpr std::size_t chord_direction = 0, speed_direction = 3;

// What the answers of rod r do when rod s is varied, and with the speed.
struct Influence {
  using Slopes = std::array<Lanes, 4>;
  std::array<Slopes, 7> of_answer;  // base motion, in the order of BaseMotion, and X
  std::array<Lanes, 3> of_load;  // X alone, by the load of s: along, across, moment
};

// The whole mechanism at a block of angles.
class Block {
 public:
  Block(const ExactModel::Impl& model, const CrankAngles& angles, double speed)
      : model_(model), angles_(angles), speed_(speed) {
    for (std::size_t r = 0; r < model.rods.size(); ++r) rods_.emplace_back(model.rules[r], model.constants[r]);
    mechanism_.rods.resize(rods_.size());
    influence_.resize(rods_.size() * rods_.size());
  }

  // Motion, loads, joint forces at the angles from `first`.
  void solve(const RitzSamples& motion, Index first) {
    first_ = first;
    for (std::size_t r = 0; r < rods_.size(); ++r) {
      const Index row = model_.first[r], count = model_.rods[r].num_modes;
      rods_[r].bend(motion.q.middleRows(row, count), motion.q1.middleRows(row, count), motion.q2.middleRows(row, count),
                    first);
      mechanism_.rods[r].chord = rods_[r].chord();
      mechanism_.rods[r].shape = rods_[r].shape();
    }
    const auto slider_forces = [&](Index dyad) { return slider_force(dyad); };
    exact::move(model_.linkage, model_.rod_of, crank(), Lanes(speed_), mechanism_);
    exact::load(model_.linkage, model_.rod_of, model_.constants, slider_forces, mechanism_);
    exact::balance(model_.linkage, model_.rod_of, mechanism_);
  }

  // The rods in what the mechanism answers.
  void surround() {
    for (std::size_t r = 0; r < rods_.size(); ++r)
      rods_[r].surround(mechanism_.rods[r].base, mechanism_.rods[r].axial_force);
  }

  Index count() const { return std::min(Lanes::width, angles_.size() - first_); }
  const exact::BentMechanism<Lanes>& mechanism() const { return mechanism_; }

  // At the first angle at which a rod is too steep, else at the first at which a dyad does not close.
  std::optional<ExactBreakdown> breakdown() const {
    for (Index lane = 0; lane < count(); ++lane)
      for (std::size_t r = 0; r < rods_.size(); ++r)
        if (const double slope = in(rods_[r].steepest(), lane); !(slope < 1))
          return ExactBreakdown{ExactBreakdown::Kind::slope, model_.rods[r].link, angles_.tau(first_ + lane), slope};
    for (Index lane = 0; lane < count(); ++lane)
      for (std::size_t body = 1; body < mechanism_.motion.size(); body += 2)
        if (!std::isfinite(in(norm(mechanism_.motion[body].e), lane)))
          return ExactBreakdown{ExactBreakdown::Kind::open, static_cast<int>(body), angles_.tau(first_ + lane), 0};
    return std::nullopt;
  }

  // After surround().
  void residual(MatrixXd& r) {
    for (std::size_t rod = 0; rod < rods_.size(); ++rod) {
      const std::vector<Lanes>& own = rods_[rod].residual();
      for (std::size_t i = 0; i < own.size(); ++i) put(own[i], r, model_.first[rod] + static_cast<Index>(i));
    }
  }

  // Of rod r by rod s.
  const Influence& influence(std::size_t r, std::size_t s) const { return influence_[r * rods_.size() + s]; }

  void influences(bool by_speed) {
    for (std::size_t s = 0; s < rods_.size(); ++s) {
      if (by_speed)
        vary_chord(s, variation_with_speed_);
      else
        vary_chord(s, variation_);
      vary_load(s);
    }
  }

  void derivatives(ExactResidual& out) {
    influences(out.by_speed.size() > 0);
    for (BentRod& rod : rods_) rod.differentiate();
    for (std::size_t s = 0; s < rods_.size(); ++s)
      for (std::size_t r = 0; r < rods_.size(); ++r) assemble(r, s, out);
  }

 private:
  void put(const Lanes& lanes, MatrixXd& samples, Index row) const {
    const Lanes::Values values = lanes.values();
    for (Index lane = 0; lane < count(); ++lane) samples(row, first_ + lane) = values[static_cast<std::size_t>(lane)];
  }

  // The last angle again beyond the last one.
  template <class Value>
  Lanes at_angles(const Value& value) const {
    return Lanes::of([&](Index lane) { return value(std::min(first_ + lane, angles_.size() - 1)); });
  }

  Plane<Lanes> crank() const {
    return {at_angles([&](Index j) { return angles_.direction(j).real(); }),
            at_angles([&](Index j) { return angles_.direction(j).imag(); })};
  }
  Lanes slider_force(Index dyad) const {
    return at_angles([&](Index j) { return angles_.slider_forces(dyad, j); });
  }

  template <bool by_speed>
  void vary_chord(std::size_t s, exact::ChordVariation<by_speed>& variation) {
    const auto slider_forces = [&](Index dyad) { return slider_force(dyad); };
    variation.vary(model_.linkage, model_.rod_of, model_.constants, slider_forces, crank(), Lanes(speed_), mechanism_,
                   s);
    const auto slopes = [](const auto& dual) {
      Influence::Slopes all;
      std::copy(dual.slope.begin(), dual.slope.end(), all.begin());
      return all;
    };
    for (std::size_t r = 0; r < rods_.size(); ++r) {
      const auto& rod = variation.rods()[r];
      const auto& b = rod.base;
      influence_[r * rods_.size() + s].of_answer = {slopes(b.v_x),          slopes(b.v_y),  slopes(b.a_x),
                                                    slopes(b.a_y),          slopes(b.phi1), slopes(b.phi2),
                                                    slopes(rod.axial_force)};
    }
  }

  // Unit loads alone.
  void vary_load(std::size_t s) {
    const auto body = static_cast<std::size_t>(model_.rods[s].link);
    const Plane<Lanes>& e = mechanism_.motion[body].e;
    const std::array<exact::BentLoad<Lanes>, 3> units = {
        exact::BentLoad<Lanes>{e, 0}, {turned(e), 0}, {Plane<Lanes>(), 1}};
    unloaded_ = mechanism_;
    for (std::size_t direction = 0; direction < 3; ++direction) {
      std::fill(unloaded_.loads.begin(), unloaded_.loads.end(), exact::BentLoad<Lanes>());
      unloaded_.loads[body] = units[direction];
      exact::balance(model_.linkage, model_.rod_of, unloaded_);
      for (std::size_t r = 0; r < rods_.size(); ++r)
        influence_[r * rods_.size() + s].of_load[direction] = unloaded_.rods[r].axial_force;
    }
  }

  // dr/dq of rod r by rod s: its own part, then through base motion b and axial force X of the mechanism,
  //     dr_r/dz_s += G_r d(b, X)_r/d(c, c', c'')_s  d(c, c', c'')_s/dz_s + dr_r/dX  dX_r/d(load)_s  d(load)_s/dz_s,
  // G_r = dr_r/d(b, X)_r; z = q, q', q''.
  void assemble(std::size_t r, std::size_t s, ExactResidual& out) const {
    const RodDerivatives &own = rods_[r].derivatives(), &cause = rods_[s].derivatives();
    const Influence& through = influence(r, s);
    const Index n = model_.num_modes(), I_r = model_.rods[r].num_modes, I_s = model_.rods[s].num_modes;
    const std::array<MatrixXd*, 3> by = {&out.by_q, &out.by_q1, &out.by_q2};
    for (Index i = 0; i < I_r; ++i) {
      const RodDerivatives::Mode& effect = own.modes[static_cast<std::size_t>(i)];
      Influence::Slopes on;  // of c, c', c'' and the speed on r_i
      for (std::size_t d = 0; d < on.size(); ++d) {
        on[d] = effect.by_axial_force * through.of_answer[6][d];
        for (std::size_t k = 0; k < 6; ++k) on[d] += effect.by_base[k] * through.of_answer[k][d];
      }
      const Index row = model_.first[r] + i;
      if (s == 0 && out.by_speed.size() > 0) put(on[speed_direction], out.by_speed, row);
      for (Index j = 0; j < I_s; ++j) {
        const RodDerivatives::Mode& of = cause.modes[static_cast<std::size_t>(j)];
        const auto& [c, c1, c2] = of.chord;
        std::array<Lanes, 3> sum = {on[0] * c + on[1] * c1 + on[2] * c2, on[1] * c + 2 * on[2] * c1, on[2] * c};
        for (std::size_t z = 0; z < 3; ++z) {
          const Lanes X =
              through.of_load[0] * of.F_x[z] + through.of_load[1] * of.F_y[z] + through.of_load[2] * of.moment[z];
          sum[z] += effect.by_axial_force * X;
          if (r == s) sum[z] += own.residual[static_cast<std::size_t>(i + I_r * j)][z];
          put(sum[z], *by[z], row + n * (model_.first[s] + j));
        }
      }
    }
  }

  const ExactModel::Impl& model_;
  const CrankAngles& angles_;
  double speed_;
  Index first_ = 0;
  std::vector<BentRod> rods_;
  exact::BentMechanism<Lanes> mechanism_, unloaded_;
  exact::ChordVariation<false> variation_;
  exact::ChordVariation<true> variation_with_speed_;
  std::vector<Influence> influence_;
};

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

std::vector<double> ExactModel::driven_masses() const {
  constexpr Index num_angles = 64;
  const CrankAngles angles(linkage(), num_angles);
  const MatrixXd zero = MatrixXd::Zero(num_modes(), num_angles);
  const RitzSamples straight{zero, zero, zero};
  Block block(*impl_, angles, 1);
  std::vector<double> masses(rods().size(), 0);
  for (Index first = 0; first < num_angles; first += Lanes::width) {
    block.solve(straight, first);
    block.influences(false);
    for (std::size_t rod = 0; rod < masses.size(); ++rod)
      for (const double driven : block.influence(rod, rod).of_answer[6][chord_direction + 2].values())
        masses[rod] = std::max(masses[rod], std::abs(driven));
  }
  return masses;
}

namespace {

// Of `result` what has a size.
ExactResidual evaluated(const ExactModel::Impl& model, double speed, const CrankAngles& angles,
                        const RitzSamples& motion, ExactResidual result) {
  check_shapes(model, angles, motion);
  const bool derivatives = result.by_q.size() > 0;
  Block block(model, angles, speed);
  for (Index first = 0; first < angles.size(); first += Lanes::width) {
    end_if_wished();
    block.solve(motion, first);
    if (const std::optional<ExactBreakdown> breakdown = block.breakdown()) return {.breakdown = breakdown};
    block.surround();
    if (result.r.size() > 0) block.residual(result.r);
    if (derivatives) block.derivatives(result);
  }
  return result;
}

}  // namespace

ExactResidual ExactModel::residual(double speed, const CrankAngles& angles, const RitzSamples& motion,
                                   bool derivatives) const {
  const Index n = num_modes(), N = angles.size();
  ExactResidual result;
  result.r.resize(n, N);
  if (derivatives) {
    result.by_speed.resize(n, N);
    for (MatrixXd* by : {&result.by_q, &result.by_q1, &result.by_q2}) by->resize(n * n, N);
  }
  return evaluated(*impl_, speed, angles, motion, std::move(result));
}

ExactResidual ExactModel::linearised(double speed, const CrankAngles& angles, const RitzSamples& motion) const {
  const Index n = num_modes(), N = angles.size();
  ExactResidual result;
  for (MatrixXd* by : {&result.by_q, &result.by_q1, &result.by_q2}) by->resize(n * n, N);
  return evaluated(*impl_, speed, angles, motion, std::move(result));
}

std::optional<ExactBreakdown> ExactModel::visit_forces(double speed, const CrankAngles& angles,
                                                       const RitzSamples& motion, const Visit& visit) const {
  check_shapes(*impl_, angles, motion);
  std::optional<ExactBreakdown> breakdown;
  Block block(*impl_, angles, speed);
  for (Index first = 0; first < angles.size(); first += Lanes::width) {
    block.solve(motion, first);
    if (!breakdown) breakdown = block.breakdown();
    visit(first, block.count(), block.mechanism());
  }
  return breakdown;
}

ExactModel::Forces ExactModel::forces(double speed, const CrankAngles& angles, const RitzSamples& motion) const {
  Forces result;
  result.forces.reserve(static_cast<std::size_t>(angles.size()));
  result.motion.reserve(static_cast<std::size_t>(angles.size()));
  const auto keep = [&](Index, Index count, const exact::BentMechanism<Lanes>& mechanism) {
    for (Index lane = 0; lane < count; ++lane) {
      MechanismForces& forces = result.forces.emplace_back();
      forces.dyads.reserve(mechanism.forces.size());
      for (const exact::BentDyadForces<Lanes>& dyad : mechanism.forces)
        forces.dyads.push_back({number(dyad.joint0, lane), number(dyad.joint1, lane), number(dyad.ground, lane)});
      forces.crank_pivot = number(mechanism.crank_pivot, lane);
      forces.torque = in(mechanism.torque, lane);
      std::vector<BodyMotion>& bodies = result.motion.emplace_back();
      bodies.reserve(mechanism.motion.size());
      for (const exact::BentMotion<Lanes>& m : mechanism.motion)
        bodies.push_back({number(m.z, lane), number(m.z1, lane), number(m.z2, lane), number(m.e, lane),
                          in(m.phi1, lane), in(m.phi2, lane)});
    }
  };
  result.breakdown = visit_forces(speed, angles, motion, keep);
  return result;
}

RitzSamples ritz_samples(std::span<const FourierSeries> q, double speed, Index num_samples, int num_turns) {
  Index n = 0;
  for (const FourierSeries& series : q) n += series.num_components();
  RitzSamples samples{MatrixXd(n, num_samples), MatrixXd(n, num_samples), MatrixXd(n, num_samples)};
  const double Omega = speed / num_turns;
  fourier::RealTransform& transform = fourier::thread_transform(num_samples, 3 * n);  // q, q', q''
  auto spectrum = transform.spectrum();
  Index row = 0;
  for (const FourierSeries& series : q) {
    const Index I = series.num_components(), harmonics = series.num_harmonics() + 1;
    if (num_samples < 2 * harmonics - 1) throw std::invalid_argument("ritz_samples: fewer samples than 2H+1");
    for (Index i = 0; i < I; ++i, ++row) {
      for (const Index column : {row, n + row, 2 * n + row})
        spectrum.col(column).tail(spectrum.rows() - harmonics).setZero();
      for (Index k = 0; k < harmonics; ++k) {
        const double rate = static_cast<double>(k) * Omega;
        const std::complex<double> c = series.c(i, k);
        spectrum(k, row) = c;
        spectrum(k, n + row) = {-rate * c.imag(), rate * c.real()};
        spectrum(k, 2 * n + row) = -rate * rate * c;
      }
    }
  }
  transform.backward();
  const auto all = transform.samples();
  samples.q = all.leftCols(n).transpose();
  samples.q1 = all.middleCols(n, n).transpose();
  samples.q2 = all.rightCols(n).transpose();
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
