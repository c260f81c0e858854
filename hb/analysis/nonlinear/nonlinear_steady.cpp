#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hb/analysis/nonlinear/motion_finder.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "lib/exact/exact_forces.hpp"
#include "lib/exact/rod_tension.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// With modes = "auto", of the error of the cut: that much above the motion's own.
constexpr double motion_share = 0.05;

// f_k of the rod over T turns.
RodCoefficients over_turns(const RodCoefficients& rod, int turns) {
  RodCoefficients all = rod;
  for (FourierSeries& f : all.f)
    if (f.c.size() > 0) f = repeated(f, turns);
  return all;
}

// EJ kappa from EJ w'': at the place found, 1/cos psi = (1 - w'^2)^(-1/2) with the slope of the modes kept.
void bend(RodPeak& moment, const FourierSeries& q, double l) {
  const Eigen::VectorXd at = fourier::evaluate(q, moment.crank_angle);
  double slope = 0;
  for (Index i = 0; i < at.size(); ++i) {
    const double k = static_cast<double>(i + 1) * std::numbers::pi / l;
    slope += k * std::cos(k * moment.x) * at(i);
  }
  moment.max_abs /= std::sqrt(1 - slope * slope);
}

std::vector<FourierSeries> by_rod(const ExactModel& exact, const FourierSeries& q) {
  std::vector<FourierSeries> all;
  for (std::size_t r = 0; r < exact.rods().size(); ++r)
    all.emplace_back(Eigen::MatrixXcd(q.c.middleRows(exact.first_mode(r), exact.rods()[r].num_modes)));
  return all;
}

// With the axial force along the bent rod instead of the rigid mechanism's.
RodStress bent_stress(const Body& rod, const TensionRange& force, const RodCoefficients& coefficients, double speed,
                      double bending_moment) {
  RodStress stress = rod_stress(rod, coefficients, speed, bending_moment);
  stress.tension = std::max(0.0, force.high);
  stress.compression = std::max(0.0, -force.low);
  stress.axial = std::max(stress.tension, stress.compression) / rod.elastic->area;
  stress.strain = (stress.axial + stress.bending) / rod.elastic->youngs_modulus;
  return stress;
}

// `finer`: by rod with more modes, where it is known.
void add_rods(const SceneModel& model, const ExactModel& exact, const std::optional<std::vector<FourierSeries>>& finer,
              NonlinearResult& result) {
  const PeriodicMotion& motion = result.motion;
  std::vector<TensionRange> tension;
  if (result.computed.shape) {
    const Index N = std::max<Index>(256 * result.turns, fourier::fast_length(8 * motion.q.num_harmonics()));
    tension = rod_tensions(exact, result.speed, CrankAngles(exact.linkage(), N, result.turns),
                           ritz_samples(by_rod(exact, motion.q), result.speed, N, result.turns));
  }
  // With modes beyond I following their load as in the linear theory; damping of that tail counts harmonics of Omega/T.
  const double base = result.speed / result.turns;
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    const RodModel& from = model.rods[r];
    const Body& body = *body_at(*model.linkage(), from.link);
    const Index first = exact.first_mode(r), I = exact.rods()[r].num_modes;
    NonlinearRod rod{.name = from.name, .link = from.link, .reported = from.reported};
    rod.q = FourierSeries(Eigen::MatrixXcd(motion.q.c.middleRows(first, I)));
    double size = 0;
    for (Index i = 0; i < I; ++i) {
      rod.max_abs.push_back(fourier::max_abs(rod.q, i));
      size = std::max(size, rod.max_abs.back().value);
    }
    const double error = motion.error.size() > 0 ? motion.error.segment(first, I).maxCoeff() : HUGE_VAL;
    rod.error_bound = error == 0 ? 0 : error / size;
    // f_k^(p) are multiplied with powers of the speed given: of the crank's.
    RodCoefficients coefficients =
        over_turns(model.coefficients.rods[static_cast<std::size_t>(from.coefficients)], result.turns);
    double power = 1;
    for (FourierSeries& f : coefficients.f) {
      f.c *= power;
      power *= result.speed / base;
    }
    if (finer) rod.cut = cut_error(body, coefficients, base, rod.q, (*finer)[r]);
    if (result.computed.shape) {
      rod.shape = rod_shape(body, coefficients, base, rod.q);
      bend(rod.shape->bending_moment, rod.q, body.length);
      if (rod.cut) rod.peak_errors = peak_errors(body, *rod.shape, rod.q, rod.error_bound, *rod.cut);
      rod.stress = bent_stress(body, tension[r], coefficients, base, rod.shape->bending_moment.max_abs);
    }
    // Over the turns.
    const auto turned = [&](double& angle) { angle *= result.turns; };
    for (Extremum& peak : rod.max_abs) turned(peak.crank_angle);
    if (rod.shape) turned(rod.shape->deflection.crank_angle), turned(rod.shape->bending_moment.crank_angle);
    result.rods.push_back(std::move(rod));
  }
}

