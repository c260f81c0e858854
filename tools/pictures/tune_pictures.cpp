#include "tools/pictures/tune_pictures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/map_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/map_plot.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

constexpr int campbell_points = 49;
constexpr int map_speeds = 61, map_designs = 23;

const char* after_text(const TuneResult& result) {
  return result.design.status == DesignStatus::infeasible ? "nearest design, conditions not met" : "after tuning";
}

CsvFile curves_csv(const TuneTask& task, const DesignCurves& curves, const Scene& scene, bool after) {
  const OutputUnits units = output_units(scene);
  CsvFile file;
  file.name = after ? "curves_after.csv" : "curves_before.csv";
  file.comment = {fmt::format("{}, {} tuning: largest deflection over rod and turn, largest growth rate",
                              scene_name(scene), after ? "after" : "before")};
  file.columns.push_back("speed [" + speed_unit(task, scene.units) + "]");
  for (const std::string& rod : curves.rods) file.columns.push_back("deflection " + rod + bracketed(units.response));
  file.columns.push_back("growth rate [" + units.rate + "]");
  const auto rods = static_cast<Eigen::Index>(curves.rods.size());
  file.rows.resize(static_cast<Eigen::Index>(curves.speed.size()), rods + 2);
  for (std::size_t k = 0; k < curves.speed.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    file.rows(i, 0) = curves.speed[k] / task.speed_unit;
    file.rows.row(i).segment(1, rods) = curves.deflection.row(i);
    file.rows(i, rods + 1) = curves.growth(i);
  }
  return file;
}

// "stable, before UNSTABLE because of AB"
std::string design_verdicts(const TuneResult& result) {
  const std::string after = title_verdict(tune_verdicts(result.margins_after)),
                    before = title_verdict(tune_verdicts(result.margins_before));
  return after + (before.empty() || before == after ? "" : ", before " + before);
}

// Both designs over the speed: deflection above, growth rate below.
Figure curves_figure(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  const OutputUnits units = output_units(scene);
  const std::vector<std::string>& rods = result.curves_after->rods;
  Figure figure;
  figure.name = "before_after";
  figure.height = 720;
  const double from = std::min(result.span_before.from, result.span_after.from) / task.speed_unit;
  const double to = std::max(result.span_before.to, result.span_after.to) / task.speed_unit;
  figure.commands = fmt::format(
      "set multiplot layout 2,1 title {} margins char 14, char 22, char 4, char 4.5 spacing char 0, char 2\n"
      "set xrange [{}:{}]\nset key outside right top Left reverse samplen 2\nset grid\nset logscale y\nunset "
      "xlabel\nset format y '%g'\nset "
      "format x ''\n"
      "set ylabel 'largest deflection{}'\n",
      figure_title(scene, {design_verdicts(result)}, fmt::format("before (dashed) and {}", after_text(result))), from,
      to, bracketed(units.response));
  std::string above, below;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    for (const bool after : {false, true}) {
      above += fmt::format("{}'{}' using 1:{} with lines lw 2 lc {} {} title {}", above.empty() ? "plot " : ", \\\n  ",
                           after ? "curves_after.csv" : "curves_before.csv", r + 2, r + 1, after ? "dt 1" : "dt 2",
                           quoted(rods[r] + (after ? " after" : " before")));
    }
  }
  for (const bool after : {false, true}) {
    below += fmt::format("{}'{}' using 1:{} with lines lw 2 lc {} {} title '{}'", after ? ", \\\n  " : "plot ",
                         after ? "curves_after.csv" : "curves_before.csv", rods.size() + 2, 7, after ? "dt 1" : "dt 2",
                         after ? "after" : "before");
  }
  figure.commands += above + "\n";
  figure.commands += fmt::format(
      "unset logscale y\nset format x '%g'\nset xlabel 'crank speed [{}]'\n"
      "set ylabel 'growth rate [{}]'\n{}\nunset multiplot\n",
      speed_unit(task, scene.units), units.rate, below);
  return figure;
}

// As `hb sweep` draws them, one per rod and design.
void add_campbell(const TuneTask& task, const TuneResult& result, bool after, SharedWork& work, OutputFolder& folder,
                  std::vector<Figure>& figures) {
  const SpeedSpan& span = after ? result.span_after : result.span_before;
  Settings settings = task.settings;
  settings.only = {false, true, false, false};
  Axis axis;
  axis.kind = task.in_rpm ? Axis::Kind::rpm : Axis::Kind::omega;
  axis.path = task.in_rpm ? "rpm" : "omega";
  axis.values = evenly(span.from / task.speed_unit, span.to / task.speed_unit, campbell_points);
  const SweepScene scene(task.family.with(numbers_at(task, after ? result.tuned : result.start)), settings, axis,
                         span.from, axis.values.front());
  const std::optional<SweepResult> sweep = run_sweep(scene, work);
  if (!sweep) return;
  for (std::size_t r = 0; r < sweep->rods.size(); ++r) {
    if (!sweep->rods[r].reported) continue;
    CsvFile csv = sweep_rod_csv(scene, *sweep, r);
    const std::string name = file_name(fmt::format("campbell_{}_{}", sweep->rods[r].name, after ? "after" : "before"));
    csv.name = name + ".csv";
    folder.write(csv.name, csv_text(csv));
    Figure figure = campbell_figure(scene, *sweep, r, csv, "");
    figure.name = name;
    figure.commands = fmt::format("set label '{}' at graph 0.015, 0.965 front font ',14' boxed\n",
                                  after ? after_text(result) : "before tuning") +
                      figure.commands;
    figures.push_back(std::move(figure));
  }
}

