#include "hb/analysis/sweep_analysis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/sweep/point_family.hpp"
#include "hb/analysis/sweep/resonances.hpp"
#include "hb/analysis/sweep/rod_along.hpp"
#include "hb/analysis/sweep/sweep_parts.hpp"
#include "lib/constants.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

// The problem of a point that the work ended before.
constexpr const char* not_computed = "not computed before the end";

// What lies between two neighbouring points of one rod.
struct Between {
  SearchedInterval bands;
  std::vector<ResponseSample> peaks;
};

// A maximum among the samples of one rod.
struct PeakTask {
  std::size_t rod;
  Maximum maximum;
};

class SweepRun {
 public:
  SweepRun(const SweepScene& scene, Work& work)
      : scene_(scene),
        work_(work),
        settings_(scene.settings()),
        values_(scene.axis().values),
        only_(available(scene.first(), settings_.only)) {
    result_.computed = only_;
    result_.stages = scene.first().stages;
    result_.searched_bands = only_.all_exponents() && settings_.search;
    result_.searched_peaks = only_.steady && settings_.search;
    const std::vector<RodModel>& rods = scene.first().rods;
    for (std::size_t r = 0; r < rods.size(); ++r) {
      SweepRod rod;
      rod.name = rods[r].name;
      rod.reported = rods[r].reported;
      rod.num_modes = static_cast<int>(rods[r].num_modes);
      rod.num_unknowns = static_cast<int>(rods[r].system.num_modes());
      result_.rods.push_back(std::move(rod));
      along_.emplace_back(scene, r, evaluations_);
      if (rods[r].reported) reported_.push_back(r);
    }
  }

  SweepResult run() {
    points();
    between();
    bands();
    peaks();
    refine();
    tell_what_missed_its_tolerance();
    if (only_.reactions) name_joint_components();
    return std::move(result_);
  }

 private:
  static constexpr double near_pole = 1e-3;  // of the way to what is next to it

  std::size_t intervals() const { return values_.size() - 1; }

  std::string counted(const std::string& what) {
    return fmt::format("{}{} evaluations", what, evaluations_.exchange(0));
  }

  void points() {
    const Stopwatch watch;
    PointFamily family(scene_, only_);
    result_.points = work_.results<SweepPoint>(
        "sweep", values_.size(),
        [&](std::size_t k) { return work_.ends_early() ? left_out(values_[k]) : family.at(k); },
        [](auto& visit, SweepPoint& point) { visit_point(visit, point); }, "point", searching(), family.block_size());
    result_.stages.push_back({"points", watch.seconds(), fmt::format("{} points", values_.size())});
    const bool linkage = std::holds_alternative<Linkage>(scene_.scene().model);
    for (const auto& [what, asked] : {std::pair("steady states", only_.response()),
                                      {"shapes", only_.shape || !linkage},
                                      {"joint forces", only_.reactions || !linkage},
                                      {"stability", only_.stability},
                                      {"further exponents", only_.all_exponents() || !only_.stability},
                                      {"theory errors", only_.response() || !linkage}})
      if (!asked) result_.stages.push_back({what, 0, "not asked for", true});
  }

  // What will follow the points, in times that a point takes: a tenth of that was measured where points are dear, twice
  // and a half where disturbances grow fast.
  PartsAhead searching() const {
    constexpr double of_a_point = 0.4;
    if (!result_.searched_bands) return {};
    return {{"point", of_a_point * static_cast<double>(values_.size())}};
  }

  SweepPoint left_out(double x) const {
    SweepPoint point;
    point.x = x;
    const bool in_rpm = scene_.axis().kind == Axis::Kind::rpm;
    point.speed = scene_.axis().kind == Axis::Kind::omega
                      ? x
                      : speed_from_rpm(in_rpm ? x : scene_.fixed_rpm(), scene_.scene().units);
    point.problem = not_computed;
    return point;
  }

