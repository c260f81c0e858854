#include "hb/engine/nonlinear/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hb/engine/nonlinear/bifurcation_search.hpp"
#include "hb/engine/nonlinear/branch_tracer.hpp"

namespace hb {

using Eigen::Index;
using nonlinear::between;
using nonlinear::BranchTracer;
using nonlinear::combination;
using nonlinear::CorrectionStatus;
using nonlinear::Metric;
using nonlinear::place_of;
using nonlinear::tangent_of;
using nonlinear::Trace;
using nonlinear::Unknowns;

namespace {

// Wanted of a step, by experience with resonance curves: first contraction of the corrections (with the factors of the
// point before, so that 0.05 would allow steps of a twentieth of a resonance's half width), distance from prediction to
// point over the step, angle between tangents (rad). Beyond `most_angle` or `most_miss` a step is taken again.
constexpr double wanted_contraction = 0.25, wanted_miss = 0.02, wanted_angle = 0.15;
constexpr double most_angle = 0.5, most_miss = 0.2;

void check_options(const NonlinearSystem& system, const ContinuationOptions& options) {
  validate(system);
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("ContinuationOptions: ") + what);
  };
  require(options.low < options.high, "low must be below high");
  require(options.direction == 1 || options.direction == -1, "direction must be +1 or -1");
  require(options.least_step > 0 && options.least_step <= options.first_step && options.first_step <= options.most_step,
          "0 < least_step <= first_step <= most_step");
  require(options.max_points >= 1, "max_points must be at least 1");
  require(options.motion.tolerance > 0, "motion.tolerance must be positive");
  require(options.motion.turns >= 1, "motion.turns must be at least 1");
}

class Follower {
 public:
  Follower(const NonlinearSystem& system, const ContinuationOptions& options)
      : system_(system), options_(with_stop(options)), tracer_(system, options_) {
    branch_.turns = options.motion.turns;
  }

  // From a motion at its own parameter; from a point of a branch along it, where it may be a fold.
  Branch run(const Unknowns& start, const Unknowns& direction, bool hold_parameter, Index num_harmonics) {
    tracer_.set_harmonics(num_harmonics);
    Trace first = hold_parameter ? tracer_.trace_at_parameter(start, direction, options_.stability)
                                 : tracer_.trace(start, direction, false, options_.stability);
    if (first.status != CorrectionStatus::converged) return ended(end_of(first));
    first.point.stop = hold_parameter && std::ranges::count(options_.stops, start.p) > 0;
    branch_.points.push_back(std::move(first.point));
    double step = options_.first_step;
    while (true) {
      if (options_.stop && options_.stop()) return ended(BranchEnd::stopped);
      if (int(branch_.points.size()) >= options_.max_points) return ended(BranchEnd::points);
      const BranchPoint last = branch_.points.back();
      if (reaches_limit(last, step)) return ended(BranchEnd::range);
      std::optional<Trace> next = advance(last, step);
      if (!next) return ended(end_);
      BranchPoint point = std::move(next->point);
      before_last_ = last;
      const bool outside = !(point.motion.parameter >= options_.low && point.motion.parameter <= options_.high);
      if (joins(last, point)) return ended(BranchEnd::joined);
      const bool closed = comes_back(last, point);
      search(last, point);
      add_stops(last, point, outside);
      if (outside || (options_.end_at_stop && branch_.points.back().stop)) return ended(BranchEnd::range);
      if (closed) return ended(BranchEnd::closed);
      branch_.points.push_back(std::move(point));
      if (options_.reached) options_.reached(branch_.points.back().motion.parameter);
      fit_harmonics();
    }
  }

 private:
  static ContinuationOptions with_stop(ContinuationOptions options) {
    if (!options.motion.stop) options.motion.stop = options.stop;
    return options;
  }

  Branch ended(BranchEnd end) {
    branch_.end = end;
    branch_.evaluations = tracer_.evaluations();
    branch_.factorisations = tracer_.factorisations();
    return std::move(branch_);
  }

  BranchEnd end_of(const Trace& trace) {
    if (trace.failure) branch_.failure = trace.failure;
    if (trace.status == CorrectionStatus::stopped) return BranchEnd::stopped;
    return trace.status == CorrectionStatus::no_residual ? BranchEnd::no_residual : BranchEnd::no_convergence;
  }

  // x(s) = x + s t + s^2/2 (t - t_before)/(s - s_before).
  Unknowns predicted(const BranchPoint& last, double step) const {
    Unknowns x = combination(1, place_of(last), step, tangent_of(last));
    if (!before_last_ || !(last.arc > before_last_->arc)) return x;
    const double curvature = step * step / 2 / (last.arc - before_last_->arc);
    return combination(1, x, curvature, combination(1, tangent_of(last), -1, tangent_of(*before_last_)));
  }