// The designs between, all variables together: t = 0 before, t = 1 after.
class Way {
 public:
  Way(const TuneTask& task, const TuneResult& result, Settings settings)
      : task_(task), result_(result), settings_(std::move(settings)) {
    settings_.only = {false, true, false, false};
  }

  std::optional<ScaledSystem> system(std::size_t rod, double speed, double t) const {
    const std::shared_ptr<const SceneModel> model = at(t);
    if (!model) return std::nullopt;
    return scale_system(model->rods[rod].system, speed * task_.speed_unit);
  }
  std::shared_ptr<const SceneModel> at(double t) const {
    const std::lock_guard lock(mutex_);
    auto known = models_.find(t);
    if (known != models_.end()) return known->second;
    std::vector<double> x;
    for (std::size_t i = 0; i < result_.start.size(); ++i)
      x.push_back(result_.start[i] + t * (result_.tuned[i] - result_.start[i]));
    std::shared_ptr<const SceneModel> model;
    try {
      model = std::make_shared<const SceneModel>(make_model(task_.family.scene(numbers_at(task_, x)), settings_));
    } catch (const SceneError&) {  // no such design
    }
    return models_.emplace(t, std::move(model)).first->second;
  }

 private:
  const TuneTask& task_;
  const TuneResult& result_;
  Settings settings_;
  mutable std::mutex mutex_;
  mutable std::map<double, std::shared_ptr<const SceneModel>> models_;
};

// Growth at every point of the grid; boundaries between them are `hb map`'s business.
StabilityMap grid_map(const Way& way, std::size_t rod, const std::vector<double>& x, const std::vector<double>& y,
                      const Settings& settings, const Work& work) {
  StabilityMap map{.x = x, .y = y, .points = std::vector<MapPoint>(x.size() * y.size()), .boundaries = {}};
  work.for_each(map.points.size(), [&](std::size_t p) {
    const std::optional<ScaledSystem> system = way.system(rod, x[p % x.size()], y[p / x.size()]);
    if (!system) return;
    const Stability stability = leading_stability(*system, settings);
    MapPoint& point = map.points[p];
    point.source = MapSource::evaluated;
    point.speed = system->speed;
    point.growth_rate = stability.growth_rate;
    point.growth_error = stability.growth_error;
    point.verdict = stability.verdict;
    point.converged = stability.converged;
  });
  return map;
}

void add_map(const TuneTask& task, const TuneResult& result, const Scene& scene, const Work& work, OutputFolder& folder,
             std::vector<Figure>& figures) {
  const Way way(task, result, task.settings);
  const double from = std::min(result.span_before.from, result.span_after.from) / task.speed_unit;
  const double to = std::max(result.span_before.to, result.span_after.to) / task.speed_unit;
  const std::vector<double> x = evenly(from, to, map_speeds), y = evenly(-0.05, 1.05, map_designs);
  MapResult map;
  map.x_axis = {task.in_rpm ? PlaneAxis::Role::rpm : PlaneAxis::Role::omega, task.in_rpm ? "rpm" : "omega", from, to};
  map.y_axis = {PlaneAxis::Role::scene_number, "way from the design before (0) to the one found (1)", y.front(),
                y.back()};
  const std::shared_ptr<const SceneModel> tuned = way.at(1);
  for (std::size_t r = 0; r < tuned->rods.size(); ++r) {
    if (!tuned->rods[r].reported) continue;
    map.rods.push_back(tuned->rods[r].name);
    map.maps.push_back(grid_map(way, r, x, y, task.settings, work));
    const StabilityMap& own = map.maps.back();
    std::vector<MapPoint>& worst = map.worst_of_several;
    if (worst.empty()) worst = own.points;
    for (std::size_t p = 0; p < own.points.size(); ++p)
      if (own.points[p].growth_rate > worst[p].growth_rate) worst[p] = own.points[p];
  }
  constexpr double no_boundaries = 0;
  const MapDocument document{map, scene, tuned->rods.front().num_modes, no_boundaries};
  MapFiles files;
  const auto write = [&](CsvFile file, const std::string& name) {
    file.name = name;
    folder.write(name, csv_text(file));
    return name;
  };
  files.grid = write(map_grid_csv(document), "tune_map.csv");
  Figure figure = map_figure(document, files, MapColour::growth);
  figure.name = "tune_map";
  std::string marks = "set colorbox vertical default\n";
  for (const int t : {0, 1})
    marks += fmt::format(
        "set arrow from graph 0, first {0} to graph 1, first {0} nohead front linewidth 2 linecolor '#000000'\n"
        "set label '{1}' at graph 0.01, first {0} left offset 0, 0.6 front boxed\n",
        t, t == 0 ? "before" : after_text(result));
  figure.commands = marks + figure.commands + "unset arrow\n";
  figures.push_back(std::move(figure));
}

}  // namespace

std::vector<double> evenly(double from, double to, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(k + 1 == count ? to : from + (to - from) * k / (count - 1));
  return values;
}

void write_curves(const TuneTask& task, const TuneResult& result, const Scene& scene, OutputFolder& folder) {
  for (const bool after : {false, true}) {
    const CsvFile csv = curves_csv(task, after ? *result.curves_after : *result.curves_before, scene, after);
    folder.write(csv.name, csv_text(csv));
  }
}

std::vector<Figure> tune_figures(const TuneTask& task, const TuneResult& result, const Scene& scene, int num_threads,
                                 OutputFolder& folder) {
  if (task.span.from == task.span.to) return {};
  std::vector<Figure> figures = {curves_figure(task, result, scene)};
  SharedWork work(num_threads);
  add_campbell(task, result, false, work, folder, figures);
  add_campbell(task, result, true, work, folder, figures);
  add_map(task, result, scene, work, folder, figures);
  return figures;
}

}  // namespace hb::tools
