#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/nonlinear/motion_loads.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Eigen::Index;

// Two motions are the same if their largest |q_i| agree to this, of the largest.
// Bifurcations of two branches are the same one if they lie within this of the range.
constexpr double same_place = 1e-4;
constexpr std::size_t most_branches = 16;
// Of the motion; and of exponents, which depend on accelerations, relative to the larger of growth and speed.
constexpr double least_tolerance = 1e-8, exponent_tolerance = 1e-6;

std::shared_ptr<const ExactModel> exact_model(const Linkage& linkage, const std::vector<RodModel>& rods) {
  std::vector<ExactModel::Rod> modes;
  for (const RodModel& rod : rods) modes.push_back({rod.link, rod.system.num_modes()});
  return std::make_shared<const ExactModel>(linkage, modes);
}

// The exact model with the axis' number as its parameter. Where the axis is the speed, one mechanism serves all.
class SystemAlong {
 public:
  SystemAlong(const SweepScene& scene) : scene_(&scene) {}

  NonlinearSystem system() const {
    const SweepScene& scene = *scene_;
    const std::vector<RodModel>& rods = scene.first().rods;
    NonlinearSystem system;
    system.speed = [&scene](double x) { return scene.speed_at(x); };
    if (scene.axis().kind != Axis::Kind::parameter) {
      const NonlinearSystem by_speed = exact_system(exact_model(*scene.first().linkage(), rods));
      const double per_x = scene.speed_at(1);  // proportional
      system.num_unknowns = by_speed.num_unknowns;
      system.evaluate = [&scene, by_speed, per_x](double x, const MotionSamples& motion, Derivatives wanted,
                                                  ResidualSamples& out) {
        auto failure = by_speed.evaluate(scene.speed_at(x), motion, wanted, out);
        if (out.dp.size() > 0) out.dp *= per_x;
        return failure;
      };
      return system;
    }
    for (const RodModel& rod : rods) system.num_unknowns += rod.system.num_modes();
    // The last few values stand for the differences by x and the points between which a search goes to and fro.
    struct Known {
      std::map<double, NonlinearSystem> at;
      std::map<double, std::string> problem;
    };
    system.evaluate = [&scene, &rods, known = Known{}](
                          double x, const MotionSamples& motion, Derivatives wanted,
                          ResidualSamples& out) mutable -> std::optional<EvaluationFailure> {
      constexpr std::size_t most = 8;
      if (known.at.size() + known.problem.size() > most) known = {};
      if (!known.at.contains(x) && !known.problem.contains(x)) {
        const LinkagePlace place = scene.linkage_at(x);
        if (place.linkage)
          known.at.emplace(x, exact_system(exact_model(*place.linkage, rods)));
        else
          known.problem.emplace(x, place.problem);
      }
      if (const auto problem = known.problem.find(x); problem != known.problem.end())
        return EvaluationFailure{problem->second, motion.angle(0)};
      auto failure = known.at.at(x).evaluate(scene.speed_at(x), motion, wanted, out);
      out.dp.resize(0, 0);
      return failure;
    };
    return system;
  }

 private:
  const SweepScene* scene_;
};

class Sweeper {
 public:
  Sweeper(const SweepScene& scene, const NonlinearSweepOptions& options)
      : scene_(scene), asked_(options), system_(SystemAlong(scene).system()) {
    for (const RodModel& rod : scene.first().rods) {
      result_.rods.push_back(rod.name);
      result_.reported.push_back(rod.reported);
      modes_.push_back(rod.system.num_modes());
    }
    const std::vector<double>& x = scene.axis().values;
    result_.tolerance = options_.motion.tolerance = std::max(scene.settings().tolerance, least_tolerance);
    options_.exponents.tolerance = std::max(scene.settings().tolerance, exponent_tolerance);
    options_.motion.stop = options_.stop = options.stop;
    options_.low = x.front();
    options_.high = x.back();
    options_.stops = x;
    options_.stability = scene.settings().only.stability;
  }

  NonlinearSweep run() {
    start_from_below();
    start_from_above();
    for (const BranchStart& start : asked_.starts) start_from(start);
    follow_what_leaves();
    find_jumps();
    find_passages();
    add_loads();
    if (stopped()) {
      result_.stopped = true;
      result_.shortfalls.push_back("stopped before all branches were followed to their ends");
    }
    return std::move(result_);
  }

 private:
  bool stopped() const { return asked_.stop && asked_.stop(); }