// Forces of the motion as series over its turns, beside the rigid ones.
JointForces forces_of_motion(const ExactModel& exact, double speed, int turns, const FourierSeries& q) {
  JointForces forces = joint_forces(exact.linkage(), speed, {});
  // Bodies move with more harmonics than the rods bend with.
  Index N = 256 * turns;
  MatrixXd values;
  for (;; N *= 2) {
    const CrankAngles angles(exact.linkage(), N, turns);
    if (2 * q.num_harmonics() + 2 > N) continue;
    values = exact_forces(exact, speed, angles, ritz_samples(by_rod(exact, q), speed, N, turns)).values;
    const FourierSeries series = fourier::analyse(values);
    const double left = series.c.rightCols(series.c.cols() / 4).cwiseAbs().maxCoeff();
    if (!values.allFinite() || left <= 1e-13 * series.c.cwiseAbs().maxCoeff() || N >= 8192 * turns) break;
  }
  Index row = 0;
  for (JointForce& joint : forces.joints) {
    const Index count = joint.rigid.num_components();
    joint.elastic = fourier::analyse(values.middleRows(row, count));
    if (turns > 1 && joint.rigid.c.size() > 0) joint.rigid = repeated(joint.rigid, turns);
    row += count;
  }
  forces.torque = fourier::analyse(values.row(row));
  if (turns > 1 && forces.torque_rigid.c.size() > 0) forces.torque_rigid = repeated(forces.torque_rigid, turns);
  return forces;
}

// By the motion with more harmonics, as for linear forces.
ForceErrors errors_of(const ExactModel& exact, const NonlinearResult& result) {
  const Index N = 1024 * result.turns;
  const auto values = [&](const FourierSeries& q) {
    return exact_forces(exact, result.speed, CrankAngles(exact.linkage(), N, result.turns),
                        ritz_samples(by_rod(exact, fourier::resized(q, std::min<Index>(q.num_harmonics(), N / 2 - 1))),
                                     result.speed, N, result.turns))
        .values;
  };
  const MatrixXd here = values(result.motion.q);
  const Index last = here.rows() - 1;
  const double force = here.topRows(last).cwiseAbs().maxCoeff(), torque = here.row(last).cwiseAbs().maxCoeff();
  if (result.motion.q_finer.c.size() == 0) return {HUGE_VAL, HUGE_VAL, 0, 0};
  const MatrixXd change = values(result.motion.q_finer) - here;
  constexpr double safety = 2;
  return {safety * change.topRows(last).cwiseAbs().maxCoeff() / force,
          safety * change.row(last).cwiseAbs().maxCoeff() / torque, 0, 0};
}

