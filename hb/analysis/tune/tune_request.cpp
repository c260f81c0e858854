#include "hb/analysis/tune/tune_request.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hb {
namespace {

std::vector<TuneVariable> variables_of(const SceneFamily& family, const TuneRequest& request) {
  if (request.vary.empty()) throw RequestError("vary", "nothing", "a number of the scene with its bounds");
  std::vector<TuneVariable> variables;
  for (const TuneRequest::Variable& asked : request.vary) {
    if (!(asked.lower < asked.upper) || !std::isfinite(asked.upper - asked.lower))
      throw RequestError("vary", fmt::format("{} from {:g} to {:g}", asked.path, asked.lower, asked.upper),
                         "finite bounds, the lower below the upper");
    if (std::ranges::find(variables, asked.path, &TuneVariable::path) != variables.end())
      throw RequestError("vary", asked.path + " twice", "once");
    const double own = family.value(asked.path);
    TuneVariable variable{asked.path, asked.lower, asked.upper, std::clamp(own, asked.lower, asked.upper), {}, {}};
    if (variable.start != own) variable.moved_from = own;
    variables.push_back(std::move(variable));
  }
  return variables;
}

void set_speeds(TuneTask& task, const TuneRequest& request, const Scene& scene) {
  if (!request.over) {
    const Speed speed = speed_of(request, scene);
    task.in_rpm = speed.in_rpm;
    task.span.from = task.span.to = speed.omega;
  } else {
    require_no_speed(request, "over", *request.over);
    if (!hb::is_speed(request.over->path)) throw RequestError("over", request.over->path, "rpm or omega");
    require_values("over", *request.over, scene.units);
    task.in_rpm = in_rpm(request.over->path);
    const auto omega = [&](double value) { return task.in_rpm ? speed_from_rpm(value, scene.units) : value; };
    task.span = {omega(request.over->values.front()), omega(request.over->values.back()),
                 static_cast<int>(request.over->values.size())};
  }
  task.speed_unit = task.in_rpm ? speed_from_rpm(1, scene.units) : 1;
}

}  // namespace

int usual_analyses(std::size_t num_variables) {
  return 400 + 100 * static_cast<int>(std::min<std::size_t>(num_variables, 100));
}

TuneTask tune_task(const SceneFamily& family, const TuneRequest& request) {
  if (request.minimise.empty() == request.maximise.empty())
    throw RequestError("minimise", request.minimise.empty() ? "no goal" : "a second goal beside maximise", "one goal");
  TuneTask task{.family = family,
                .variables = variables_of(family, request),
                .goal = request.maximise.empty() ? parse_goal(request.minimise) : parse_largest_goal(request.maximise),
                .keeps = {},
                .span = {},
                .heights = request.heights,
                .settings = {},
                .options = {}};
  for (const std::string& text : request.keep) task.keeps.push_back(parse_keep(text));
  if (request.algorithm == DesignAlgorithm::bobyqa && (!task.keeps.empty() || task.variables.size() < 2))
    throw RequestError("algorithm", "bobyqa with conditions or a single variable",
                       "automatic, direct, mlsl, cobyla, slsqp, mma");
  if (request.analyses && *request.analyses < 2)
    throw RequestError("analyses", fmt::format("{}", *request.analyses), "at least 2");
  task.options.algorithm = request.algorithm;
  task.options.max_evaluations = request.analyses.value_or(usual_analyses(task.variables.size()));
  const Scene scene = family.scene(numbers_at(task, start_of(task)));
  task.settings = settings_of(request, scene);
  set_speeds(task, request, scene);
  return task;
}

TuneResult tune(const SceneFamily& family, const TuneRequest& request, const Work& work) {
  return tune(tune_task(family, request), work);
}

}  // namespace hb
