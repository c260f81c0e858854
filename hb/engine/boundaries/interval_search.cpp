#include "hb/engine/boundaries/interval_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <span>

#include "hb/engine/boundaries/boundary_location.hpp"
#include "hb/engine/boundaries/doubts.hpp"
#include "hb/engine/boundaries/mirror_images.hpp"
#include "hb/engine/boundaries/place_models.hpp"
#include "hb/engine/boundaries/undamped_locks.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

// Intervals are not divided below this, relative to x: narrower bands are not looked for.
constexpr double least_width = 2e-9;
constexpr int most_divisions = 48;
// Of exponents where growth is far from zero.
constexpr double rough_tolerance = 1e-7;
constexpr int most_evaluations = 200, most_evaluations_per_boundary = 50;

struct Cell {
  double from, to;  // places
  int divisions = 0;
  bool operator<(const Cell& other) const {
    const double width = to - from, other_width = other.to - other.from;
    return width != other_width ? width < other_width : from > other.from;
  }
};

class Search {
 public:
  Search(const SystemAt& at, const SweepOptions& options)
      : at_(at), options_(options), coupling_(at, options), doubts_(places_, coupling_) {
    located_ = options;
    located_.stability.leading_only = true;
  }

  SearchedInterval run(const StabilitySample& a, const StabilitySample& b, const StabilitySample* before,
                       const StabilitySample* after, std::span<const StabilitySample> farther) {
    if (bounded_in_a_row({before, &a, &b, after})) return {};
    if (!is_unstable(a) && !is_unstable(b) && bounded(a, b)) return {};
    if (is_unstable(a) && is_unstable(b) && excludes_gaps(at_, a, b)) return {};
    for (const StabilitySample& sample : farther) places_.emplace(sample.x, place_of(sample, at_));
    for (const StabilitySample* sample : {before, &a, &b, after})
      if (sample != nullptr) places_.emplace(sample->x, place_of(*sample, at_));
    first_ = a.x;
    last_ = b.x;
    cells_.push({a.x, b.x, 0});
    while (!cells_.empty()) {
      const Cell cell = cells_.top();
      cells_.pop();
      if (places_.at(cell.from).unstable != places_.at(cell.to).unstable)
        split_at_boundary(cell);
      else
        settle(cell);
    }
    return result();
  }

 private:
  bool evaluate(double x) {
    ++evaluations_;
    const std::optional<ScaledSystem> system = at_(x);
    if (!system) return false;
    const auto above = places_.lower_bound(x);
    if (suffices_ && evaluate_leading(*system, x)) return true;
    StabilityOptions options = options_.stability;
    if (above != places_.end() && above != places_.begin() && is_far_from_zero(above->second.growth()) &&
        is_far_from_zero(std::prev(above)->second.growth())) {
      options.tolerance = std::max(options.tolerance, rough_tolerance);
      options.growth_suffices = true;
    }
    std::optional<StabilitySample> sample = stability_sample(*system, x, options);
    if (options.growth_suffices &&
        !(sample->stability.converged && is_far_from_zero(sample->stability.growth_rate / sample->speed)))
      sample = stability_sample(*system, x, options_.stability);
    if (!std::isfinite(sample->stability.growth_rate)) return false;
    places_.emplace(x, place_of(*sample, at_));
    return true;
  }

  // The leading exponents alone, where they are apart from the others and the verdict is certain.
  bool evaluate_leading(const ScaledSystem& system, double x) {
    StabilityOptions options = options_.stability;
    options.leading_only = options.as_found = options.growth_suffices = true;
    const StabilitySample sample = stability_sample(system, x, options);
    if (sample.stability.verdict == Verdict::undecided) return false;
    const Place place = place_of(sample, at_);
    if (!suffices(place)) return false;
    places_.emplace(x, place);
    return true;
  }

  bool suffices(const Place& place) const { return is_apart(place, Apart::pair) || is_apart(place, *suffices_); }

