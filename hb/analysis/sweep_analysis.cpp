#include "hb/analysis/sweep_analysis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/rod_steady.hpp"
#include "hb/analysis/stopwatch.hpp"
#include "hb/analysis/sweep_parts.hpp"

namespace hb {
namespace {

// Peaks and boundaries are looked for on values more accurate than the points themselves need.
// A peak this far from n = omega/Omega, in orders, is not named after that mode.
constexpr double most_detuning = 0.3;
// A maximum lower than this above its valleys, relative, is not told from rounding.
constexpr double least_prominence = 1e-8;

bool wants_steady(const Only& only) { return only.steady || only.shape || only.reactions; }

Only available(const SceneModel& model, Only only) {
  if (!model.linkage()) only.reactions = only.shape = false;
  return only;
}

TurnRange turn_range(const FourierSeries& series, Eigen::Index component) {
  if (series.num_harmonics() < 0) return {};
  const Range range = fourier::range(series, component);
  return {range.min.value, range.max.value};
}

RodPoint analyse_rod(const SceneModel& model, const RodModel& rod, double x, double speed, const Settings& settings,
                     const Only& only, FourierSeries& q) {
  RodPoint point;
  if (wants_steady(only)) {
    SteadyState state = solve_rod(rod.system, rod.num_modes, speed, response_options(settings));
    point.steady = state.status;
    point.num_harmonics = state.num_harmonics;
    point.error_bound = state.error_bound;
    point.resonance_distance = state.resonance_distance;
    if (state.status != SteadyStatus::singular) {
      for (Eigen::Index i = 0; i < state.q.num_components(); ++i)
        point.max_abs.push_back(fourier::max_abs(state.q, i).value);
      if (only.shape && rod.reported) {
        const Body& link = *body_at(*model.linkage(), rod.link);
        const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
        const RodShape shape = rod_shape(link, coefficients, speed, state.q);
        point.deflection = shape.deflection.max_abs;
        point.bending_moment = shape.bending_moment.max_abs;
        const RodStress stress = rod_stress(link, coefficients, speed, *point.bending_moment);
        point.buckling_share = stress.buckling_share();
        point.strain = stress.strain;
      }
      q = std::move(state.q);
    }
  }
  if (only.stability) {  // of every rod: the mechanism is stable where all are
    const StabilityOptions options = exponent_options(settings);
    if (only.all_exponents()) {
      point.stability = stability_sample(scale_system(rod.system, speed), x, options);
    } else {
      point.stability.emplace();
      point.stability->x = x;
      point.stability->speed = speed;
      point.stability->stability = analyse_stability(rod.system, speed, options);
    }
  }
  return point;
}

SweepPoint analyse_point(const SweepScene& scene, double x, const Only& wanted) {
  const ScenePlace place = scene.at(x);
  SweepPoint point;
  point.x = x;
  point.speed = place.speed;
  point.problem = place.problem;
  if (!place.model) return point;
  const Only only = available(*place.model, wanted);
  const std::vector<RodModel>& rods = place.model->rods;
  std::vector<FourierSeries> q(rods.size());
  for (std::size_t r = 0; r < rods.size(); ++r)
    point.rods.push_back(analyse_rod(*place.model, rods[r], x, place.speed, scene.settings(), only, q[r]));
  const bool solved = std::ranges::none_of(q, [](const FourierSeries& series) { return series.c.size() == 0; });
  if (place.model->exact) {
    std::vector<LinearRod> linear;
    for (std::size_t r = 0; r < rods.size(); ++r) linear.push_back({&rods[r].system, &q[r]});
    const TheoryErrors errors = theory_errors(*place.model->exact, place.speed, linear);
    for (std::size_t r = 0; r < rods.size(); ++r) point.rods[r].theory_error = errors.rods[r].q;
    point.theory_reason = errors.reason;
  }
  if (only.reactions && solved) {
    std::vector<LinkResponse> responses;
    for (std::size_t r = 0; r < rods.size(); ++r) responses.push_back({rods[r].link, q[r]});
    const JointForces forces = joint_forces(*place.model->linkage(), place.speed, responses);
    for (const JointForce& joint : forces.joints) {
      for (Eigen::Index c = 0; c < joint.rigid.num_components(); ++c) {
        point.joints.push_back(turn_range(joint.elastic, c));
        point.joints_rigid.push_back(turn_range(joint.rigid, c));
      }
    }
    point.torque = turn_range(forces.torque, 0);
    point.torque_rigid = turn_range(forces.torque_rigid, 0);
  }
  return point;
}

// One rod along the sweep, as functions of x.
class RodAlong {
 public:
  RodAlong(const SweepScene& scene, std::size_t rod, std::atomic<std::size_t>& evaluations)
      : scene_(scene), rod_(rod), evaluations_(evaluations) {}

