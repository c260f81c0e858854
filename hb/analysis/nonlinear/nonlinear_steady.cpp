#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/stopwatch.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/nonlinear/continuation.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "lib/exact/exact_forces.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Below this theory error at every lower speed the linear answer starts Newton's method on the branch from low speed.
constexpr double weakly_bent = 0.01;
// Of the motions on the way: enough to stay on the branch; where doublings are sought, enough to locate and leave them.
constexpr double way_tolerance = 1e-5, doubling_tolerance = 1e-8;
// A resonance curve with its folds takes some hundred.
constexpr int most_points = 600;
constexpr double least_tolerance = 1e-9;
// Exponents depend on accelerations: their tolerance, of the larger of growth and speed, over that of the motion.
constexpr double exponent_share = 100;
// Two motions are the same if their largest |q_i| agree to this.
constexpr double same_motion = 1e-4;

// Rows of the rods one above the other.
FourierSeries stacked(const std::vector<FourierSeries>& q) {
  Index H = 0, n = 0;
  for (const FourierSeries& series : q) H = std::max(H, series.num_harmonics()), n += series.num_components();
  FourierSeries all(n, H);
  Index row = 0;
  for (const FourierSeries& series : q) {
    all.c.middleRows(row, series.num_components()) = fourier::resized(series, H).c;
    row += series.num_components();
  }
  return all;
}

class Search {
 public:
  Search(const SceneModel& model, double speed, const Settings& settings, const NonlinearOptions& options,
         NonlinearResult& result)
      : model_(model), speed_(speed), options_(options), result_(result) {
    for (const RodModel& rod : model.rods) modes_.push_back(rod.system.num_modes());
    exact_ = with_modes(modes_);
    system_ = exact_system(exact_);
    motion_options_.tolerance = std::max(settings.tolerance, least_tolerance);
    motion_options_.stop = options.stop;
  }

  const ExactModel& exact() const { return *exact_; }
  const NonlinearSystem& system() const { return system_; }
  MotionOptions motion_options() const { return motion_options_; }

  // A motion of as many turns as asked for at the speed, or why there is none.
  void run() {
    const std::optional<double> start = starting_speed();
    if (!start) {
      result_.why = "no speed was found at which the linear theory holds, from which a branch could be followed";
      return;
    }
    PeriodicMotion first = solve_periodic_motion(system_, *start, linear_answer(*start), motion_options_);
    if (!usable(first, *start)) return;
    if (*start == speed_ && options_.turns == 1) {
      result_.motion = std::move(first);
      result_.search = MotionSearch::found;
      return;
    }
    result_.followed_from = *start;
    follow(first, *start);
  }

  // Motions that Newton's method finds from elsewhere and that are not the one found.
  void look_for_others() {
    if (options_.turns > 1) return;
    for (const FourierSeries& start : {linear_answer(speed_), FourierSeries()}) {
      if (stopped()) return;
      add_other(solve_periodic_motion(system_, speed_, start, motion_options_));
    }
  }

  // The same motion with half as many harmonics again.
  std::optional<PeriodicMotion> with_more_harmonics() const {
    MotionOptions options = motion_options_;
    options.turns = options_.turns;
    options.num_harmonics = std::min(options.max_harmonics, result_.motion.num_harmonics * 3 / 2 + 8);
    PeriodicMotion motion = solve_periodic_motion(system_, speed_, result_.motion.q, options);
    if (motion.status != MotionStatus::converged) return std::nullopt;
    return motion;
  }

  // The same motion with more modes of every rod, from this one.
  std::optional<std::vector<FourierSeries>> with_more_modes() {
    std::vector<Index> more;
    for (const Index I : modes_) more.push_back(std::min<Index>(comparison_modes(I), max_modes));
    const auto finer = with_modes(more);
    std::vector<FourierSeries> start;
    for (std::size_t r = 0; r < modes_.size(); ++r) {
      FourierSeries q(more[r], result_.motion.q.num_harmonics());
      q.c.topRows(modes_[r]) = result_.motion.q.c.middleRows(exact_->first_mode(r), modes_[r]);
      start.push_back(std::move(q));
    }
    MotionOptions options = motion_options_;
    options.turns = options_.turns;
    const PeriodicMotion motion = solve_periodic_motion(exact_system(finer), speed_, stacked(start), options);
    if (motion.status != MotionStatus::converged && motion.status != MotionStatus::not_reached) return std::nullopt;
    std::vector<FourierSeries> q;
    for (std::size_t r = 0; r < more.size(); ++r)
      q.emplace_back(Eigen::MatrixXcd(motion.q.c.middleRows(finer->first_mode(r), more[r])));
    return q;
  }