  RodPeaks peaks(const FourierSeries& q) const {
    RodPeaks values(modes_.size());
    Index row = 0;
    for (std::size_t r = 0; r < modes_.size(); ++r)
      for (Index i = 0; i < modes_[r]; ++i) values[r].push_back(fourier::max_abs(q, row++).value);
    return values;
  }

  void start_from_below() {
    Stopwatch watch;
    const ScenePlace place = scene_.at(options_.low);
    if (!place.model) {
      result_.shortfalls.push_back(fmt::format("no linkage at the first value: {}", place.problem));
      return;
    }
    Settings settings = scene_.settings();
    settings.only = {true, false, false, false};
    const NonlinearResult start = nonlinear_steady(*place.model, place.speed, settings, {.stop = asked_.stop});
    result_.stages.push_back({"motion at the first value", watch.seconds(), start.why});
    if (start.search != MotionSearch::found) {
      result_.shortfalls.push_back(fmt::format("no motion was found at the first value: {}", start.why));
      return;
    }
    PeriodicMotion motion = start.motion;
    motion.parameter = options_.low;
    if (asked_.advanced) options_.reached = [this, passed = std::size_t(1)](double x) mutable { tell(x, passed); };
    add_branch(follow(motion, 1), nullptr);
    options_.reached = {};
    from_below_ = !result_.branches.empty();
  }

  // The values up to x, of which so many were told before.
  void tell(double x, std::size_t& passed) const {
    const std::vector<double>& values = scene_.axis().values;
    const auto there = static_cast<std::size_t>(std::ranges::upper_bound(values, x) - values.begin());
    if (there <= passed) return;
    asked_.advanced(there - passed);
    passed = there;
  }

  // Where the branch from below does not lead to it.
  void start_from_above() {
    if (stopped()) return;
    PeriodicMotion motion = solve_periodic_motion(system_, options_.high, {}, options_.motion);
    if (motion.status != MotionStatus::converged) return;
    const RodPeaks there = peaks(motion.q);
    for (const NonlinearBranch& branch : result_.branches)
      for (const NonlinearPoint& point : branch.points)
        if (point.x == options_.high && same_motion(point.max_abs, there)) return;
    add_branch(follow(motion, -1), nullptr);
  }

  void start_from(const BranchStart& start) {
    if (stopped()) return;
    MotionOptions options = options_.motion;
    options.turns = start.turns;
    const PeriodicMotion motion = solve_periodic_motion(system_, start.x, start.q, options);
    if (motion.status != MotionStatus::converged && motion.status != MotionStatus::not_reached) {
      result_.shortfalls.push_back(fmt::format("no motion was found from the start given at {} = {:.8g}: {}{}",
                                               scene_.axis().path, start.x, to_string(motion.status),
                                               motion.failure ? ": " + motion.failure->reason : ""));
      return;
    }
    if (passed(motion)) return;
    for (const int direction : {1, -1})
      if (start.x != (direction > 0 ? options_.high : options_.low)) add_branch(follow(motion, direction), nullptr);
  }

  Branch follow(const PeriodicMotion& start, int direction) {
    Stopwatch watch;
    ContinuationOptions options = options_;
    options.motion.turns = start.turns;
    options.direction = direction;
    Branch branch = follow_branch(system_, start, options);
    note(branch, watch.seconds());
    return branch;
  }

  void note(const Branch& branch, double seconds) {
    result_.stages.push_back(
        {fmt::format("branch {}", result_.branches.size() + 1), seconds,
         fmt::format("{} points, {} evaluations of an angle, {} factorisations, {}", branch.points.size(),
                     branch.evaluations, branch.factorisations, to_string(branch.end))});
  }

  NonlinearPoint point_of(const BranchPoint& point) const {
    const PeriodicMotion& motion = point.motion;
    return {motion.parameter,   motion.speed,
            point.stop,         peaks(motion.q),
            motion.error_bound, motion.parameter_error,
            point.stability,    point.stop ? std::make_shared<const PeriodicMotion>(motion) : nullptr};
  }