  // All exponents at a place where the leading ones are known.
  void complete(Place& place) {
    if (completed_.contains(place.x()) || !is_partial(place.sample)) return;
    completed_.insert(place.x());
    ++evaluations_;
    std::optional<StabilitySample> sample = stability_sample(at_, place.x(), options_.stability);
    if (!sample || !std::isfinite(sample->stability.growth_rate)) return;
    const bool unstable = place.unstable;
    place = place_of(*sample, at_);
    place.unstable = unstable;
    forget_continued(place.x());
  }

  void forget_continued(double x) const {
    for (const auto& known : places_) known.second.continued_at.erase(x);
  }

  static bool is_partial(const StabilitySample& sample) {
    return sample.stability.exponents.size() + sample.stability.uncertain.size() < sample.mean.size();
  }

  // With those beside them that models may take.
  void complete_near(Place& p, Place& q) {
    complete(p);
    complete(q);
    auto below = places_.find(p.x()), above = places_.find(q.x());
    for (int k = 0; k < 2 && below != places_.begin(); ++k) complete((--below)->second);
    for (int k = 0; k < 2 && std::next(above) != places_.end(); ++k) complete((++above)->second);
  }

  void give_up(const Cell& cell) { not_excluded_.push_back({cell.from, cell.to}); }

  // --- A change of verdict in the cell ---

  static bool is_open(const Place& place) { return place.sample.stability.verdict == Verdict::undecided; }

  // As far as the next place that is surely not unstable, where the cell's end on that side is not sure.
  Cell to_sure_end(Cell cell) const {
    auto low = places_.find(cell.from), high = places_.find(cell.to);
    while (is_open(low->second) && low->first > first_ && !std::prev(low)->second.unstable) --low;
    while (is_open(high->second) && high->first < last_ && !std::next(high)->second.unstable) ++high;
    if (!is_open(low->second)) cell.from = low->first;
    if (!is_open(high->second)) cell.to = high->first;
    return cell;
  }

  void split_at_boundary(const Cell& found_in) {
    const Cell cell = to_sure_end(found_in);
    const Place &p = places_.at(cell.from), &q = places_.at(cell.to);
    const std::vector<const Place*> places = apart_beside(places_, p, q, Apart::pair);
    const BoundaryLocation found = locate(at_, p.sample, q.sample, located_, expected_change(places));
    StabilityBoundary boundary = found.boundary;
    suffices_.reset();
    for (const Apart what : {Apart::alone, Apart::pair})
      if (is_apart(p, what) && is_apart(q, what)) suffices_ = what;
    for (const auto* sample : {&found.below, &found.above})
      if (*sample && std::abs((*sample)->x - boundary.x) < 16 * beyond(boundary, cell)) keep(**sample);
    const double left = beside(boundary, cell, -1), right = beside(boundary, cell, 1);
    const StabilitySample& inside = places_.at(boundary.unstable_above ? right : left).sample;
    if (leading_resolved(inside.stability)) boundary.kind = boundary_kind(inside.stability, inside.speed);
    boundaries_.push_back(boundary);
    if (right < cell.to) cells_.push({right, cell.to, cell.divisions + 1});
    if (left > cell.from) cells_.push({cell.from, left, cell.divisions + 1});
  }

  // How far from a boundary places are looked at first.
  static double beyond(const StabilityBoundary& boundary, const Cell& cell) {
    return std::max(4 * boundary.error, 1e-7 * (cell.to - cell.from));
  }

  // A place beside a boundary that was computed to find that.
  void keep(StabilitySample sample) {
    const std::optional<ScaledSystem> system = at_(sample.x);
    if (!system || sample.stability.verdict == Verdict::undecided) return;
    sample.mean = mean_exponents(*system);
    const Place place = place_of(sample, at_);
    if (is_partial(sample) ? suffices_ && suffices(place) : place.strands().all.size() == place.mean().size())
      places_.emplace(sample.x, place);
  }