 private:
  std::shared_ptr<const ExactModel> with_modes(const std::vector<Index>& modes) const {
    std::vector<ExactModel::Rod> rods;
    for (std::size_t r = 0; r < modes.size(); ++r) rods.push_back({model_.rods[r].link, modes[r]});
    return std::make_shared<const ExactModel>(*model_.linkage(), rods);
  }

  bool stopped() const { return options_.stop && options_.stop(); }

  // All rods' linear responses; empty where one has none.
  FourierSeries linear_answer(double speed) const {
    std::vector<FourierSeries> q;
    for (const RodModel& rod : model_.rods) {
      SteadyState state = solve_steady_state(rod.system, speed, {.tolerance = 1e-8});
      if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return {};
      q.push_back(std::move(state.q));
    }
    return stacked(q);
  }

  // Largest theory error of a rod; infinite where there is none.
  double theory_error(double speed) const {
    std::vector<FourierSeries> q;
    std::vector<LinearRod> linear;
    for (const RodModel& rod : model_.rods) q.push_back(solve_steady_state(rod.system, speed, {.tolerance = 1e-8}).q);
    for (std::size_t r = 0; r < q.size(); ++r) linear.push_back({&model_.rods[r].system, &q[r]});
    double largest = 0;
    for (const TheoryErrors::Rod& rod : theory_errors(*exact_, speed, linear).rods)
      largest = std::max(largest, rod.q.value_or(HUGE_VAL));
    return largest;
  }

  // The highest speed up to which the rods are weakly bent, at most the one asked for.
  std::optional<double> starting_speed() const {
    constexpr int steps = 24;
    constexpr double lowest = 0.1;  // of the speed asked for
    std::optional<double> start;
    for (int k = 0; k <= steps; ++k) {
      const double speed = k == steps ? speed_ : speed_ * std::pow(lowest, 1 - static_cast<double>(k) / steps);
      if (!(theory_error(speed) <= weakly_bent)) break;
      start = speed;
    }
    for (double speed = lowest * speed_ / 2; !start && speed > 1e-4 * speed_; speed /= 2)
      if (theory_error(speed) <= weakly_bent) start = speed;
    return start;
  }

  bool usable(const PeriodicMotion& motion, double at) {
    if (motion.status == MotionStatus::converged || motion.status == MotionStatus::not_reached) return true;
    result_.search = motion.status == MotionStatus::stopped ? MotionSearch::stopped : MotionSearch::none;
    result_.why = fmt::format("no motion was found at {:.6g} rpm: {}{}", rpm(at), to_string(motion.status),
                              motion.failure ? ": " + motion.failure->reason : "");
    return false;
  }

  ContinuationOptions continuation(double from) const {
    ContinuationOptions options;
    options.motion = motion_options_;
    options.motion.tolerance =
        options_.turns > 1 ? doubling_tolerance : std::max(motion_options_.tolerance, way_tolerance);
    options.exponents.tolerance = exponent_share * options.motion.tolerance;
    options.low = 0.5 * from;
    options.high = speed_;
    options.stops = {speed_};
    options.max_points = most_points;
    options.stability = options_.turns > 1;
    options.stop = options_.stop;
    return options;
  }

  void follow(const PeriodicMotion& first, double from) {
    ContinuationOptions options = continuation(from);
    const Branch branch = follow_branch(system_, first, options);
    note_last(branch);
    if (options_.turns > 1) {
      follow_doublings(branch, options);
      return;
    }
    const BranchPoint* passage = passage_of(branch);
    if (!passage) {
      no_way(branch);
      return;
    }
    count_folds(branch, static_cast<std::size_t>(passage - branch.points.data()));
    settle(*passage);
  }

  // Those before a point.
  void count_folds(const Branch& branch, std::size_t point) {
    for (const Bifurcation& found : branch.bifurcations)
      result_.folds += found.kind == BifurcationKind::fold && found.after < point;
  }

  const BranchPoint* passage_of(const Branch& branch) const {
    const auto place = std::ranges::find_if(branch.points, [&](const BranchPoint& p) { return at_speed(p); });
    return place == branch.points.end() ? nullptr : &*place;
  }

