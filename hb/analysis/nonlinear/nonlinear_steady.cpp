#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "hb/analysis/nonlinear/bent_stress.hpp"
#include "hb/analysis/nonlinear/motion_finder.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "lib/exact/exact_forces.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// With modes = "auto", of the error of the cut: that much above the motion's own.
constexpr double motion_share = 0.05;

constexpr Index envelope_points = 101;

// f_k of the rod over T turns.
RodCoefficients over_turns(const RodCoefficients& rod, int turns) {
  RodCoefficients all = rod;
  for (FourierSeries& f : all.f)
    if (f.c.size() > 0) f = repeated(f, turns);
  return all;
}

std::vector<FourierSeries> by_rod(const ExactModel& exact, const FourierSeries& q) {
  std::vector<FourierSeries> all;
  for (std::size_t r = 0; r < exact.rods().size(); ++r)
    all.emplace_back(Eigen::MatrixXcd(q.c.middleRows(exact.first_mode(r), exact.rods()[r].num_modes)));
  return all;
}

// The same motion better known: with more harmonics, and by rod with more modes.
struct BetterMotion {
  ExactModel exact;
  std::vector<FourierSeries> q;
};

std::vector<BetterMotion> better_motions(const ExactModel& exact, const PeriodicMotion& motion,
                                         const std::optional<std::vector<FourierSeries>>& finer) {
  const auto with_modes_of = [&](std::vector<FourierSeries> q) {
    std::vector<ExactModel::Rod> rods;
    for (std::size_t r = 0; r < q.size(); ++r) rods.push_back({exact.rods()[r].link, q[r].num_components()});
    return BetterMotion{ExactModel(exact.linkage(), rods), std::move(q)};
  };
  std::vector<BetterMotion> all;
  if (motion.q_finer.c.size() > 0) all.push_back(with_modes_of(by_rod(exact, motion.q_finer)));
  if (finer) all.push_back(with_modes_of(*finer));
  return all;
}

// Of the motion itself, and of the better ones.
struct AllStresses {
  std::optional<BentStresses> own;
  std::vector<BentStresses> better;
};

AllStresses all_stresses(const ExactModel& exact, const NonlinearResult& result,
                         const std::vector<BetterMotion>& better) {
  Index H = result.motion.q.num_harmonics();
  for (const BetterMotion& other : better) H = std::max(H, other.q.front().num_harmonics());
  const Index N = stress_samples(H, result.turns);
  AllStresses all;
  all.own.emplace(exact, result.speed, result.turns, by_rod(exact, result.motion.q), N);
  for (const BetterMotion& other : better) all.better.emplace_back(other.exact, result.speed, result.turns, other.q, N);
  return all;
}

// With modes beyond I following their load as in the linear theory; damping of that tail counts harmonics of Omega/T,
// and f_k^(p) are multiplied with powers of the speed given: of the crank's.
RodCoefficients coefficients_of_motion(const SceneModel& model, const RodModel& rod, int turns) {
  RodCoefficients coefficients = over_turns(model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], turns);
  double power = 1;
  for (FourierSeries& f : coefficients.f) {
    f.c *= power;
    power *= turns;
  }
  return coefficients;
}

// `finer`: by rod with more modes, where it is known.
void add_rods(const SceneModel& model, const ExactModel& exact, const std::optional<std::vector<FourierSeries>>& finer,
              const std::vector<BetterMotion>& better, NonlinearResult& result) {
  const PeriodicMotion& motion = result.motion;
  // Errors need both: what more harmonics change, and what more modes do.
  const bool errors_known = finer && motion.q_finer.c.size() > 0;
  const std::vector<BetterMotion> none;
  const AllStresses stresses =
      result.computed.shape ? all_stresses(exact, result, errors_known ? better : none) : AllStresses{};
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
    const RodCoefficients coefficients = coefficients_of_motion(model, from, result.turns);
    if (finer) rod.cut = cut_error(body, coefficients, base, rod.q, (*finer)[r]);
    if (result.computed.shape) {
      rod.shape = rod_shape(body, coefficients, base, rod.q);
      bend(rod.shape->bending_moment, rod.q, body.length);
      if (rod.cut)
        rod.peak_errors = peak_errors(body, *rod.shape, rod.q.num_components(),
                                      fourier::largest_values(rod.q).maxCoeff(), rod.error_bound, *rod.cut);
      std::optional<double> moment_error;
      if (rod.peak_errors) moment_error = rod.peak_errors->bending_moment;
      rod.stress =
          stresses.own->largest(r, coefficients, rod.shape->bending_moment.max_abs, moment_error, stresses.better);
      rod.cycle = bent_cycle(body, *stresses.own, r, coefficients, I, result.turns, stresses.better);
      if (rod.cycle) rod.envelope = stress_envelope(body, stresses.own->field(r, coefficients), envelope_points);
    }
    // Over the turns.
    const auto turned = [&](double& angle) { angle *= result.turns; };
    for (Extremum& peak : rod.max_abs) turned(peak.crank_angle);
    if (rod.shape) turned(rod.shape->deflection.crank_angle), turned(rod.shape->bending_moment.crank_angle);
    result.rods.push_back(std::move(rod));
  }
}