  // The next point, with the step halved until it is near enough, and the step after it.
  std::optional<Trace> advance(const BranchPoint& last, double& step) {
    const Unknowns direction = tangent_of(last);
    const Metric metric = tracer_.metric(place_of(last));
    const double range = options_.high - options_.low;
    const double most_parameter = options_.most_parameter_step > 0 ? options_.most_parameter_step : range / 40;
    step = std::min({step, options_.most_step, most_parameter / std::max(std::abs(direction.p), 1e-300)});
    bool fresh_start = false;
    for (;;) {
      Trace trace = tracer_.trace(predicted(last, step), direction, !fresh_start, options_.stability);
      if (trace.status == CorrectionStatus::stopped) {
        end_ = end_of(trace);
        return std::nullopt;
      }
      double factor = 0;
      if (trace.status == CorrectionStatus::converged) {
        const Unknowns t = tangent_of(trace.point);
        const double cosine = metric.product(direction, t) / (metric.length(direction) * metric.length(t));
        const double left = 10 * options_.motion.tolerance;  // of the corrections
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
        const double miss = std::max(0.0, trace.moved - left) / step;
        if (angle <= most_angle && miss <= most_miss) {
          const Unknowns moved = combination(1, place_of(trace.point), -1, place_of(last));
          trace.point.arc = last.arc + metric.length(moved);
          factor = std::min({wanted_angle / std::max(angle, 1e-3), std::sqrt(wanted_miss / std::max(miss, 1e-6)),
                             std::sqrt(wanted_contraction / std::max(trace.contraction, 1e-6))});
          step *= std::clamp(factor, 0.5, 2.0);
          return trace;
        }
      }
      if (trace.failure) {
        met_ = trace.failure;
        met_arc_ = last.arc + step;
      }
      // Factors are those of the point that was not taken.
      fresh_start = true;
      step /= trace.status == CorrectionStatus::converged ? 2 : 4;
      if (step < options_.least_step) {
        const bool beside = met_ && met_arc_ - last.arc <= 1e3 * options_.least_step;
        if (beside) branch_.failure = met_;
        end_ = beside ? BranchEnd::no_residual : BranchEnd::no_convergence;
        return std::nullopt;
      }
    }
  }

  // Where the next step leads out of the range: the point at its end, and all that lies before it. False if that is not
  // the branch's next point; then it is left to the steps.
  bool reaches_limit(const BranchPoint& last, double step) {
    const double p = predicted(last, step).p;
    if (p >= options_.low && p <= options_.high) return false;
    const double limit = p > options_.high ? options_.high : options_.low;
    if (last.motion.parameter == limit) return true;
    double inside = 0, outside = step;
    for (int i = 0; i < 40; ++i) {
      const double middle = (inside + outside) / 2, at = predicted(last, middle).p;
      (at >= options_.low && at <= options_.high ? inside : outside) = middle;
    }
    Unknowns guess = predicted(last, outside);
    guess.p = limit;
    const Unknowns direction = tangent_of(last);
    Trace trace = tracer_.trace_at_parameter(guess, direction, options_.stability);
    if (trace.status != CorrectionStatus::converged) return false;
    const Metric metric = tracer_.metric(place_of(last));
    const double length = metric.length(combination(1, place_of(trace.point), -1, place_of(last)));
    const Unknowns t = tangent_of(trace.point);
    const double cosine = metric.product(direction, t) / (metric.length(direction) * metric.length(t));
    if (!(trace.moved <= most_miss * std::max(length, options_.least_step) && cosine >= std::cos(most_angle)))
      return false;
    trace.point.arc = last.arc + length;
    trace.point.stop = true;
    search(last, trace.point);
    add_stops(last, trace.point, false);
    branch_.points.push_back(std::move(trace.point));
    return true;
  }

  void search(const BranchPoint& a, const BranchPoint& b) {
    for (Bifurcation& found : nonlinear::bifurcations_between(tracer_, a, b, options_.location_tolerance)) {
      const double p = found.point.motion.parameter;
      if (!(p >= options_.low && p <= options_.high)) continue;
      found.after = branch_.points.size() - 1;
      branch_.bifurcations.push_back(std::move(found));
    }
  }

  // Points at the parameters wanted between a and b, in the order of the arc; at the end of the range as well.
  void add_stops(const BranchPoint& a, const BranchPoint& b, bool outside) {
    std::vector<double> wanted = options_.stops;
    if (outside) {
      std::erase_if(wanted, [&](double p) { return !(p > options_.low && p < options_.high); });
      wanted.push_back(b.motion.parameter > options_.high ? options_.high : options_.low);
    }
    struct Passage {
      double s, p;
    };
    std::vector<Passage> passages;
    constexpr int pieces = 64;
    const double length = b.arc - a.arc;
    double before = a.motion.parameter;
    for (int i = 1; i <= pieces; ++i) {
      const double s = length * i / pieces;
      const double p = i == pieces ? b.motion.parameter : nonlinear::parameter_between(a, b, s);
      for (const double stop : wanted)
        if ((before < stop) != (p < stop) && stop != before && stop != b.motion.parameter) {
          const double share = (stop - before) / (p - before);
          passages.push_back({s - (1 - share) * length / pieces, stop});
        }
      before = p;
    }
    std::stable_sort(passages.begin(), passages.end(), [](const Passage& x, const Passage& y) { return x.s < y.s; });
    const Unknowns direction = combination(1, tangent_of(a), 1, tangent_of(b));
    for (const auto& [s, p] : passages) {
      if (options_.stop && options_.stop()) return;
      Unknowns guess = between(a, b, s);
      guess.p = p;
      Trace trace = tracer_.trace_at_parameter(guess, direction, options_.stability);
      // Newton's method at a given parameter may leave the neighbourhood near a fold.
      if (trace.status != CorrectionStatus::converged || !(trace.moved <= length)) continue;
      trace.point.arc = a.arc + s;
      trace.point.stop = true;
      branch_.points.push_back(std::move(trace.point));
      if (outside && p == wanted.back()) return;
    }
  }