  // Doublings on the way to the speed; then those beyond it.
  void follow_doublings(const Branch& to_speed, ContinuationOptions options) {
    options.high = 1.25 * speed_;
    if (doubled(to_speed, options)) return;
    if (!passage_of(to_speed) || stopped()) {
      no_way(to_speed);
      return;
    }
    ContinuationOptions onward = options;
    onward.stops.clear();
    const Branch beyond = follow_branch(system_, to_speed.points.back(), onward);
    if (!doubled(beyond, options)) no_way(beyond);
  }

  // A motion of twice, four times ... as many turns on a branch that leaves this one.
  bool doubled(const Branch& branch, const ContinuationOptions& options) {
    for (const Bifurcation& found : branch.bifurcations) {
      if (found.kind != BifurcationKind::period_doubling || stopped()) continue;
      ContinuationOptions here = options;
      here.motion.turns = found.point.motion.turns;
      for (const BranchPoint& start : branches_at(system_, found, here)) {
        ContinuationOptions further = options;
        further.motion.turns = start.motion.turns;
        const bool wanted = start.motion.turns == options_.turns;
        further.end_at_stop = wanted;
        further.stability = !wanted;
        const Branch next = follow_branch(system_, start, further);
        note_last(next);
        if (!wanted) {
          if (start.motion.turns < options_.turns && doubled(next, options)) {
            count_folds(branch, found.after);
            return true;
          }
          continue;
        }
        const BranchPoint* passage = passage_of(next);
        if (!passage) continue;
        count_folds(branch, found.after);
        count_folds(next, static_cast<std::size_t>(passage - next.points.data()));
        settle(*passage);
        return true;
      }
    }
    return false;
  }

  bool at_speed(const BranchPoint& point) const { return std::abs(point.motion.speed - speed_) <= 1e-12 * speed_; }

  // The point of the branch once more at the tolerance asked for.
  void settle(const BranchPoint& point) {
    MotionOptions options = motion_options_;
    options.turns = point.motion.turns;
    PeriodicMotion motion = solve_periodic_motion(system_, speed_, point.motion.q, options);
    if (!usable(motion, speed_)) return;
    result_.motion = std::move(motion);
    result_.search = MotionSearch::found;
  }

  void no_way(const Branch& branch) {
    result_.search = branch.end == BranchEnd::stopped || stopped() ? MotionSearch::stopped : MotionSearch::none;
    if (options_.turns > 1) {
      result_.why = fmt::format("no branch of {} turns that passes {:.6g} rpm was found", options_.turns, rpm(speed_));
      return;
    }
    double highest = 0;
    for (const BranchPoint& point : branch.points) highest = std::max(highest, point.motion.speed);
    result_.why = fmt::format(
        "the branch from low speed was followed over {} motions and did not come to {:.6g} rpm: the highest speed on "
        "it is "
        "{:.6g} rpm, the last one {:.6g} rpm ({}{})",
        branch.points.size(), rpm(speed_), rpm(highest), rpm(result_.last_speed.value_or(0)), to_string(branch.end),
        branch.failure ? ": " + branch.failure->reason : "");
  }

  double rpm(double speed) const { return rpm_from_speed(speed, model_.scene.units); }

  void note_last(const Branch& branch) {
    if (branch.points.empty()) return;
    result_.last_speed = branch.points.back().motion.speed;
    result_.last_max_abs = sizes(branch.points.back().motion.q);
  }

  // Largest |q_i| by rod and mode.
  std::vector<std::vector<double>> sizes(const FourierSeries& q) const {
    std::vector<std::vector<double>> values(modes_.size());
    for (std::size_t r = 0; r < modes_.size(); ++r)
      for (Index i = 0; i < modes_[r]; ++i) values[r].push_back(fourier::max_abs(q, exact_->first_mode(r) + i).value);
    return values;
  }

  void add_other(const PeriodicMotion& motion) {
    if (motion.status != MotionStatus::converged) return;
    const auto same = [&](const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b) {
      for (std::size_t r = 0; r < a.size(); ++r) {
        const double size = *std::ranges::max_element(a[r]);
        for (std::size_t i = 0; i < a[r].size(); ++i)
          if (!(std::abs(a[r][i] - b[r][i]) <= same_motion * size)) return false;
      }
      return true;
    };
    OtherMotion other{sizes(motion.q), std::nullopt};
    if (result_.search == MotionSearch::found && same(other.max_abs, sizes(result_.motion.q))) return;
    for (const OtherMotion& known : result_.others)
      if (same(other.max_abs, known.max_abs)) return;
    if (result_.computed.stability) other.verdict = motion_stability(system_, motion).verdict;
    result_.others.push_back(std::move(other));
  }