  const Settings& settings() const { return scene_.settings(); }

  std::optional<ScaledSystem> system(double x) const {
    ++evaluations_;
    const ScenePlace place = scene_.at(x);
    if (!place.model) return std::nullopt;
    return scale_system(place.model->rods[rod_].system, place.speed);
  }

  std::optional<FourierSeries> response(double x, double tolerance) const {
    ++evaluations_;
    const ScenePlace place = scene_.at(x);
    if (!place.model) return std::nullopt;
    SteadyOptions options;
    options.method = scene_.settings().steady_method;
    options.tolerance = tolerance;
    const RodModel& rod = place.model->rods[rod_];
    SteadyState state = solve_rod(rod.system, rod.num_modes, place.speed, options);
    if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
    return std::move(state.q);
  }

  // max |q_i| over the turn.
  ResponseAt largest(int component, double tolerance) const {
    return [this, component, tolerance](double x) -> std::optional<double> {
      const std::optional<FourierSeries> q = response(x, tolerance);
      if (!q) return std::nullopt;
      return fourier::max_abs(*q, component).value;
    };
  }

 private:
  const SweepScene& scene_;
  std::size_t rod_;
  std::atomic<std::size_t>& evaluations_;
};

// The places of one rod in ascending x where its response is known.
struct ResponseSample {
  double x;
  std::vector<double> max_abs;
};

int largest_component(const std::vector<double>& values) {
  return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin());
}

// Resonances omega_j = n Omega that pass between two points and are narrower than their distance: samples on top and
// on both flanks.
std::vector<ResponseSample> resonances_between(const RodAlong& rod, const SweepPoint& a, const SweepPoint& b,
                                               const RodPoint& rod_a, const RodPoint& rod_b,
                                               const std::vector<ModeState>& modes_a,
                                               const std::vector<ModeState>& modes_b) {
  std::vector<ResponseSample> found;
  if (rod_a.max_abs.empty() || rod_b.max_abs.empty()) return found;
  const int most = std::max(rod_a.num_harmonics, rod_b.num_harmonics);
  for (std::size_t j = 0; j < modes_a.size() && j < rod_a.max_abs.size(); ++j) {
    const double first = modes_a[j].frequency / a.speed, last = modes_b[j].frequency / b.speed;
    if (!std::isfinite(first) || !std::isfinite(last)) continue;
    const double low = std::min(first, last), high = std::max(first, last);
    const double half_width = 0.5 * (modes_a[j].damping() / a.speed + modes_b[j].damping() / b.speed);
    // Wide enough to show on the points themselves, or growing.
    if (!(half_width > 0 && half_width < 2 * (high - low))) continue;
    for (double n = std::max(1.0, std::floor(low) + 1); n < high && n <= most; ++n) {
      const double t = (n - first) / (last - first), x = a.x + t * (b.x - a.x);
      const double flank = std::min({3 * half_width / (high - low) * (b.x - a.x), 0.5 * (x - a.x), 0.5 * (b.x - x)});
      std::vector<ResponseSample> here;
      for (const double place : {x - flank, x, x + flank}) {
        const std::optional<FourierSeries> q = rod.response(place, peak_accuracy(rod.settings()).rough);
        if (!q) break;
        ResponseSample sample{place, {}};
        for (Eigen::Index i = 0; i < q->num_components(); ++i) sample.max_abs.push_back(fourier::max_abs(*q, i).value);
        here.push_back(std::move(sample));
      }
      if (here.size() == 3 && here[1].max_abs[j] > std::max(rod_a.max_abs[j], rod_b.max_abs[j]))
        found.insert(found.end(), std::make_move_iterator(here.begin()), std::make_move_iterator(here.end()));
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.x < q.x; });
  return found;
}

struct PeakTask {
  std::size_t rod;
  int component;
  double low, inside, high;
  double prominence;
};

// Local maxima among the samples of one component.
void add_maxima(const std::vector<ResponseSample>& samples, std::size_t rod, int component,
                const std::function<bool(const ResponseSample&)>& wanted, std::vector<PeakTask>& tasks) {
  const auto value = [&](std::size_t k) { return samples[k].max_abs[static_cast<std::size_t>(component)]; };
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    if (!(value(k) > value(k - 1) && value(k) >= value(k + 1)) || !wanted(samples[k])) continue;
    // Valleys: down to where it climbs again on either side.
    std::size_t left = k - 1, right = k + 1;
    while (left > 0 && value(left - 1) <= value(left)) --left;
    while (right + 1 < samples.size() && value(right + 1) <= value(right)) ++right;
    const double prominence = 1 - std::max(value(left), value(right)) / value(k);
    if (prominence > least_prominence)
      tasks.push_back({rod, component, samples[k - 1].x, samples[k].x, samples[k + 1].x, prominence});
  }
}

}  // namespace