  // Narrow bands and narrow resonances between the points, each interval and rod on its own.
  void between() {
    std::vector<const SweepPoint*> grid;
    for (const SweepPoint& point : result_.points) grid.push_back(&point);
    modes_.resize(result_.rods.size());
    for (const std::size_t r : reported_) modes_[r] = tracks(result_, r, grid);

    between_.resize(intervals() * reported_.size());
    if (!result_.searched_bands) return;
    const Stopwatch watch;
    between_ = work_.results<Between>(
        "narrow bands and peaks", between_.size(),
        [this](std::size_t task) { return search(reported_[task / intervals()], task % intervals()); },
        [](auto& visit, Between& found) {
          visit_interval(visit, found.bands);
          visit_elements(visit, found.peaks, [&](ResponseSample& sample) {
            visit(sample.x);
            visit_elements(visit, sample.max_abs, visit);
          });
        });
    seconds_between_ = watch.seconds();
  }

  Between search(std::size_t r, std::size_t k) const {
    Between found;
    const SweepPoint &a = result_.points[k], &b = result_.points[k + 1];
    const bool ended = work_.ends_early() || a.problem == not_computed || b.problem == not_computed;
    if (!ended && !(a.problem.empty() && b.problem.empty())) return found;
    if (ended) {
      found.bands.not_excluded.push_back({a.x, b.x});
      return found;
    }
    const auto sample_at = [&](std::size_t place) -> const StabilitySample* {
      if (place >= values_.size() || !result_.points[place].problem.empty()) return nullptr;
      return &*result_.points[place].rods[r].stability;
    };
    found.bands = search_interval([&](double x) { return along_[r].system(x); }, *sample_at(k), *sample_at(k + 1),
                                  sample_at(k - 1), sample_at(k + 2), boundary_options(settings_));
    if (only_.steady) {
      const auto place = [&](const SweepPoint& point, std::size_t at) -> ResponsePlace {
        const RodPoint& rod = point.rods[r];
        return {point.x, point.speed, rod.num_harmonics, rod.max_abs, modes_[r][at]};
      };
      found.peaks = resonances_between(along_[r], place(a, k), place(b, k + 1));
      if (k == 0 || k + 1 == intervals())
        for (ResponseSample& sample : samples_inside(along_[r], a.x, b.x)) found.peaks.push_back(std::move(sample));
    }
    return found;
  }

  // Bands, and what may have been missed.
  void bands() {
    std::size_t num_boundaries = 0;
    if (result_.searched_bands)
      for (std::size_t i = 0; i < reported_.size(); ++i) num_boundaries += bands_of(i);
    if (only_.stability && !result_.searched_bands)
      result_.stages.push_back({"narrow bands and peaks", 0, why_not_searched(), true});
    else
      result_.stages.push_back({"narrow bands and peaks", seconds_between_,
                                counted(fmt::format("{} boundaries located, ", num_boundaries))});
  }

