#include "hb/analysis/sweep/sweep_point.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/machine_loads.hpp"
#include "hb/analysis/modes.hpp"
#include "hb/analysis/rod_steady.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "hb/analysis/theory_growth.hpp"

namespace hb {
namespace {

std::vector<TurnRange> turn_ranges(const FourierSeries& series) {
  if (series.num_harmonics() < 0) return std::vector<TurnRange>(static_cast<std::size_t>(series.num_components()));
  std::vector<TurnRange> ranges;
  for (const Range& range : fourier::ranges(series)) ranges.push_back({range.min.value, range.max.value});
  return ranges;
}

double size_of(const TurnRange& range) { return std::max(std::abs(range.min), std::abs(range.max)); }

StressPoint stress_point(const RodStress& stress, const StressCycle& cycle) {
  StressPoint point;
  point.axial = stress.axial;
  point.bending = stress.bending;
  point.axial_error = stress.axial_error;
  point.bending_error = stress.bending_error.value_or(HUGE_VAL);
  point.x = cycle.x;
  point.crank_angle = cycle.crank_angle;
  point.max_abs = cycle.max_abs;
  point.mean = cycle.mean;
  point.amplitude = cycle.amplitude;
  point.error = cycle.error;
  if (cycle.yield) {
    point.yield_safety = cycle.yield->value;
    point.yield_safety_error = cycle.yield->error;
  }
  if (cycle.fatigue) {
    point.fatigue_safety = cycle.fatigue->factor.value;
    point.fatigue_safety_error = cycle.fatigue->factor.error;
  }
  return point;
}

// The response with more modes, for errors by comparison. Where q is accurate it is to `accuracy`, and what more modes
// add is told however small; else it is so much more accurate that the difference shows the error of q, whose highest
// harmonics count most in joint forces. Needs no error bound of its own. Empty where there is none.
FourierSeries with_more_modes(const RodModel& rod, double speed, const Settings& settings, const FourierSeries& q) {
  constexpr double accuracy = 1e-6, better = 1e-2;
  SteadyOptions options = response_options(settings);
  const bool accurate = options.tolerance <= better * accuracy;
  options.tolerance = accurate ? accuracy : std::min(accuracy, better * options.tolerance);
  const Eigen::Index num_modes = comparison_modes(rod.num_modes);
  if (auto finer = rough_rod(rod.finer, num_modes, speed, options.tolerance, &q)) return *std::move(finer);
  SteadyState state = solve_rod(rod.finer, num_modes, speed, options);
  return state.status == SteadyStatus::singular ? FourierSeries() : std::move(state.q);
}

// Periodic responses of one rod: as asked for, and with more modes where the error of the cut is looked at.
struct Responses {
  FourierSeries q, finer;
  std::optional<CutError> cut;  // of q, seen by `finer`
  ScaledSystem scaled;  // that q solves
};

// Where more modes change half of the deflection they may miss a resonance too: then nothing tells the error.
void compare(Responses& responses, const SceneModel& model, const RodModel& rod, double speed, FourierSeries finer) {
  constexpr double most_cut = 0.5;
  if (finer.c.size() == 0) return;
  const CutError cut =
      cut_error(*body_at(*model.linkage(), rod.link),
                model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], speed, responses.q, finer);
  if (!(cut.deflection <= most_cut)) return;
  responses.cut = cut;
  responses.finer = std::move(finer);
}

// Deflection, bending moment and stress with their errors.
void add_shape(RodPoint& point, const SceneModel& model, const RodModel& rod, double speed,
               const Responses& responses) {
  const Body& link = *body_at(*model.linkage(), rod.link);
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  const auto& [q, finer, cut, scaled] = responses;
  const RodShape shape = rod_shape(link, coefficients, speed, q);
  point.deflection = shape.deflection.max_abs;
  point.bending_moment = shape.bending_moment.max_abs;
  if (cut) {
    const PeakErrors errors =
        peak_errors(link, shape, q.num_components(), std::ranges::max(point.max_abs), point.error_bound, *cut);
    point.deflection_error = errors.deflection;
    point.bending_moment_error = errors.bending_moment;
  }
  const RodStress stress =
      rod_stress(link, coefficients, model.coefficients.tail, speed, *point.bending_moment, point.bending_moment_error);
  point.buckling_share = stress.buckling_share();
  point.buckling_share_error = stress.buckling_share_error();
  point.strain = stress.strain;
  if (stress.height_known)
    point.stress =
        stress_point(stress, stress_cycle(link, coefficients, speed, q, finer, cut ? point.error_bound : HUGE_VAL));
}

// What is told of each rod, of none where nothing is.
bool is_told(const std::vector<bool>& rods, std::size_t r) { return r < rods.size() && rods[r]; }

RodPoint analyse_rod(const SceneModel& model, std::size_t r, double x, double speed, const Settings& settings,
                     const Only& only, const PointOptions& options, Responses& responses) {
  const RodModel& rod = model.rods[r];
  RodPoint point;
  responses.scaled = scale_system(rod.system, speed);
  const ScaledSystem& scaled = responses.scaled;
  if (only.response()) {
    SteadyState state = solve_rod(rod.system, rod.num_modes, scaled,
                                  is_told(options.at_pole, r) ? pole_options(settings) : response_options(settings));
    point.steady = state.status;
    point.num_harmonics = state.num_harmonics;
    point.error_bound = state.error_bound;
    point.resonance_distance = state.resonance_distance;
    if (state.status != SteadyStatus::singular) {
      for (Eigen::Index i = 0; i < state.q.num_components(); ++i)
        point.max_abs.push_back(fourier::max_abs(state.q, i).value);
      responses.q = std::move(state.q);
      if (rod.finer.num_modes() > 0)
        compare(responses, model, rod, speed, with_more_modes(rod, speed, settings, responses.q));
      if (only.shape && rod.reported) add_shape(point, model, rod, speed, responses);
    }
  }
  if (only.stability) {  // of every rod: the mechanism is stable where all are
    StabilityOptions exponents = exponent_options(settings);
    if (options.start != nullptr && r < options.start->size()) exponents.starts = (*options.start)[r];
    exponents.keeps_solved = options.solution != nullptr;
    exponents.one_method = is_told(options.at_boundary, r);
    if (only.all_exponents() && settings.search) {
      point.stability = grid_sample(scaled, x, exponents);
    } else {
      point.stability.emplace();
      point.stability->x = x;
      point.stability->speed = speed;
      point.stability->stability = analyse_stability(scaled, exponents);
    }
    if (options.solution != nullptr) (*options.solution)[r] = std::move(point.stability->stability.solved);
  }
  return point;
}

JointForces add_forces(SweepPoint& point, const SceneModel& model, const std::vector<Responses>& solved) {
  std::vector<LinkResponse> responses, more_modes;
  double response_error = 0;
  bool compared = true;
  for (std::size_t r = 0; r < solved.size(); ++r) {
    const int link = model.rods[r].link;
    responses.push_back({link, solved[r].q});
    more_modes.push_back({link, solved[r].finer});
    compared = compared && solved[r].cut.has_value();
    response_error = std::max(response_error, point.rods[r].error_bound);
  }
  JointForces forces = joint_forces(*model.influence, point.speed, responses);
  LargestForces largest;
  for (const JointForce& joint : forces.joints) {
    for (const TurnRange& range : turn_ranges(joint.elastic)) {
      point.joints.push_back(range);
      largest.force = std::max(largest.force, size_of(range));
    }
    for (const TurnRange& range : turn_ranges(joint.rigid)) point.joints_rigid.push_back(range);
  }
  point.torque = turn_ranges(forces.torque).front();
  point.torque_rigid = turn_ranges(forces.torque_rigid).front();
  largest.torque = size_of(*point.torque);
  point.force_errors = compared || solved.empty() ? force_errors(*model.influence, point.speed, forces, largest,
                                                                 response_error, responses, {}, more_modes)
                                                  : ForceErrors{HUGE_VAL, HUGE_VAL, 0, 0};
  point.machine = machine_point(
      machine_loads(*model.linkage(), point.speed, forces, *point.force_errors, LoadDetail::largest), point.speed);
  return forces;
}

// `forces` may be null.
void add_theory(SweepPoint& point, const SceneModel& model, const std::vector<Responses>& solved,
                const JointForces* forces, const Only& only) {
  std::vector<LinearRod> linear;
  for (std::size_t r = 0; r < solved.size(); ++r)
    linear.push_back({&model.rods[r].system, &solved[r].q, &solved[r].scaled});
  const TheoryErrors errors = theory_errors(*model.exact, point.speed, linear, forces);
  for (std::size_t r = 0; r < solved.size(); ++r) {
    point.rods[r].theory_error = errors.rods[r].q;
    if (only.shape) point.rods[r].deflection_theory_error = errors.rods[r].deflection;
  }
  point.theory_reason = errors.reason;
  point.force_theory_error = errors.force;
  point.torque_theory_error = errors.torque;
  point.mean_torque_theory_error = errors.mean_torque;
  if (only.stability) point.growth_theory_error = growth_theory_error(*model.linkage(), point.speed, linear, errors);
}

}  // namespace