  // `begin`: the bifurcation at which it leaves another branch.
  void add_branch(Branch&& branch, const Bifurcation* begin) {
    if (branch.points.empty()) return;
    NonlinearBranch added{branch.turns, {}, branch.end, branch.failure ? branch.failure->reason : ""};
    if (begin) added.points.push_back(point_of(begin->point));
    const std::size_t first = added.points.size(), index = result_.branches.size();
    for (const BranchPoint& point : branch.points) added.points.push_back(point_of(point));
    result_.branches.push_back(std::move(added));
    for (const Bifurcation& found : branch.bifurcations) {
      const BranchPoint& at = found.point;
      NonlinearEvent event{found.kind, at.motion.parameter, at.motion.speed,   found.parameter_error, branch.turns,
                           index,      found.after + first, peaks(at.motion.q)};
      (found.kind == BifurcationKind::fold ? result_.folds : result_.bifurcations).push_back(std::move(event));
      if (found.kind == BifurcationKind::branch_point || found.kind == BifurcationKind::period_doubling)
        leaving_.push_back(found);
    }
    if (branch.end == BranchEnd::no_convergence || branch.end == BranchEnd::points ||
        branch.end == BranchEnd::no_residual)
      result_.shortfalls.push_back(fmt::format("branch {} ends at {} = {:.8g}: {}{}", index + 1, scene_.axis().path,
                                               branch.points.back().motion.parameter, to_string(branch.end),
                                               branch.failure ? ": " + branch.failure->reason : ""));
    if (branch.end == BranchEnd::joined) joined_.push_back({branch.turns, branch.points.back().motion.parameter});
  }

  // Branches that cross or begin at bifurcations, once each.
  void follow_what_leaves() {
    for (std::size_t k = 0; k < leaving_.size() && result_.branches.size() < most_branches; ++k) {
      if (stopped()) return;
      const Bifurcation found = leaving_[k];
      const bool doubles = found.kind == BifurcationKind::period_doubling;
      const int turns = found.point.motion.turns * (doubles ? 2 : 1);
      if (turns > asked_.turns || known(found, turns)) continue;
      ContinuationOptions options = options_;
      options.motion.turns = found.point.motion.turns;
      const std::vector<BranchPoint> starts = branches_at(system_, found, options);
      options.motion.turns = turns;
      for (const BranchPoint& start : starts) {
        if (!doubles && passed(start.motion)) continue;
        Stopwatch watch;
        Branch branch = follow_branch(system_, start, options);
        note(branch, watch.seconds());
        add_branch(std::move(branch), &found);
      }
    }
  }

  // A doubled branch that was followed ends where another one begins.
  bool known(const Bifurcation& found, int turns) const {
    const double range = options_.high - options_.low;
    return std::ranges::any_of(joined_, [&](const auto& end) {
      return end.first == turns && std::abs(end.second - found.point.motion.parameter) <= 0.01 * range;
    });
  }

  // A point of a branch that is there already.
  bool passed(const PeriodicMotion& motion) const {
    const RodPeaks here = peaks(motion.q);
    const double x = motion.parameter;
    for (const NonlinearBranch& branch : result_.branches) {
      if (branch.turns != motion.turns) continue;
      for (std::size_t i = 1; i < branch.points.size(); ++i) {
        const NonlinearPoint &a = branch.points[i - 1], &b = branch.points[i];
        if ((a.x < x) == (b.x < x)) continue;
        const double share = (x - a.x) / (b.x - a.x);
        bool near = true;
        for (std::size_t r = 0; r < here.size(); ++r) {
          const double size = *std::ranges::max_element(here[r]),
                       at = (1 - share) * a.max_abs[r][0] + share * b.max_abs[r][0];
          near = near && std::abs(at - here[r][0]) <= same_place * size;
        }
        if (near) return true;
      }
    }
    return false;
  }

  // The verdict on one side of a fold, past the points too near to it to tell.
  static Verdict beside(const std::vector<NonlinearPoint>& points, std::size_t from, int step) {
    constexpr std::size_t most = 8;
    std::size_t at = from;
    for (std::size_t k = 0; k < most && at < points.size(); ++k, at += static_cast<std::size_t>(step)) {
      if (!points[at].stability) break;
      if (points[at].stability->verdict != Verdict::undecided) return points[at].stability->verdict;
    }
    return Verdict::undecided;
  }

  void find_jumps() {
    for (const NonlinearEvent& fold : result_.folds) {
      const std::vector<NonlinearPoint>& points = result_.branches[fold.branch].points;
      const bool stable =
          beside(points, fold.after, -1) == Verdict::stable || beside(points, fold.after + 1, 1) == Verdict::stable;
      if (!stable) continue;
      Jump jump{fold.x, fold.speed, fold.error, points[fold.after].x < fold.x, fold.max_abs, {}};
      for (std::size_t b = 0; b < result_.branches.size(); ++b) add_stable_at(jump, b);
      result_.jumps.push_back(std::move(jump));
    }
    std::ranges::stable_sort(result_.jumps, {}, &Jump::x);
  }