  // The nearest place on one side of the boundary that shows the verdict of that side.
  double beside(const StabilityBoundary& boundary, const Cell& cell, int side) {
    const double end = side < 0 ? cell.from : cell.to, room = std::abs(end - boundary.x);
    const bool unstable = boundary.unstable_above == (side > 0);
    const double least = least_width * std::abs(boundary.x);
    const double first = beyond(boundary, cell);
    double beside = end;
    const auto above = places_.upper_bound(boundary.x);
    const auto known = side > 0 ? above : std::prev(above);
    if (known->first != end && known->second.unstable == unstable) return known->first;
    for (double step = first; step < 0.5 * room; step *= 16) {
      const double x = boundary.x + side * step;
      if (places_.contains(x) || !evaluate(x)) break;
      if (places_.at(x).unstable == unstable && places_.at(x).sample.stability.verdict != Verdict::undecided) {
        beside = x;
        break;
      }
      places_.erase(x);
      forget_continued(x);
    }
    const double skipped = std::abs(beside - boundary.x);
    if (skipped > std::max(least, 2 * first)) {
      give_up({std::min(beside, boundary.x), std::max(beside, boundary.x)});
    }
    return beside;
  }

  // --- One verdict at both ends ---

  void settle(const Cell& cell) {
    const double width = cell.to - cell.from;
    if (width <= least_width * std::max(std::abs(cell.from), std::abs(cell.to))) return;
    Place &p = places_.at(cell.from), &q = places_.at(cell.to);
    const double x = doubtful(p, q);
    if (std::isnan(x)) return;
    const int affordable = most_evaluations + most_evaluations_per_boundary * static_cast<int>(boundaries_.size());
    if (cell.divisions >= most_divisions || evaluations_ >= affordable || !(x > cell.from && x < cell.to) ||
        !(places_.contains(x) || evaluate(x))) {
      give_up(cell);
      return;
    }
    cells_.push({x, cell.to, cell.divisions + 1});
    cells_.push({cell.from, x, cell.divisions + 1});
  }

  // NaN: settled; otherwise where to look.
  double doubtful(Place& p, Place& q) {
    const bool whole = p.x() == first_ && q.x() == last_;  // the search began because that does not settle it
    if (!whole && (p.unstable ? excludes_gaps(at_, p.sample, q.sample) : bounded(p.sample, q.sample))) return nan;
    for (const Apart what : {Apart::pair, Apart::alone})
      if (const std::vector<const Place*> places = apart_beside(places_, p, q, what); !places.empty())
        if (const std::optional<double> x = doubtful_while_apart(places, what, options_.least_growth)) {
          suffices_ = what;
          return std::isnan(*x) ? unforetold(p, q, places, what) : *x;
        }
    suffices_.reset();
    if (const std::optional<double> x = doubtful_while_locked(places_, p, q)) return *x;
    complete_near(p, q);
    return p.unstable ? doubts_.while_unstable(p, q) : doubts_.while_stable(p, q);
  }

  // A lock may end and begin again, with its own multiplier or that of another exponent: unless that is excluded what
  // is foretold has to hold half way. NaN: it does.
  double unforetold(const Place& p, const Place& q, const std::vector<const Place*>& places, Apart what) {
    if (stays_leading(places, what)) return nan;
    const double middle = 0.5 * (p.x() + q.x());
    if (!evaluate(middle)) return middle;
    return foretold(places, what, places_.at(middle)) ? nan : middle;
  }