namespace {

// Addresses come back, these do not.
std::size_t next_id() {
  static std::atomic<std::size_t> next = 1;
  return next++;
}

}  // namespace

SweepScene::SweepScene(SceneFamily family, Settings settings, Axis axis, double fixed_speed, double fixed_rpm)
    : family_(std::move(family)),
      settings_(std::move(settings)),
      axis_(std::move(axis)),
      fixed_speed_(fixed_speed),
      fixed_rpm_(fixed_rpm),
      id_(next_id()) {
  // The error of the cut is no part of a sweep: no finer Ritz matrices.
  Settings model_settings = settings_;
  constexpr bool compares_modes = false;
  const bool auto_modes = std::holds_alternative<AutoModes>(settings_.modes);
  if (axis_.kind != Axis::Kind::parameter) {
    Scene scene = family_.scene();
    units_ = scene.units;
    first_ = std::make_shared<SceneModel>(make_model(std::move(scene), model_settings, compares_modes));
  } else {
    for (std::size_t k = 0; k < axis_.values.size() && !first_; ++k) {
      try {
        Scene scene = family_.scene({{axis_.path, axis_.values[k]}});
        units_ = scene.units;
        first_ = std::make_shared<SceneModel>(make_model(std::move(scene), model_settings, compares_modes));
      } catch (const ObstructedLinkage&) {
        if (k + 1 == axis_.values.size()) throw;
      }
    }
  }
  if (auto_modes) {
    // As many as the ends and the middle of the sweep need.
    Settings steady = settings_;
    steady.only = {true, false, false, false};
    int modes = 1;
    const std::vector<double>& values = axis_.values;
    for (const double x : {values.front(), values[values.size() / 2], values.back()}) {
      const ScenePlace place = at(x);
      if (!place.model) continue;
      for (const RodResult& rod : analyse(*place.model, place.speed, steady).rods)
        modes = std::max(modes, static_cast<int>(rod.num_modes));
    }
    settings_.modes = modes;
    model_settings.modes = modes;
    id_ = next_id();  // places looked at so far have other models
    first_ = std::make_shared<SceneModel>(make_model(first_->scene, model_settings, compares_modes));
  }
}

double SweepScene::speed_at(double x) const {
  switch (axis_.kind) {
    case Axis::Kind::rpm:
      return speed_from_rpm(x, units_);
    case Axis::Kind::omega:
      return x;
    case Axis::Kind::parameter:
      break;
  }
  return fixed_speed_;
}

LinkagePlace SweepScene::linkage_at(double x) const {
  if (axis_.kind != Axis::Kind::parameter) return {*first_->linkage(), ""};
  FamilyMember member = family_.at({{axis_.path, x}});
  if (!member.scene) return {std::nullopt, std::move(member.why_not)};
  return {std::get<Linkage>(std::move(member.scene->model)), ""};
}

ScenePlace SweepScene::at(double x) const {
  if (axis_.kind != Axis::Kind::parameter) return {first_, speed_at(x), ""};
  // Several questions are asked at one place in a row.
  struct Last {
    std::size_t owner = 0;
    double x = 0;
    ScenePlace place;
  };
  static thread_local Last last;
  if (last.owner == id_ && last.x == x) return last.place;
  ScenePlace place{nullptr, fixed_speed_, ""};
  try {
    place.model = std::make_shared<SceneModel>(make_model(family_.scene({{axis_.path, x}}), settings_, false));
  } catch (const ObstructedLinkage& obstruction) {
    place.problem = obstruction.what();
  }
  last = {id_, x, place};
  return place;
}