  const SceneModel& model_;
  double speed_;
  const NonlinearOptions& options_;
  NonlinearResult& result_;
  std::vector<Index> modes_;
  std::shared_ptr<const ExactModel> exact_;
  NonlinearSystem system_;
  MotionOptions motion_options_;
};

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

// `finer`: by rod with more modes, where it is known.
void add_rods(const SceneModel& model, const ExactModel& exact, const std::optional<std::vector<FourierSeries>>& finer,
              NonlinearResult& result) {
  const PeriodicMotion& motion = result.motion;
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
    if (finer) rod.modes_error = cut_error(body, coefficients, base, rod.q, (*finer)[r]);
    if (result.computed.shape) {
      rod.shape = rod_shape(body, coefficients, base, rod.q);
      bend(rod.shape->bending_moment, rod.q, body.length);
    }
    // Over the turns.
    const auto turned = [&](double& angle) { angle *= result.turns; };
    for (Extremum& peak : rod.max_abs) turned(peak.crank_angle);
    if (rod.shape) turned(rod.shape->deflection.crank_angle), turned(rod.shape->bending_moment.crank_angle);
    result.rods.push_back(std::move(rod));
  }
}

std::vector<FourierSeries> by_rod(const ExactModel& exact, const FourierSeries& q) {
  std::vector<FourierSeries> all;
  for (std::size_t r = 0; r < exact.rods().size(); ++r)
    all.emplace_back(Eigen::MatrixXcd(q.c.middleRows(exact.first_mode(r), exact.rods()[r].num_modes)));
  return all;
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
  if (std::holds_alternative<AutoModes>(settings.modes))
    throw RequestError("modes", "\"auto\"", "a number of modes with the nonlinear theory");
  NonlinearResult result;
  result.speed = speed;
  result.turns = options.turns;
  result.computed = settings.only;
  result.tolerance = std::max(settings.tolerance, least_tolerance);
  Search search(model, speed, settings, options, result);
  Stopwatch watch;
  search.run();
  result.stages.push_back({"periodic motion of all rods", watch.seconds(),
                           fmt::format("{} harmonics, {} samples, {} factorisations", result.motion.num_harmonics,
                                       result.motion.num_samples, result.motion.factorisations)});
  const auto look_for_others = [&] {
    Stopwatch others_watch;
    search.look_for_others();
    result.stages.push_back({"other motions", others_watch.seconds(), fmt::format("{} found", result.others.size())});
  };
  if (result.search != MotionSearch::found) {
    const bool stopped = result.search == MotionSearch::stopped;
    result.shortfalls.push_back(stopped ? "stopped before a motion was found" : result.why);
    if (!stopped) look_for_others();
    return result;
  }
  const double wanted = search.motion_options().tolerance;
  if (!(result.motion.error_bound <= wanted))
    result.shortfalls.push_back(
        fmt::format("the motion's error {:.1e} exceeds {:.1e} of the largest |q|", result.motion.error_bound, wanted));
  std::optional<std::vector<FourierSeries>> finer;
  if (result.computed.steady || result.computed.shape) {
    Stopwatch finer_watch;
    finer = search.with_more_modes();
    result.stages.push_back({"motion with more modes", finer_watch.seconds(), finer ? "" : "none found"});
  }
  add_rods(model, search.exact(), finer, result);
  if (settings.only.stability) {
    Stopwatch stability_watch;
    const StabilityOptions exponents{.tolerance = exponent_share * result.tolerance};
    result.stability = motion_stability(search.system(), result.motion, exponents);
    if (!result.stability->converged)
      if (const std::optional<PeriodicMotion> finer = search.with_more_harmonics())
        result.stability = motion_stability(search.system(), *finer, exponents);
    if (!result.stability->converged)
      result.shortfalls.push_back(
          fmt::format("the growth rate's error {:.1e} exceeds {:.1e} of the larger of growth and speed",
                      result.stability->growth_error, exponents.tolerance));
    result.stages.push_back({"stability of the motion", stability_watch.seconds(), result.stability->evidence});
  }
  if (settings.only.reactions) {
    Stopwatch forces_watch;
    result.forces = forces_of_motion(search.exact(), speed, options.turns, result.motion.q);
    result.force_errors = errors_of(search.exact(), result);
    result.stages.push_back({"joint forces", forces_watch.seconds(), ""});
  }
  look_for_others();
  return result;
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