  // Where branch b passes the jump's x in a stable motion.
  void add_stable_at(Jump& jump, std::size_t b) const {
    const auto stable = [](const NonlinearPoint& p) { return p.stability && p.stability->verdict == Verdict::stable; };
    const std::vector<NonlinearPoint>& points = result_.branches[b].points;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const NonlinearPoint &from = points[i - 1], &to = points[i];
      if ((from.x < jump.x) == (to.x < jump.x) || !stable(from) || !stable(to)) continue;
      const double share = (jump.x - from.x) / (to.x - from.x);
      RodPeaks peaks = from.max_abs;
      for (std::size_t r = 0; r < peaks.size(); ++r)
        for (std::size_t k = 0; k < peaks[r].size(); ++k)
          peaks[r][k] += share * (to.max_abs[r][k] - from.max_abs[r][k]);
      jump.to.push_back(std::move(peaks));
    }
  }

  void find_passages() {
    const std::vector<double>& values = scene_.axis().values;
    result_.followed.resize(values.size());
    if (!from_below_) return;
    const std::vector<NonlinearPoint>& points = result_.branches.front().points;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto place = std::ranges::find_if(points, [&](const NonlinearPoint& p) {
        return p.asked && std::abs(p.x - values[k]) <= 1e-12 * std::abs(values[k]);
      });
      if (place != points.end()) result_.followed[k] = {0, static_cast<std::size_t>(place - points.begin())};
    }
  }

  // Shape and stress of the bent rods, bearings, frame and drive at the values asked for.
  void add_loads() {
    Settings settings = scene_.settings();
    const bool shape = settings.only.shape, reactions = settings.only.reactions;
    if (!shape && !reactions) return;
    settings.only = {.steady = false, .stability = false, .reactions = reactions, .shape = shape};
    Stopwatch watch;
    for (NonlinearBranch& branch : result_.branches)
      for (NonlinearPoint& point : branch.points) {
        if (!point.motion || stopped()) continue;
        const ScenePlace place = scene_.at(point.x);
        if (!place.model) continue;
        const NonlinearResult answer =
            nonlinear_answer(*place.model, *point.motion, std::nullopt, result_.tolerance, settings, asked_.stop);
        for (const NonlinearRod& rod : answer.rods)
          if (shape)
            point.loads.push_back({rod.shape->deflection.max_abs, rod.shape->bending_moment.max_abs, rod.peak_errors,
                                   *rod.stress, rod.cycle});
        if (const std::optional<MachineLoads> loads =
                machine_loads(*place.model->linkage(), answer, LoadDetail::largest)) {
          result_.joints.clear();
          for (const BearingLoad& load : loads->bearings) result_.joints.push_back(load.joint);
          point.machine = machine_point(*loads, answer.speed);
        }
      }
    result_.stages.push_back({"shape, stress and forces of the motions", watch.seconds(), ""});
  }

  const SweepScene& scene_;
  const NonlinearSweepOptions& asked_;
  NonlinearSystem system_;
  ContinuationOptions options_;
  std::vector<Index> modes_;
  NonlinearSweep result_;
  std::vector<Bifurcation> leaving_;
  std::vector<std::pair<int, double>> joined_;
  bool from_below_ = false;  // the first branch is the one from the axis' first value
};

}  // namespace

void require_nonlinear(const SweepScene& scene, const NonlinearSweepOptions& options) {
  require_nonlinear(scene.first(), options.turns);
  Index num_unknowns = 0;
  for (const RodModel& rod : scene.first().rods) num_unknowns += rod.system.num_modes();
  const double low = scene.axis().values.front(), high = scene.axis().values.back();
  for (const BranchStart& start : options.starts) {
    if (!(start.x >= low && start.x <= high))
      throw RequestError("start", fmt::format("{} = {:.8g}", scene.axis().path, start.x),
                         fmt::format("{:.8g} to {:.8g}", low, high));
    if (start.q.num_components() != num_unknowns)
      throw RequestError("start", fmt::format("a motion of {} modes", start.q.num_components()),
                         fmt::format("{}, of all elastic links together", num_unknowns));
    if (start.turns < 1) throw RequestError("start", fmt::format("{} turns", start.turns), "at least one");
  }
  if (scene.axis().values.size() < 2) throw RequestError("rpm", "one speed", "a range");
}

NonlinearSweep nonlinear_sweep(const SweepScene& scene, const NonlinearSweepOptions& options) {
  require_nonlinear(scene, options);
  return Sweeper(scene, options).run();
}

}  // namespace hb