  // Whether what sets the motion apart from one of half as many turns, its odd harmonics, passes zero.
  bool joins(const BranchPoint& a, const BranchPoint& b) const {
    if (branch_.turns % 2 != 0) return false;
    const Eigen::MatrixXcd &c = a.motion.q.c, &d = b.motion.q.c;
    double product = 0, size = 0;
    for (Index k = 1; k < std::min(c.cols(), d.cols()); k += 2) {
      product += c.col(k).dot(d.col(k)).real();
      size += d.col(k).squaredNorm();
    }
    return product < 0 && size > 0;
  }

  // Whether the start lies on the way from a to b, in the same direction.
  bool comes_back(const BranchPoint& a, const BranchPoint& b) const {
    constexpr int fewest = 8;
    if (int(branch_.points.size()) < fewest) return false;
    const BranchPoint& start = branch_.points.front();
    const Metric metric = tracer_.metric(place_of(start));
    const Unknowns t = tangent_of(start), from_a = combination(1, place_of(start), -1, place_of(a)),
                   to_b = combination(1, place_of(b), -1, place_of(start));
    const double ahead = metric.product(t, from_a), behind = metric.product(t, to_b), length = b.arc - a.arc;
    if (!(ahead > 0 && behind >= 0 && ahead + behind <= 1.5 * length)) return false;
    const Unknowns nearest = between(a, b, length * ahead / (ahead + behind));
    return metric.length(combination(1, nearest, -1, place_of(start))) <= 0.1 * length;
  }

  // Fewer harmonics where the motion has become simpler.
  void fit_harmonics() {
    const Index needed = tracer_.harmonics_needed(), H = tracer_.num_harmonics();
    if (H > 8 && 3 * (needed + 2) < 2 * H) tracer_.set_harmonics(std::max<Index>(8, needed + needed / 8 + 2));
  }

  const NonlinearSystem& system_;
  ContinuationOptions options_;
  BranchTracer tracer_;
  Branch branch_;
  std::optional<BranchPoint> before_last_;
  BranchEnd end_ = BranchEnd::no_convergence;
  std::optional<EvaluationFailure> met_;  // where the equations ended last, and how far along the arc
  double met_arc_ = 0;
};

}  // namespace

Branch follow_branch(const NonlinearSystem& system, const PeriodicMotion& start, const ContinuationOptions& options) {
  check_options(system, options);
  Branch nothing;
  nothing.turns = options.motion.turns;
  nothing.end = BranchEnd::no_convergence;
  nothing.failure = start.failure;
  if (start.status != MotionStatus::converged && start.status != MotionStatus::not_reached) return nothing;
  if (start.turns != options.motion.turns)
    throw std::invalid_argument("follow_branch: the start has another number of turns than the options");
  const Unknowns x{nonlinear::to_unknowns(start.q, start.q.num_harmonics()), start.parameter};
  const Unknowns ahead{Eigen::VectorXd::Zero(x.u.size()), double(options.direction)};
  return Follower(system, options).run(x, ahead, true, start.num_harmonics);
}

Branch follow_branch(const NonlinearSystem& system, const BranchPoint& start, const ContinuationOptions& options) {
  check_options(system, options);
  if (start.motion.turns != options.motion.turns)
    throw std::invalid_argument("follow_branch: the start has another number of turns than the options");
  return Follower(system, options).run(place_of(start), tangent_of(start), false, start.motion.num_harmonics);
}

BranchPoint reversed(BranchPoint point) {
  point.tangent.c = -point.tangent.c;
  point.parameter_tangent = -point.parameter_tangent;
  return point;
}

const char* to_string(BifurcationKind kind) {
  switch (kind) {
    case BifurcationKind::fold:
      return "fold";
    case BifurcationKind::branch_point:
      return "branch point";
    case BifurcationKind::period_doubling:
      return "period doubling";
    case BifurcationKind::neimark_sacker:
      return "Neimark-Sacker";
  }
  return "";
}

const char* to_string(BranchEnd end) {
  switch (end) {
    case BranchEnd::range:
      return "end of the range";
    case BranchEnd::closed:
      return "closed";
    case BranchEnd::joined:
      return "a motion of half as many turns";
    case BranchEnd::no_residual:
      return "the equations do not exist beyond";
    case BranchEnd::no_convergence:
      return "no convergence with the shortest step";
    case BranchEnd::points:
      return "number of points";
    case BranchEnd::stopped:
      return "stopped";
  }
  return "";
}

}  // namespace hb