// Rods, stability and forces of the motion found.
void describe(const SceneModel& model, const MotionFinder& finder, const Settings& settings, NonlinearResult& result) {
  std::optional<std::vector<FourierSeries>> finer;
  if (result.computed.steady || result.computed.shape) {
    Stopwatch watch;
    finer = finder.with_more_modes();
    result.stages.push_back({"motion with more modes", watch.seconds(), finer ? "" : "none found"});
  }
  add_rods(model, finder.exact(), finer, result);
  if (settings.only.stability) {
    Stopwatch watch;
    const StabilityOptions exponents{.tolerance = exponent_share * result.tolerance};
    result.stability = motion_stability(finder.system(), result.motion, exponents);
    if (!result.stability->converged)
      if (const std::optional<PeriodicMotion> finer = finder.with_more_harmonics())
        result.stability = motion_stability(finder.system(), *finer, exponents);
    if (!result.stability->converged)
      result.shortfalls.push_back(
          fmt::format("the growth rate's error {:.1e} exceeds {:.1e} of the larger of growth and speed",
                      result.stability->growth_error, exponents.tolerance));
    result.stages.push_back({"stability of the motion", watch.seconds(), result.stability->evidence});
  }
  if (!settings.only.reactions) return;
  Stopwatch watch;
  result.forces = forces_of_motion(finder.exact(), result.speed, result.turns, result.motion.q);
  result.force_errors = errors_of(finder.exact(), result);
  result.stages.push_back({"joint forces", watch.seconds(), ""});
}

// From `near`, or where that is null on the branch from low speed, with others at this speed.
NonlinearResult at_given_modes(const SceneModel& model, double speed, const Settings& settings,
                               const NonlinearOptions& options, const FourierSeries* near) {
  NonlinearResult result;
  result.speed = speed;
  result.turns = options.turns;
  result.computed = settings.only;
  result.tolerance = std::max(settings.tolerance, least_motion_tolerance);
  MotionFinder finder(model, speed, result.tolerance, options, result);
  Stopwatch watch;
  if (near != nullptr)
    finder.find_from(*near);
  else
    finder.find();
  const PeriodicMotion& motion = result.motion;
  result.stages.push_back({"periodic motion of all rods", watch.seconds(),
                           fmt::format("{} harmonics, {} samples, {} factorisations", motion.num_harmonics,
                                       motion.num_samples, motion.factorisations)});
  if (result.search != MotionSearch::found)
    result.shortfalls.push_back(result.search == MotionSearch::stopped ? "stopped before a motion was found"
                                                                       : result.why);
  else if (!(motion.error_bound <= result.tolerance))
    result.shortfalls.push_back(fmt::format("the motion's error {:.1e} exceeds {:.1e} of the largest |q|",
                                            motion.error_bound, result.tolerance));
  if (result.search == MotionSearch::found) describe(model, finder, settings, result);
  if (near != nullptr || result.search == MotionSearch::stopped) return result;
  Stopwatch others_watch;
  finder.look_for_others();
  result.stages.push_back({"other motions", others_watch.seconds(), fmt::format("{} found", result.others.size())});
  return result;
}

void set_modes(SceneModel& model, std::size_t r, Index num_modes) {
  RodModel& rod = model.rods[r];
  const Body& link = *body_at(*model.linkage(), rod.link);
  rod.num_modes = num_modes;
  rod.system = ritz_system(link, model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], num_modes);
}