  // The bound, which knows no resonances, proves stability at four places with ten times more to spare than it changes
  // over all of them.
  static bool bounded_in_a_row(const std::array<const StabilitySample*, 4>& places) {
    constexpr double ample = 10;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const StabilitySample* place : places) {
      if (place == nullptr || is_unstable(*place) || !(place->growth_bound < 0)) return false;
      low = std::min(low, place->growth_bound);
      high = std::max(high, place->growth_bound);
    }
    return high + ample * (high - low) < 0;
  }

  // A closed-form bound on the growth proves stability at both ends and between them with more to spare than it
  // changes.
  bool bounded(const StabilitySample& p, const StabilitySample& q) const {
    const double a = p.growth_bound, b = q.growth_bound;
    if (!(std::max(a, b) + std::abs(a - b) < 0)) return false;
    const std::optional<ScaledSystem> between = at_(0.5 * (p.x + q.x));
    if (!between) return false;
    const double m = growth_bound(*between);
    return std::max({a, b, m}) + std::max(std::abs(a - m), std::abs(b - m)) < 0;
  }

  // Between two places where growth is not told from none there is no gap, but there may be one.
  void drop_open_gaps() {
    for (std::size_t k = 0; k + 1 < boundaries_.size();) {
      const auto from = places_.upper_bound(boundaries_[k].x), to = places_.lower_bound(boundaries_[k + 1].x);
      const auto sure = [](const auto& place) {
        return !place.second.unstable && place.second.sample.stability.verdict != Verdict::undecided;
      };
      const auto open = [](const auto& place) { return is_open(place.second); };
      if (!boundaries_[k].unstable_above && boundaries_[k + 1].unstable_above && std::any_of(from, to, open) &&
          std::none_of(from, to, sure)) {
        const auto first = boundaries_.begin() + static_cast<std::ptrdiff_t>(k);
        not_excluded_.push_back({first->x, first[1].x});
        boundaries_.erase(first, first + 2);
      } else {
        ++k;
      }
    }
  }

  SearchedInterval result() {
    SearchedInterval found;
    found.evaluations = evaluations_;
    std::sort(boundaries_.begin(), boundaries_.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    drop_open_gaps();
    found.boundaries = boundaries_;
    for (std::size_t k = 0; k + 1 < boundaries_.size(); ++k) {
      const StabilitySample* chosen = nullptr;
      for (auto it = places_.upper_bound(boundaries_[k].x); it != places_.end() && it->first < boundaries_[k + 1].x;
           ++it)
        if (it->first > first_ && it->first < last_ && it->second.unstable == boundaries_[k].unstable_above &&
            (chosen == nullptr || (it->second.sample.stability.growth_rate > chosen->stability.growth_rate) ==
                                      boundaries_[k].unstable_above))
          chosen = &it->second.sample;
      if (chosen == nullptr) continue;
      found.samples.push_back(*chosen);
      if (const auto sharp = stability_sample(at_, chosen->x, options_.stability);
          sharp && (is_partial(*chosen) || sharp->stability.growth_error < chosen->stability.growth_error))
        found.samples.back() = *sharp;
    }
    std::sort(not_excluded_.begin(), not_excluded_.end());
    for (const std::array<double, 2>& piece : not_excluded_) {
      if (!found.not_excluded.empty() && piece[0] <= found.not_excluded.back()[1])
        found.not_excluded.back()[1] = std::max(found.not_excluded.back()[1], piece[1]);
      else
        found.not_excluded.push_back(piece);
    }
    return found;
  }

  const SystemAt& at_;
  const SweepOptions& options_;
  SweepOptions located_;
  Places places_;
  StrandCoupling coupling_;
  Doubts doubts_;
  std::set<double> completed_;  // places with all exponents that could be found
  std::optional<Apart> suffices_;  // at the next place
  std::priority_queue<Cell> cells_;  // the widest first
  std::vector<StabilityBoundary> boundaries_;
  std::vector<std::array<double, 2>> not_excluded_;
  double first_ = 0, last_ = 0;
  int evaluations_ = 0;
};

}  // namespace

SearchedInterval search_interval(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                 const StabilitySample* before, const StabilitySample* after,
                                 const SweepOptions& options, std::span<const StabilitySample> farther) {
  return Search(at, options).run(a, b, before, after, farther);
}

}  // namespace hb