  std::size_t bands_of(std::size_t i) {
    const std::size_t r = reported_[i];
    SweepRod& rod = result_.rods[r];
    std::vector<const StabilitySample*> samples;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const SweepPoint& point = result_.points[k];
      samples.push_back(point.problem.empty() ? &*point.rods[r].stability : nullptr);
      if (k == intervals()) break;
      const SearchedInterval& found = between_[i * intervals() + k].bands;
      for (const StabilitySample& sample : found.samples) samples.push_back(&sample);
      rod.boundaries.insert(rod.boundaries.end(), found.boundaries.begin(), found.boundaries.end());
      for (const std::array<double, 2>& place : found.not_excluded) add_place(place, rod.not_excluded);
    }
    rod.bands = unstable_bands(samples, rod.boundaries);
    for (const StabilityBoundary& boundary : rod.boundaries) {
      if (boundary.converged) continue;
      result_.notes.push_back(fmt::format("{}: the stability boundary at {} = {:.9g} is known to +/- {:.1e} only",
                                          rod.name, scene_.axis().path, boundary.x, boundary.error));
    }
    return rod.boundaries.size();
  }

  // Touching ones are one.
  static void add_place(const std::array<double, 2>& place, std::vector<std::array<double, 2>>& places) {
    if (!places.empty() && places.back()[1] == place[0])
      places.back()[1] = place[1];
    else
      places.push_back(place);
  }

  std::string why_not_searched() const {
    return settings_.search ? "all exponents are needed, which were not asked for" : "not asked for";
  }

  // Resonance peaks, located.
  void peaks() {
    const Stopwatch watch;
    std::vector<PeakTask> tasks;
    if (result_.searched_peaks)
      for (std::size_t i = 0; i < reported_.size(); ++i) add_maxima(i, tasks);
    using MaybeCritical = std::optional<CriticalPoint>;
    const std::vector<MaybeCritical> critical = work_.results<MaybeCritical>(
        "resonance peaks", tasks.size(),
        [&](std::size_t k) -> MaybeCritical {
          if (work_.ends_early()) return std::nullopt;
          return located(tasks[k]);
        },
        [](auto& visit, MaybeCritical& point) {
          visit_if_there(visit, point, [&](CriticalPoint& there) { visit_critical(visit, there); });
        });
    for (const MaybeCritical& point : critical) {
      if (!point) continue;
      if (!point->peak.converged) {
        result_.notes.push_back(fmt::format("{}: the peak of q_{} at {} = {:.10g} is known to {:.1e} only",
                                            result_.rods[point->rod].name, point->component + 1, scene_.axis().path,
                                            point->peak.x, point->peak.error));
      }
      result_.critical.push_back(*point);
    }
    std::ranges::stable_sort(result_.critical, [](const CriticalPoint& a, const CriticalPoint& b) {
      return a.rod != b.rod ? a.rod < b.rod : a.peak.x < b.peak.x;
    });
    if (!(only_.steady && result_.searched_peaks))
      result_.stages.push_back({"resonance peaks", 0, "not asked for", true});
    else
      result_.stages.push_back(
          {"resonance peaks", watch.seconds(), counted(fmt::format("{} located, ", tasks.size()))});
  }

  // From the points and the samples between them, in runs without a gap.
  void add_maxima(std::size_t i, std::vector<PeakTask>& tasks) const {
    const std::size_t r = reported_[i];
    std::vector<ResponseSample> run;
    const auto finish = [&] {
      std::ranges::sort(run, {}, &ResponseSample::x);
      for (const Maximum& maximum : local_maxima(run, result_.rods[r].num_modes)) tasks.push_back({r, maximum});
      run.clear();
    };
    const auto add = [&](const std::vector<ResponseSample>& samples) {
      run.insert(run.end(), samples.begin(), samples.end());
    };
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const SweepPoint& point = result_.points[k];
      if (!point.rods.empty() && !point.rods[r].max_abs.empty()) {
        run.push_back({point.x, point.rods[r].max_abs});
      } else {
        const std::vector<ResponseSample> sides = beside_point(r, k);
        if (sides.empty()) finish();
        add(sides);
      }
      if (k == intervals() || run.empty()) continue;
      add(between_[i * intervals() + k].peaks);
      add(beside_boundaries(r, k));
    }
    finish();
  }

  // Of a point on a resonance without damping.
  std::vector<ResponseSample> beside_point(std::size_t r, std::size_t k) const {
    const SweepPoint& point = result_.points[k];
    if (work_.ends_early() || k == 0 || k == intervals() || point.rods.empty() ||
        point.rods[r].steady != SteadyStatus::singular)
      return {};
    return beside_pole(along_[r], point.x, near_pole * std::min(point.x - values_[k - 1], values_[k + 1] - point.x));
  }

  // Where a multiplier passes +1 the response is unbounded: of boundaries in the interval from point k.
  std::vector<ResponseSample> beside_boundaries(std::size_t r, std::size_t k) const {
    constexpr double one_pole = 1e-8;  // relative: nearer ones are found as one
    std::vector<ResponseSample> samples;
    const std::vector<StabilityBoundary>& boundaries = result_.rods[r].boundaries;
    for (const StabilityBoundary& boundary : boundaries) {
      if (work_.ends_early()) return samples;
      if (boundary.kind != BoundaryKind::plus_one || boundary.x <= values_[k] || boundary.x >= values_[k + 1]) continue;
      double free = std::min(boundary.x - values_[k], values_[k + 1] - boundary.x);
      for (const StabilityBoundary& other : boundaries)
        if (std::abs(other.x - boundary.x) > one_pole * boundary.x)
          free = std::min(free, std::abs(other.x - boundary.x));
      for (ResponseSample& sample : beside_pole(along_[r], boundary.x, near_pole * free))
        samples.push_back(std::move(sample));
    }
    return samples;
  }

  // Where a multiplier passes +1 and the response rises on both sides as the distance from there falls: its pole, known
  // as well as the boundary is.
  std::optional<ResponsePeak> pole_at_boundary(const PeakTask& task) const {
    constexpr double nearer = 0.1, alike = 0.1, clear_of_error = 100;
    const Maximum& m = task.maximum;
    const auto height = [&](double x) {
      const std::optional<FourierSeries> q = along_[task.rod].rough_response(x);
      return q ? fourier::max_abs(*q, m.component).value : nan;
    };
    const std::vector<StabilityBoundary>& boundaries = result_.rods[task.rod].boundaries;
    const auto is_inside = [&m](const StabilityBoundary& boundary) {
      return boundary.kind == BoundaryKind::plus_one && m.low < boundary.x && boundary.x < m.high;
    };
    // Of two that are near to each other the response does not tell which one it rises at.
    if (std::ranges::count_if(boundaries, is_inside) != 1) return std::nullopt;
    for (const StabilityBoundary& boundary : boundaries) {
      const double x = boundary.x, distance = std::abs(m.inside - x);
      if (!is_inside(boundary) || !boundary.converged) continue;
      if (!(boundary.error <= peak_accuracy(settings_).height * x &&
            nearer * distance > clear_of_error * boundary.error))
        continue;
      const double rise = distance * height(m.inside);
      if (!(rise > 0 && std::isfinite(rise))) continue;
      const auto rises_alike = [&](double by) {
        return std::abs(std::abs(by) * height(x + by) - rise) <= alike * rise;
      };
      if (rises_alike(x - m.inside) && rises_alike(nearer * distance) && rises_alike(-nearer * distance))
        return ResponsePeak{x, HUGE_VAL, boundary.error, true};
    }
    return std::nullopt;
  }

  std::optional<ResponsePeak> peak_of(const PeakTask& task) const {
    if (const std::optional<ResponsePeak> pole = pole_at_boundary(task)) return pole;
    const Maximum& m = task.maximum;
    const std::optional<PeakResponses> responses = along_[task.rod].responses(m.component, m.inside);
    if (!responses) return std::nullopt;
    return locate_peak(*responses, m.low, m.inside, m.high, peak_accuracy(settings_).height);
  }

  std::optional<CriticalPoint> located(const PeakTask& task) const {
    const Maximum& m = task.maximum;
    const std::optional<ResponsePeak> peak = peak_of(task);
    if (!peak) return std::nullopt;
    CriticalPoint point;
    point.rod = task.rod;
    point.component = m.component;
    point.peak = *peak;
    point.prominence = m.prominence;
    point.speed = scene_.at(peak->x).speed;
    const auto is_there = [&](const StabilityBoundary& boundary) { return boundary.x == point.peak.x; };
    // What is refined there names the others.
    if (!is_refined(point) && std::ranges::none_of(result_.rods[task.rod].boundaries, is_there)) name_alone(point);
    return point;
  }

  // By one method, unless it misses those of a mode: frequency and damping need no sign of a growth rate near zero.
  Stability exponents_of(const ScaledSystem& system, int mode) const {
    StabilityOptions options = exponent_options(settings_);
    options.one_method = true;
    Stability found = analyse_stability(system, options);
    if (std::ranges::find(found.exponents, mode, &Exponent::mode) != found.exponents.end()) return found;
    options.one_method = false;
    return analyse_stability(system, options);
  }

  void name_alone(CriticalPoint& point) const {
    if (!only_.all_exponents()) return;
    if (const std::optional<ScaledSystem> system = along_[point.rod].system(point.peak.x))
      name_mode(point, exponents_of(*system, point.component));
  }

  // Everything is computed there: where the response is bounded.
  static bool is_refined(const CriticalPoint& point) { return std::isfinite(point.peak.value); }

  // The mode whose frequency is met at the peak: that of the component, by the exponents there alone, so that no step
  // of the sweep changes it.
  static void name_mode(CriticalPoint& point, const Stability& there) {
    const ModeState state = modes_by_name(there, point.component + 1)[static_cast<std::size_t>(point.component)];
    if (const std::optional<int> order = order_met(state, point.speed)) {
      point.mode = point.component;
      point.frequency = state.frequency;
      point.damping = state.damping();
      point.order = *order;
    }
  }

  // Everything at what was found, then on the flanks of resonances.
  void refine() {
    const Stopwatch watch;
    analyse_at("refined points", places_found());
    if (only_.all_exponents()) name_peaks();
    analyse_at("flanks of resonances", flanks());
    std::ranges::sort(result_.refined, {}, &SweepPoint::x);
    if (work_.ends_early()) {
      const auto without =
          std::ranges::count_if(result_.points, [](const SweepPoint& point) { return point.rods.empty(); });
      result_.shortfalls.push_back(fmt::format(
          "ended before the answer was complete: {}bands and peaks between points may be missing",
          without > 0 ? fmt::format("{} of {} points have no answer, and ", without, values_.size()) : std::string()));
    }
    result_.stages.push_back({"refined points", watch.seconds(), fmt::format("{} points", result_.refined.size())});
  }

  // Where no point is yet, inside the sweep.
  void analyse_at(const char* what, std::vector<double> places) {
    std::ranges::sort(places);
    std::erase_if(places, [&](double x) {
      return !(x > values_.front() && x < values_.back()) || std::ranges::binary_search(values_, x) ||
             std::ranges::find(result_.refined, x, &SweepPoint::x) != result_.refined.end();
    });
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (work_.ends_early()) places.clear();
    std::vector<SweepPoint> points = work_.results<SweepPoint>(
        what, places.size(),
        [&](std::size_t k) {
          const double x = places[k];
          return work_.ends_early()
                     ? left_out(x)
                     : analyse_point(scene_, x, only_, {.at_boundary = at_boundary(x), .at_pole = at_pole(x)});
        },
        [](auto& visit, SweepPoint& point) { visit_point(visit, point); });
    std::erase_if(points, [](const SweepPoint& point) { return point.problem == not_computed; });
    std::ranges::move(points, std::back_inserter(result_.refined));
  }

  // Of which rods a boundary there is `such`.
  template <class Such>
  std::vector<bool> with_boundary(double x, const Such& such) const {
    std::vector<bool> there;
    for (std::size_t r = 0; r < result_.rods.size(); ++r)
      there.push_back(std::ranges::any_of(result_.rods[r].boundaries, [&](const StabilityBoundary& boundary) {
        return boundary.converged && boundary.x == x && such(r, boundary);
      }));
    return there;
  }

  std::vector<bool> at_boundary(double x) const {
    return with_boundary(x, [](std::size_t, const StabilityBoundary&) { return true; });
  }

  // The pole of a response: a multiplier is +1, and the load excites it.
  std::vector<bool> at_pole(double x) const {
    return with_boundary(x, [&](std::size_t r, const StabilityBoundary& boundary) {
      return boundary.kind == BoundaryKind::plus_one &&
             std::ranges::any_of(result_.critical, [&](const CriticalPoint& point) {
               return point.rod == r && !is_refined(point) &&
                      std::abs(point.peak.x - x) <= boundary.error + point.peak.error;
             });
    });
  }

  // Boundaries, peaks, and the fastest growth between points.
  std::vector<double> places_found() const {
    std::vector<double> places;
    for (const SweepRod& rod : result_.rods)
      for (const StabilityBoundary& boundary : rod.boundaries) places.push_back(boundary.x);
    for (const CriticalPoint& point : result_.critical)
      if (is_refined(point)) places.push_back(point.peak.x);
    for (const Between& found : between_)
      for (const StabilitySample& sample : found.bands.samples) places.push_back(sample.x);
    return places;
  }

  void name_peaks() {
    for (CriticalPoint& point : result_.critical) {
      if (point.mode >= 0) continue;
      for (const std::vector<SweepPoint>* points : {&result_.refined, &result_.points}) {
        const auto there = std::ranges::find(*points, point.peak.x, &SweepPoint::x);
        if (there == points->end() || there->rods.empty() || !there->rods[point.rod].stability) continue;
        name_mode(point, there->rods[point.rod].stability->stability);
        break;
      }
      if (point.mode < 0 && !is_refined(point) && !work_.ends_early()) name_alone(point);
    }
  }

  // Of resonances of width damping/n.
  std::vector<double> flanks() const {
    std::vector<double> places;
    const double widest = 2 * (values_.back() - values_.front()) / static_cast<double>(intervals());
    for (const CriticalPoint& point : result_.critical) {
      if (!is_refined(point)) continue;
      const double width = point.order > 0 ? point.damping / point.speed / point.order * point.peak.x : 0;
      if (width > 0 && width < widest)
        for (const double t : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0}) places.push_back(point.peak.x + t * width);
    }
    return places;
  }

  void tell_what_missed_its_tolerance() {
    for (const std::size_t r : reported_) {
      std::size_t steady = 0, singular = 0, stability = 0;
      for (const SweepPoint& point : result_.points) {
        if (point.rods.empty()) continue;
        const RodPoint& rod = point.rods[r];
        singular += rod.steady == SteadyStatus::singular;
        steady += rod.steady && *rod.steady != SteadyStatus::singular && !(rod.error_bound <= settings_.tolerance);
        stability += rod.stability && !rod.stability->stability.converged;
      }
      const std::string& name = result_.rods[r].name;
      if (singular > 0) {
        result_.shortfalls.push_back(
            fmt::format("{}: no unique periodic solution at {} point{} (resonance without damping)", name, singular,
                        singular == 1 ? "" : "s"));
      }
      if (steady > 0) {
        result_.shortfalls.push_back(
            fmt::format("{}: the steady state's error bound exceeds the tolerance {:.1e} at {} points", name,
                        settings_.tolerance, steady));
      }
      if (stability > 0) {
        result_.notes.push_back(fmt::format("{}: the growth rate is known less well than usual at {} of {} points",
                                            name, stability, result_.points.size()));
      }
    }
  }

  // From one place that has them.
  void name_joint_components() {
    const Linkage& linkage = *scene_.first().linkage();
    for (const JointForce& joint : joint_forces(linkage, result_.points.front().speed, {}).joints) {
      const Eigen::Index components = joint.rigid.num_components();
      for (Eigen::Index c = 0; c < components; ++c)
        result_.joint_components.push_back(joint.name + (components == 1 ? " n" : c == 0 ? " x" : " y"));
    }
  }

  const SweepScene& scene_;
  Work& work_;
  const Settings& settings_;
  const std::vector<double>& values_;
  const Only only_;
  std::vector<std::size_t> reported_;
  std::vector<RodAlong> along_;
  mutable std::atomic<std::size_t> evaluations_ = 0;
  std::vector<std::vector<std::vector<ModeState>>> modes_;  // by rod, point, mode
  std::vector<Between> between_;  // by reported rod, then interval
  double seconds_between_ = 0;
  SweepResult result_;
};

}  // namespace

SweepResult run_sweep(const SweepScene& scene, Work& work) { return SweepRun(scene, work).run(); }

std::vector<const SweepPoint*> all_points(const SweepResult& result) {
  std::vector<const SweepPoint*> points;
  for (const SweepPoint& point : result.points) points.push_back(&point);
  for (const SweepPoint& point : result.refined) points.push_back(&point);
  std::stable_sort(points.begin(), points.end(), [](const SweepPoint* a, const SweepPoint* b) { return a->x < b->x; });
  return points;
}

std::vector<std::vector<ModeState>> tracks(const SweepResult& result, std::size_t rod,
                                           const std::vector<const SweepPoint*>& points) {
  std::vector<TrackedPlace> places;
  for (const SweepPoint* point : points) {
    const bool known = !point->rods.empty() && point->rods[rod].stability;
    places.push_back({point->x, point->speed, known ? &point->rods[rod].stability->stability : nullptr});
  }
  std::vector<std::vector<ModeState>> followed = track_modes(places, result.rods[rod].num_unknowns);
  for (std::vector<ModeState>& modes : followed) modes.resize(static_cast<std::size_t>(result.rods[rod].num_modes));
  return followed;
}

}  // namespace hb