// As many modes of each rod as its linear deflection takes, then more until the error of the motion's own cut is within
// the tolerance.
NonlinearResult with_automatic_modes(SceneModel model, double speed, Settings settings,
                                     const NonlinearOptions& options) {
  const double asked = std::max(settings.tolerance, least_motion_tolerance),
               wanted = std::max(settings.tolerance, options.least_cut);
  settings.tolerance = wanted;
  Settings deflection = settings;
  deflection.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  const SpeedResult linear = analyse(model, speed, deflection);
  for (std::size_t r = 0; r < model.rods.size(); ++r) set_modes(model, r, linear.rods[r].num_modes);
  deflection.tolerance = motion_share * wanted;
  settings.tolerance = std::min(asked, deflection.tolerance);

  NonlinearResult result = at_given_modes(model, speed, deflection, options, nullptr);
  std::vector<OtherMotion> others = std::move(result.others);
  std::vector<Stage> stages = std::move(result.stages);
  while (result.search == MotionSearch::found) {
    std::vector<FourierSeries> near;
    bool grows = false;
    for (std::size_t r = 0; r < model.rods.size(); ++r) {
      const NonlinearRod& rod = result.rods[r];
      const Index I = rod.q.num_components();
      const bool enough = rod.cut && rod.cut->deflection <= wanted;
      const Index more = enough ? I : more_modes(I);
      grows = grows || more > I;
      if (more > I) set_modes(model, r, more);
      near.emplace_back(more, rod.q.num_harmonics());
      near.back().c.topRows(I) = rod.q.c;
    }
    const bool last = !grows;
    const FourierSeries start = stacked(near);
    result = at_given_modes(model, speed, last ? settings : deflection, options, &start);
    stages.insert(stages.end(), result.stages.begin(), result.stages.end());
    if (last) break;
  }
  result.stages = std::move(stages);
  result.others = std::move(others);
  result.cut_tolerance = wanted;
  for (const NonlinearRod& rod : result.rods)
    if (!(rod.cut && rod.cut->deflection <= wanted))
      result.shortfalls.push_back(fmt::format("{}: with {} modes the error of the cut is {:.1e}, above {:.1e}",
                                              rod.name, rod.q.num_components(),
                                              rod.cut ? rod.cut->deflection : HUGE_VAL, wanted));
  return result;
}

}  // namespace

void require_nonlinear(const SceneModel& model, int turns) {
  if (!model.linkage())
    throw RequestError("theory", "\"nonlinear\" for a [hill] scene", "linear: the system is linear as it is given");
  if (model.rods.empty()) throw RequestError("theory", "\"nonlinear\" for a linkage without elastic links", "linear");
  for (const RodModel& rod : model.rods)
    if (body_at(*model.linkage(), rod.link)->elastic->shear)
      throw RequestError("theory", fmt::format("\"nonlinear\" with shear of {}", rod.name),
                         "linear, or the scene without shear");
  if (turns < 1 || (turns & (turns - 1)) != 0)
    throw RequestError("period", fmt::format("{}", turns), "1, 2, 4, 8, ...: motions that double their period");
}

NonlinearResult nonlinear_steady(const SceneModel& model, double speed, const Settings& settings,
                                 const NonlinearOptions& options) {
  require_nonlinear(model, options.turns);
  if (is_auto(settings.modes)) return with_automatic_modes(model, speed, settings, options);
  return at_given_modes(model, speed, settings, options, nullptr);
}

NonlinearResult nonlinear_answer(const SceneModel& model, const PeriodicMotion& motion,
                                 const std::optional<Stability>& stability, double tolerance,
                                 const Settings& settings) {
  NonlinearResult result;
  result.speed = motion.speed;
  result.turns = motion.turns;
  result.computed = settings.only;
  result.tolerance = tolerance;
  result.search = MotionSearch::found;
  result.motion = motion;
  if (!(motion.error_bound <= tolerance))
    result.shortfalls.push_back(
        fmt::format("the motion's error {:.1e} exceeds {:.1e} of the largest |q|", motion.error_bound, tolerance));
  std::vector<ExactModel::Rod> modes;
  for (const RodModel& rod : model.rods) modes.push_back({rod.link, rod.system.num_modes()});
  const ExactModel exact(*model.linkage(), modes);
  add_rods(model, exact, std::nullopt, result);
  if (settings.only.stability) result.stability = stability;
  if (settings.only.reactions) {
    result.forces = forces_of_motion(exact, motion.speed, motion.turns, motion.q);
    result.force_errors = errors_of(exact, result);
  }
  return result;
}

}  // namespace hb