// Positions as series over the turns, in the dyads' order.
std::vector<SliderMotion> sliders_of(const Linkage& linkage, const FourierSeries& positions, double base) {
  std::vector<SliderMotion> sliders;
  for (const Dyad& dyad : linkage.dyads)
    if (const auto* slider = std::get_if<Slider>(&dyad.closing))
      sliders.push_back({slider->name,
                         FourierSeries(Eigen::MatrixXcd(positions.c.row(static_cast<Index>(sliders.size())))),
                         base,
                         {HUGE_VAL, HUGE_VAL, HUGE_VAL}});
  return sliders;
}

// Forces of the motion as series over its turns, beside the rigid ones; what its frame feels; its sliders.
void add_forces(const ExactModel& exact, NonlinearResult& result) {
  const Linkage& linkage = exact.linkage();
  const FourierSeries& q = result.motion.q;
  const int turns = result.turns;
  JointForces forces = joint_forces(linkage, result.speed, {});
  // Bodies move with more harmonics than the rods bend with.
  Index N = 256 * turns;
  ForceSamples samples;
  for (;; N *= 2) {
    if (2 * q.num_harmonics() + 2 > N) continue;
    samples = exact_forces(exact, result.speed, CrankAngles(linkage, N, turns),
                           ritz_samples(by_rod(exact, q), result.speed, N, turns));
    const FourierSeries series = fourier::analyse(samples.values);
    const double left = series.c.rightCols(series.c.cols() / 4).cwiseAbs().maxCoeff();
    if (!samples.values.allFinite() || left <= 1e-13 * series.c.cwiseAbs().maxCoeff() || N >= 8192 * turns) break;
  }
  const auto over_all_turns = [&](FourierSeries& series) {
    if (turns > 1 && series.c.size() > 0) series = repeated(series, turns);
  };
  Index row = 0;
  for (JointForce& joint : forces.joints) {
    const Index count = joint.rigid.num_components();
    joint.elastic = fourier::analyse(samples.values.middleRows(row, count));
    over_all_turns(joint.rigid);
    row += count;
  }
  forces.torque = fourier::analyse(samples.values.row(row));
  over_all_turns(forces.torque_rigid);
  forces.frame.elastic = fourier::analyse(samples.frame);
  over_all_turns(forces.frame.rigid);
  result.forces = std::move(forces);
  if (samples.sliders.rows() > 0)
    result.sliders = sliders_of(linkage, fourier::analyse(samples.sliders), result.speed / turns);
}