MachinePoint machine_point(const MachineLoads& loads, double speed) {
  MachinePoint point;
  for (const BearingLoad& bearing : loads.bearings) point.bearings.push_back(bearing.elastic.value);
  point.shaking_force = loads.shaking_force.value;
  const Range moment = fourier::range(loads.frame.elastic, 2);
  point.shaking_moment = {moment.min.value, moment.max.value};
  point.drive = loads.drive;
  point.speed_fluctuation = loads.speed_fluctuation;
  point.speed_fluctuation_error = loads.speed_fluctuation_error;
  point.bearing_error = loads.bearing_error;
  point.shaking_force_error = loads.shaking_force_error;
  point.shaking_moment_error = loads.shaking_moment_error;
  point.torque_error = loads.torque_error;
  point.power_error = loads.power_error(speed);
  point.energy_error = loads.energy_error;
  return point;
}

SweepPoint analyse_point(const SweepScene& scene, double x, const Only& wanted, const PointOptions& options) {
  const ScenePlace place = scene.at(x);
  SweepPoint point;
  point.x = x;
  point.speed = place.speed;
  point.problem = place.problem;
  if (!place.model) return point;
  const Only only = available(*place.model, wanted);
  std::vector<Responses> solved(place.model->rods.size());
  if (options.solution != nullptr) options.solution->resize(solved.size());
  for (std::size_t r = 0; r < solved.size(); ++r)
    point.rods.push_back(analyse_rod(*place.model, r, x, place.speed, scene.settings(), only, options, solved[r]));
  std::optional<JointForces> forces;
  if (only.reactions && std::ranges::none_of(solved, [](const Responses& rod) { return rod.q.c.size() == 0; }))
    forces = add_forces(point, *place.model, solved);
  if (place.model->exact) add_theory(point, *place.model, solved, forces ? &*forces : nullptr, only);
  return point;
}

}  // namespace hb
