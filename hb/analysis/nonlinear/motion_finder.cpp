#include "hb/analysis/nonlinear/motion_finder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"

namespace hb {

using Eigen::Index;

namespace {

// Below this theory error at every lower speed the linear answer starts Newton's method on the branch from low speed.
constexpr double most_theory_error = 0.01;
// Of the motions on the way: enough to stay on the branch; where doublings are sought, enough to locate and leave them.
constexpr double way_tolerance = 1e-5, doubling_tolerance = 1e-8;
// A resonance curve with its folds takes some hundred.
constexpr int most_points = 600;

}  // namespace

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

MotionFinder::MotionFinder(const SceneModel& model, double speed, double tolerance, const NonlinearOptions& options,
                           NonlinearResult& result)
    : model_(model), speed_(speed), options_(options), result_(result) {
  for (const RodModel& rod : model.rods) modes_.push_back(rod.num_modes);
  exact_ = with_modes(modes_);
  system_ = exact_system(exact_);
  motion_options_.tolerance = std::max(tolerance, least_motion_tolerance);
  motion_options_.stop = options.stop;
}

void MotionFinder::find_from(const FourierSeries& near) {
  MotionOptions options = motion_options_;
  options.turns = options_.turns;
  PeriodicMotion motion = solve_periodic_motion(system_, speed_, near, options);
  if (!usable(motion, speed_)) return;
  result_.motion = std::move(motion);
  result_.search = MotionSearch::found;
}

// A motion of as many turns as asked for at the speed, or why there is none.
void MotionFinder::find() {
  const std::optional<double> start = starting_speed();
  if (!start) {
    result_.why = "no speed was found at which the linear theory holds, from which a branch could be followed";
    if (const std::string reason = linear_errors(speed_).reason; !reason.empty())
      result_.why += fmt::format(": at {:.6g} rpm the linear answer's {}", rpm(speed_), reason);
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
void MotionFinder::look_for_others() {
  if (options_.turns > 1) return;
  for (const FourierSeries& start : {linear_answer(speed_), FourierSeries()}) {
    if (stopped()) return;
    add_other(solve_periodic_motion(system_, speed_, start, motion_options_));
  }
}

// The same motion with half as many harmonics again.
std::optional<PeriodicMotion> MotionFinder::with_more_harmonics() const {
  MotionOptions options = motion_options_;
  options.turns = options_.turns;
  options.num_harmonics = std::min(options.max_harmonics, result_.motion.num_harmonics * 3 / 2 + 8);
  PeriodicMotion motion = solve_periodic_motion(system_, speed_, result_.motion.q, options);
  if (motion.status != MotionStatus::converged) return std::nullopt;
  return motion;
}

std::optional<std::vector<FourierSeries>> motion_with_more_modes(const ExactModel& exact, double speed,
                                                                 const PeriodicMotion& motion, MotionOptions options) {
  std::vector<ExactModel::Rod> rods;
  std::vector<FourierSeries> start;
  for (std::size_t r = 0; r < exact.rods().size(); ++r) {
    const auto& [link, I] = exact.rods()[r];
    rods.push_back({link, more_modes(I)});
    start.emplace_back(more_modes(I), motion.q.num_harmonics());
    start.back().c.topRows(I) = motion.q.c.middleRows(exact.first_mode(r), I);
  }
  const auto finer = std::make_shared<const ExactModel>(exact.linkage(), rods);
  options.turns = motion.turns;
  const PeriodicMotion found = solve_periodic_motion(exact_system(finer), speed, stacked(start), options);
  if (found.status != MotionStatus::converged && found.status != MotionStatus::not_reached) return std::nullopt;
  std::vector<FourierSeries> q;
  for (std::size_t r = 0; r < rods.size(); ++r)
    q.emplace_back(Eigen::MatrixXcd(found.q.c.middleRows(finer->first_mode(r), rods[r].num_modes)));
  return q;
}

std::optional<std::vector<FourierSeries>> MotionFinder::with_more_modes() const {
  return motion_with_more_modes(*exact_, speed_, result_.motion, motion_options_);
}

std::shared_ptr<const ExactModel> MotionFinder::with_modes(const std::vector<Index>& modes) const {
  std::vector<ExactModel::Rod> rods;
  for (std::size_t r = 0; r < modes.size(); ++r) rods.push_back({model_.rods[r].link, modes[r]});
  return std::make_shared<const ExactModel>(*model_.linkage(), rods);
}

FourierSeries MotionFinder::linear_answer(double speed) const {
  std::vector<FourierSeries> q;
  for (const RodModel& rod : model_.rods) {
    SteadyState state = solve_steady_state(rod.system, speed, {.tolerance = 1e-8});
    if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return {};
    q.push_back(std::move(state.q));
  }
  return stacked(q);
}

TheoryErrors MotionFinder::linear_errors(double speed) const {
  std::vector<FourierSeries> q;
  std::vector<LinearRod> linear;
  for (const RodModel& rod : model_.rods) q.push_back(solve_steady_state(rod.system, speed, {.tolerance = 1e-8}).q);
  for (std::size_t r = 0; r < q.size(); ++r) linear.push_back({&model_.rods[r].system, &q[r]});
  return theory_errors(*exact_, speed, linear);
}

bool MotionFinder::weakly_bent(double speed) const {
  return std::ranges::all_of(linear_errors(speed).rods,
                             [](const TheoryErrors::Rod& rod) { return rod.q && *rod.q <= most_theory_error; });
}

std::optional<double> MotionFinder::starting_speed() const {
  constexpr int steps = 24;
  constexpr double lowest = 0.1;  // of the speed asked for
  std::optional<double> start;
  for (int k = 0; k <= steps; ++k) {
    const double speed = k == steps ? speed_ : speed_ * std::pow(lowest, 1 - static_cast<double>(k) / steps);
    if (!weakly_bent(speed)) break;
    start = speed;
  }
  for (double speed = lowest * speed_ / 2; !start && speed > 1e-4 * speed_; speed /= 2)
    if (weakly_bent(speed)) start = speed;
  return start;
}

bool MotionFinder::usable(const PeriodicMotion& motion, double at) {
  if (motion.status == MotionStatus::converged || motion.status == MotionStatus::not_reached) return true;
  result_.search = motion.status == MotionStatus::stopped ? MotionSearch::stopped : MotionSearch::none;
  result_.why = fmt::format("no motion was found at {:.6g} rpm: {}{}", rpm(at), to_string(motion.status),
                            motion.failure ? ": " + motion.failure->reason : "");
  return false;
}

ContinuationOptions MotionFinder::continuation(double from) const {
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

void MotionFinder::follow(const PeriodicMotion& first, double from) {
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
  find_from(passage->motion.q);
}

void MotionFinder::count_folds(const Branch& branch, std::size_t point) {
  for (const Bifurcation& found : branch.bifurcations)
    result_.folds += found.kind == BifurcationKind::fold && found.after < point;
}

const BranchPoint* MotionFinder::passage_of(const Branch& branch) const {
  const auto place = std::ranges::find_if(branch.points, [&](const BranchPoint& p) { return at_speed(p); });
  return place == branch.points.end() ? nullptr : &*place;
}

void MotionFinder::follow_doublings(const Branch& to_speed, ContinuationOptions options) {
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

bool MotionFinder::doubled(const Branch& branch, const ContinuationOptions& options) {
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
      find_from(passage->motion.q);
      return true;
    }
  }
  return false;
}

void MotionFinder::no_way(const Branch& branch) {
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

void MotionFinder::note_last(const Branch& branch) {
  if (branch.points.empty()) return;
  result_.last_speed = branch.points.back().motion.speed;
  result_.last_max_abs = sizes(branch.points.back().motion.q);
}

RodPeaks MotionFinder::sizes(const FourierSeries& q) const {
  RodPeaks values(modes_.size());
  for (std::size_t r = 0; r < modes_.size(); ++r)
    for (Index i = 0; i < modes_[r]; ++i) values[r].push_back(fourier::max_abs(q, exact_->first_mode(r) + i).value);
  return values;
}

void MotionFinder::add_other(const PeriodicMotion& motion) {
  if (motion.status != MotionStatus::converged) return;
  OtherMotion other{sizes(motion.q), std::nullopt};
  if (result_.search == MotionSearch::found && same_motion(other.max_abs, sizes(result_.motion.q))) return;
  for (const OtherMotion& known : result_.others)
    if (same_motion(other.max_abs, known.max_abs)) return;
  if (result_.computed.stability) other.verdict = motion_stability(system_, motion).verdict;
  result_.others.push_back(std::move(other));
}

}  // namespace hb