SweepResult run_sweep(const SweepScene& scene, Work& work) {
  const Settings& settings = scene.settings();
  const std::vector<double>& values = scene.axis().values;
  const SceneModel& model = scene.first();
  SweepResult result;
  result.computed = available(model, settings.only);
  const Only& only = result.computed;
  result.stages = model.stages;
  const SweepOptions sweep_options = boundary_options(settings);
  const PeakAccuracy peaks = peak_accuracy(settings);
  result.searched_bands = only.all_exponents() && settings.search;
  result.searched_peaks = only.steady && settings.search;
  const std::string why_not = settings.search ? "all exponents are needed, which were not asked for" : "not asked for";

  // The points asked for.
  Stopwatch watch;
  const auto visit_whole_point = [](auto& visit, SweepPoint& point) { visit_point(visit, point); };
  result.points = work.results<SweepPoint>(
      "sweep", values.size(),
      [&](std::size_t k) {
        if (!work.ends_early()) return analyse_point(scene, values[k], only);
        SweepPoint left_out;
        left_out.x = values[k];
        const bool in_rpm = scene.axis().kind == Axis::Kind::rpm;
        left_out.speed = scene.axis().kind == Axis::Kind::omega
                             ? values[k]
                             : speed_from_rpm(in_rpm ? values[k] : scene.fixed_rpm(), scene.scene().units);
        left_out.problem = "not computed before the end";
        return left_out;
      },
      visit_whole_point);
  result.stages.push_back({"points", watch.seconds(), fmt::format("{} points", values.size())});

  std::vector<std::size_t> reported;
  std::vector<RodAlong> along;
  std::atomic<std::size_t> evaluations = 0;
  const auto counted = [&](const std::string& what) {
    return fmt::format("{}{} evaluations", what, evaluations.exchange(0));
  };
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    SweepRod rod;
    rod.name = model.rods[r].name;
    rod.reported = model.rods[r].reported;
    rod.num_modes = static_cast<int>(model.rods[r].num_modes);
    rod.num_unknowns = static_cast<int>(model.rods[r].system.num_modes());
    result.rods.push_back(std::move(rod));
    along.emplace_back(scene, r, evaluations);
    if (model.rods[r].reported) reported.push_back(r);
  }
  std::vector<const SweepPoint*> grid;
  for (const SweepPoint& point : result.points) grid.push_back(&point);
  std::vector<std::vector<std::vector<ModeState>>> modes(result.rods.size());
  for (const std::size_t r : reported) modes[r] = tracks(result, r, grid);

  // Between them: narrow bands and narrow resonances, each interval and rod on its own.
  Stopwatch between_watch;
  const std::size_t intervals = values.size() - 1, num_tasks = intervals * reported.size();
  struct Between {
    SearchedInterval bands;
    std::vector<ResponseSample> peaks;
  };
  std::vector<Between> between(num_tasks);
  if (result.searched_bands) {
    between = work.results<Between>(
        "narrow bands and peaks", num_tasks,
        [&](std::size_t task) {
          Between found;
          const std::size_t r = reported[task / intervals], k = task % intervals;
          const SweepPoint &a = result.points[k], &b = result.points[k + 1];
          if (!a.problem.empty() || !b.problem.empty()) return found;
          if (work.ends_early()) {
            found.bands.not_excluded.push_back({a.x, b.x});
            return found;
          }
          const auto sample_at = [&](std::size_t place) -> const StabilitySample* {
            if (place >= values.size() || !result.points[place].problem.empty()) return nullptr;
            return &*result.points[place].rods[r].stability;
          };
          found.bands = search_interval([&](double x) { return along[r].system(x); }, *sample_at(k), *sample_at(k + 1),
                                        sample_at(k - 1), sample_at(k + 2), sweep_options);
          if (only.steady)
            found.peaks = resonances_between(along[r], a, b, a.rods[r], b.rods[r], modes[r][k], modes[r][k + 1]);
          return found;
        },
        [](auto& visit, Between& found) {
          visit_interval(visit, found.bands);
          visit_elements(visit, found.peaks, [&](ResponseSample& sample) {
            visit(sample.x);
            visit_elements(visit, sample.max_abs, visit);
          });
        });
  }
  // Bands and what may have been missed.
  std::size_t num_boundaries = 0;
  if (result.searched_bands) {
    for (std::size_t i = 0; i < reported.size(); ++i) {
      const std::size_t r = reported[i];
      SweepRod& rod = result.rods[r];
      std::vector<const StabilitySample*> samples;
      for (std::size_t k = 0; k < values.size(); ++k) {
        const SweepPoint& point = result.points[k];
        samples.push_back(point.problem.empty() ? &*point.rods[r].stability : nullptr);
        if (k == intervals) break;
        const SearchedInterval& found = between[i * intervals + k].bands;
        for (const StabilitySample& sample : found.samples) samples.push_back(&sample);
        rod.boundaries.insert(rod.boundaries.end(), found.boundaries.begin(), found.boundaries.end());
        rod.not_excluded.insert(rod.not_excluded.end(), found.not_excluded.begin(), found.not_excluded.end());
      }
      rod.bands = unstable_bands(samples, rod.boundaries);
      num_boundaries += rod.boundaries.size();
      for (const StabilityBoundary& boundary : rod.boundaries) {
        if (boundary.converged) continue;
        result.notes.push_back(fmt::format("{}: a stability boundary near {} = {:.10g} is known to {:.1e} only",
                                           rod.name, scene.axis().path, boundary.x, boundary.error));
      }
    }
  }
  if (only.stability && !result.searched_bands)
    result.stages.push_back({"narrow bands and peaks", 0, why_not, true});
  else
    result.stages.push_back({"narrow bands and peaks", between_watch.seconds(),
                             counted(fmt::format("{} boundaries located, ", num_boundaries))});

  // Resonance peaks: of the largest component, and of each component where its own mode resonates.
  Stopwatch peak_watch;
  std::vector<PeakTask> tasks;
  if (result.searched_peaks) {
    for (std::size_t i = 0; i < reported.size(); ++i) {
      const std::size_t r = reported[i];
      std::vector<ResponseSample> run;
      const auto finish = [&] {
        for (int c = 0; c < result.rods[r].num_modes; ++c) {
          add_maxima(
              run, r, c, [&](const ResponseSample& s) { return largest_component(s.max_abs) == c; }, tasks);
        }
        run.clear();
      };
      for (std::size_t k = 0; k < values.size(); ++k) {
        const SweepPoint& point = result.points[k];
        if (point.rods.empty() || point.rods[r].max_abs.empty()) {
          finish();
        } else {
          run.push_back({point.x, point.rods[r].max_abs});
        }
        if (k < intervals && !run.empty())
          for (const ResponseSample& sample : between[i * intervals + k].peaks) run.push_back(sample);
      }
      finish();
    }
  }
  using MaybeCritical = std::optional<CriticalPoint>;
  const std::vector<MaybeCritical> critical = work.results<MaybeCritical>(
      "resonance peaks", tasks.size(),
      [&](std::size_t k) -> MaybeCritical {
        if (work.ends_early()) return std::nullopt;
        const PeakTask& task = tasks[k];
        const RodAlong& rod = along[task.rod];
        const std::optional<ResponsePeak> peak =
            locate_peak(rod.largest(task.component, peaks.rough), rod.largest(task.component, peaks.fine), task.low,
                        task.inside, task.high, peaks.height);
        if (!peak) return std::nullopt;
        CriticalPoint point;
        point.rod = task.rod;
        point.component = task.component;
        point.peak = *peak;
        point.prominence = task.prominence;
        point.speed = scene.at(peak->x).speed;
        if (only.all_exponents()) {
          const SystemAt system = [&](double x) { return rod.system(x); };
          if (const std::optional<StabilitySample> sample =
                  stability_sample(system, peak->x, sweep_options.stability)) {
            const auto after = std::upper_bound(values.begin(), values.end(), peak->x);
            const std::size_t at = static_cast<std::size_t>(
                std::clamp<std::ptrdiff_t>(after - values.begin() - 1, 0, static_cast<std::ptrdiff_t>(intervals) - 1));
            const std::vector<ModeState> there =
                modes_by_continuity(sample->stability, sample->speed,
                                    interpolated(modes[task.rod][at], modes[task.rod][at + 1],
                                                 (peak->x - values[at]) / (values[at + 1] - values[at])));
            const ModeState& state = there[static_cast<std::size_t>(task.component)];
            const double turns = state.frequency / point.speed;
            if (std::isfinite(turns) && turns >= 0.5 && std::abs(turns - std::round(turns)) <= most_detuning) {
              point.mode = task.component;
              point.frequency = state.frequency;
              point.damping = state.damping();
              point.order = static_cast<int>(std::lround(turns));
            }
          }
        }
        return point;
      },
      [](auto& visit, MaybeCritical& point) {
        visit_if_there(visit, point, [&](CriticalPoint& there) { visit_critical(visit, there); });
      });
  for (const MaybeCritical& point : critical) {
    if (!point) continue;
    if (!point->peak.converged) {
      result.notes.push_back(fmt::format("{}: the peak of q_{} at {} = {:.10g} is known to {:.1e} only",
                                         result.rods[point->rod].name, point->component + 1, scene.axis().path,
                                         point->peak.x, point->peak.error));
    }
    result.critical.push_back(*point);
  }
  std::stable_sort(result.critical.begin(), result.critical.end(), [](const CriticalPoint& a, const CriticalPoint& b) {
    return a.rod != b.rod ? a.rod < b.rod : a.peak.x < b.peak.x;
  });
  if (only.steady && !result.searched_peaks)
    result.stages.push_back({"resonance peaks", 0, "not asked for", true});
  else
    result.stages.push_back(
        {"resonance peaks", peak_watch.seconds(), counted(fmt::format("{} located, ", tasks.size()))});

  // Everything at what was found.
  Stopwatch refined_watch;
  std::vector<double> places;
  for (const SweepRod& rod : result.rods)
    for (const StabilityBoundary& boundary : rod.boundaries) places.push_back(boundary.x);
  const double widest = 2 * (values.back() - values.front()) / static_cast<double>(intervals);
  for (const CriticalPoint& point : result.critical) {
    if (std::isinf(point.peak.value)) continue;
    places.push_back(point.peak.x);
    // Flanks of a resonance of width damping/n.
    const double width = point.order > 0 ? point.damping / point.speed / point.order * point.peak.x : 0;
    if (width > 0 && width < widest)
      for (const double t : {-2.0, -1.0, -0.5, 0.5, 1.0, 2.0}) places.push_back(point.peak.x + t * width);
  }
  for (const Between& found : between)
    for (const StabilitySample& sample : found.bands.samples) places.push_back(sample.x);
  if (work.ends_early()) places.clear();
  std::sort(places.begin(), places.end());
  std::erase_if(places, [&](double x) {
    return !(x > values.front() && x < values.back()) || std::binary_search(values.begin(), values.end(), x);
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  result.refined = work.results<SweepPoint>(
      "refined points", places.size(), [&](std::size_t k) { return analyse_point(scene, places[k], only); },
      visit_whole_point);
  if (work.ends_early()) {
    const auto without = std::count_if(result.points.begin(), result.points.end(),
                                       [](const SweepPoint& point) { return point.rods.empty(); });
    result.shortfalls.push_back(fmt::format(
        "ended before the answer was complete: {}bands and peaks between points may be missing",
        without > 0 ? fmt::format("{} of {} points have no answer, and ", without, values.size()) : std::string()));
  }
  result.stages.push_back({"refined points", refined_watch.seconds(), fmt::format("{} points", places.size())});

  // What missed its tolerance.
  for (const std::size_t r : reported) {
    std::size_t steady = 0, singular = 0, stability = 0;
    for (const SweepPoint& point : result.points) {
      if (point.rods.empty()) continue;
      const RodPoint& rod = point.rods[r];
      singular += rod.steady == SteadyStatus::singular;
      steady += rod.steady && *rod.steady != SteadyStatus::singular && !(rod.error_bound <= settings.tolerance);
      stability += rod.stability && !rod.stability->stability.converged;
    }
    const std::string& name = result.rods[r].name;
    if (singular > 0) {
      result.shortfalls.push_back(
          fmt::format("{}: no unique periodic solution at {} points (resonance without damping)", name, singular));
    }
    if (steady > 0) {
      result.shortfalls.push_back(
          fmt::format("{}: the steady state's error bound exceeds the tolerance {:.1e} at {} points", name,
                      settings.tolerance, steady));
    }
    if (stability > 0) {
      result.notes.push_back(fmt::format("{}: the growth rate is known less well than usual at {} of {} points", name,
                                         stability, result.points.size()));
    }
  }
  if (only.reactions) {
    // Names of the columns, from one place that has them.
    for (const JointForce& joint : joint_forces(*model.linkage(), result.points.front().speed, {}).joints) {
      const Eigen::Index components = joint.rigid.num_components();
      for (Eigen::Index c = 0; c < components; ++c)
        result.joint_components.push_back(joint.name + (components == 1 ? " n" : c == 0 ? " x" : " y"));
    }
  }
  return result;
}

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