// Twice what the better motions change: with more harmonics, and with more modes (the cut).
void add_force_errors(const ExactModel& exact, const std::vector<BetterMotion>& better, NonlinearResult& result) {
  const Index N = 1024 * result.turns;
  const CrankAngles angles(exact.linkage(), N, result.turns);
  const auto samples_of = [&](const ExactModel& of, std::vector<FourierSeries> q) {
    for (FourierSeries& series : q)
      series = fourier::resized(series, std::min<Index>(series.num_harmonics(), N / 2 - 1));
    return exact_forces(of, result.speed, angles, ritz_samples(q, result.speed, N, result.turns));
  };
  const ForceSamples here = samples_of(exact, by_rod(exact, result.motion.q));
  const Index last = here.values.rows() - 1;
  const double force = here.values.topRows(last).cwiseAbs().maxCoeff(),
               torque = here.values.row(last).cwiseAbs().maxCoeff();
  result.force_errors = ForceErrors{0, 0, 0, 0};
  result.frame_errors = FrameErrors{};
  const bool finer = result.motion.q_finer.c.size() > 0, cut_known = better.size() > (finer ? 1 : 0);
  if (!finer) result.force_errors->force = result.force_errors->torque = HUGE_VAL;
  if (!cut_known) result.force_errors->force_cut = result.force_errors->torque_cut = HUGE_VAL;
  if (!finer || !cut_known) result.frame_errors = {HUGE_VAL, HUGE_VAL};
  for (SliderMotion& slider : result.sliders) slider.errors.fill(finer && cut_known ? 0 : HUGE_VAL);
  for (std::size_t k = 0; k < better.size(); ++k) {
    const ForceSamples there = samples_of(better[k].exact, better[k].q);
    constexpr double safety = 2;
    const MatrixXd change = safety * (there.values - here.values);
    const double by_force = change.topRows(last).cwiseAbs().maxCoeff() / force,
                 by_torque = change.row(last).cwiseAbs().maxCoeff() / torque;
    const bool harmonics = finer && k == 0;
    (harmonics ? result.force_errors->force : result.force_errors->force_cut) = by_force;
    (harmonics ? result.force_errors->torque : result.force_errors->torque_cut) = by_torque;
    const Eigen::Matrix3Xd frame = safety * (there.frame - here.frame);
    result.frame_errors->force += frame.topRows(2).colwise().norm().maxCoeff();
    result.frame_errors->moment += frame.row(2).cwiseAbs().maxCoeff();
    if (result.sliders.empty()) continue;
    const FourierSeries moved = fourier::analyse(safety * (there.sliders - here.sliders));
    for (std::size_t s = 0; s < result.sliders.size(); ++s)
      for (int order = 0; order < 3; ++order)
        result.sliders[s].errors[static_cast<std::size_t>(order)] +=
            std::pow(result.speed / result.turns, order) *
            fourier::max_abs(fourier::derivative(moved, order), static_cast<Index>(s)).value;
  }
}

// Rods, stability and forces of the motion found.
void describe(const SceneModel& model, const MotionFinder& finder, const Settings& settings, NonlinearResult& result) {
  std::optional<std::vector<FourierSeries>> finer;
  if (result.computed.steady || result.computed.shape || result.computed.reactions) {
    Stopwatch watch;
    finer = finder.with_more_modes();
    result.stages.push_back({"motion with more modes", watch.seconds(), finer ? "" : "none found"});
  }
  const std::vector<BetterMotion> better = better_motions(finder.exact(), result.motion, finer);
  add_rods(model, finder.exact(), finer, better, result);
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
  add_forces(finder.exact(), result);
  add_force_errors(finder.exact(), better, result);
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
  NonlinearResult result = is_auto(settings.modes) ? with_automatic_modes(model, speed, settings, options)
                                                   : at_given_modes(model, speed, settings, options, nullptr);
  // Motions are not solved to less than least_motion_tolerance, whatever is asked.
  const double error = result.motion.error_bound;
  if (settings.tolerance_asked && result.search == MotionSearch::found && error <= result.tolerance &&
      error > settings.tolerance)
    result.shortfalls.push_back(
        fmt::format("the motion's error {:.1e} exceeds the tolerance {:.1e}: motions are solved to {:.0e}", error,
                    settings.tolerance, least_motion_tolerance));
  return result;
}

NonlinearResult nonlinear_answer(const SceneModel& model, const PeriodicMotion& motion,
                                 const std::optional<Stability>& stability, double tolerance, const Settings& settings,
                                 const std::function<bool()>& stop) {
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
  const MotionOptions options{.tolerance = std::max(tolerance, least_motion_tolerance), .stop = stop};
  const std::optional<std::vector<FourierSeries>> finer = motion_with_more_modes(exact, motion.speed, motion, options);
  const std::vector<BetterMotion> better = better_motions(exact, motion, finer);
  add_rods(model, exact, finer, better, result);
  if (settings.only.stability) result.stability = stability;
  if (settings.only.reactions) {
    add_forces(exact, result);
    add_force_errors(exact, better, result);
  }
  return result;
}

}  // namespace hb
