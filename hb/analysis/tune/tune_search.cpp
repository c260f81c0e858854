#include "hb/analysis/tune/tune_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/stopwatch.hpp"

namespace hb {
namespace {

constexpr int most_rounds = 4;

std::vector<double> to_vector(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

Eigen::VectorXd to_eigen(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

}  // namespace

TuneSearch::TuneSearch(const TuneTask& task, const Work& work)
    : task_(task), work_(work), settings_(task.settings), start_(start_of(task)) {
  // Joint forces and the theory error, which is always reported, need every rod.
  settings_.only = {false, true, true, false};
  std::vector<double> lower, upper;
  for (const TuneVariable& variable : task.variables) {
    lower.push_back(variable.lower);
    upper.push_back(variable.upper);
  }
  if (auto_modes()) settings_.modes = modes_needed(start_, {});
  aims_ = std::make_unique<DesignAims>(task.goal, task.keeps, make_model(scene_at(start_), settings_));
  space_.emplace(space_of([this](const std::vector<double>& x) { return numbers_at(task_, x); },
                          [this](const std::vector<double>& x) { return span_at(task_, x); }));
  // What is wrong with the question shows at the start.
  aims_->scale_by(numbers_of(space_->values(start_)));
  problem_ = problem_over(*space_, start_, lower, upper, !speeds_vary(task));
}

void TuneSearch::run(TuneResult& result) {
  result.design = first_search();
  confirm(result);
  searched_ = counts_;
  result.start = start_;
  result.tuned = to_vector(result.design.x);
  for (const ConditionPart& part : aims_->parts()) result.condition_of.push_back(part.of);
}

bool TuneSearch::auto_modes() const { return is_auto(task_.settings.modes); }

int TuneSearch::num_modes() const { return std::get<int>(settings_.modes); }

Scene TuneSearch::scene_at(const std::vector<double>& x) const { return task_.family.scene(numbers_at(task_, x)); }

// As many as the ends of the range and `speeds` need.
int TuneSearch::modes_needed(const std::vector<double>& x, std::vector<double> speeds) const {
  const bool margin =
      std::ranges::any_of(task_.keeps, [](const Keep& keep) { return is_margin(keep.metric); }) ||
      std::ranges::any_of(task_.goal.terms, [](const GoalTerm& term) { return is_margin(term.metric); });
  Settings settings = task_.settings;
  settings.only = {true, margin, false, false};
  const SceneModel model = make_model(scene_at(x), settings);
  const SpeedSpan span = span_at(task_, x);
  speeds.insert(speeds.end(), {span.from, span.to});
  int modes = 1;
  for (const double speed : speeds) modes = most_modes(analyse(model, speed, settings).rods, modes);
  return modes;
}

DesignSpace TuneSearch::space_of(DesignSpace::At numbers, DesignSpace::SpanAt span) {
  return {task_.family,      settings_, task_.heights, std::move(numbers), std::move(span), aims_->metrics(),
          aims_->required(), counts_,   work_};
}

DesignResult TuneSearch::first_search() {
  bool any = false;
  DesignProblem watched = problem_;
  watched.evaluate = [&](const Eigen::VectorXd& x) {
    std::optional<DesignValues> values = problem_.evaluate(x);
    any = any || values.has_value();
    return values;
  };
  DesignOptions options = task_.options;
  options.max_evaluations = std::max(1, options.max_evaluations - 1);  // and the confirmation
  try {
    DesignResult found = optimise(watched, options);
    note_trials(found);
    return found;
  } catch (const std::invalid_argument&) {
    if (any) throw;
    throw RequestError("vary", "no design", "bounds and speeds with some",
                       "found no design within the bounds that closes and has a periodic solution over all these "
                       "speeds; allowed: bounds and speeds with some");
  }
}

// The worst cases on more speeds, with the errors of their values, and with the modes needed at this design. Where that
// is not what the search knew, it goes on from there.
void TuneSearch::confirm(TuneResult& result) {
  while (true) {
    const std::vector<double> x = to_vector(result.design.x);
    const Stopwatch watch;
    const std::vector<MetricValue> values = confirmed_ = space_->values(x, verification);
    ++result.confirmations;
    const auto checked = aims_->design_values(numbers_of(values));
    const DesignValues& known = result.design.values;
    const bool conditions = known.conditions.size() > 0;
    result.agrees = checked && std::abs(checked->goal - known.goal) <= verification_tolerance * std::abs(known.goal) &&
                    (!conditions || (checked->conditions - known.conditions).maxCoeff() <= verification_tolerance);
    // Excess without allowance, with the error.
    result.holds = result.design.status == DesignStatus::infeasible || !conditions ||
                   (checked && (checked->conditions - aims_->allowance + aims_->allowance_for(values)).maxCoeff() <= 0);
    int modes = num_modes();
    if (auto_modes()) {
      std::vector<double> speeds;
      for (const MetricValue& value : values)
        if (value.speed) speeds.push_back(*value.speed);
      modes = std::max(modes, modes_needed(x, speeds));
    }
    result.modes_suffice = modes == num_modes();
    confirmation_seconds_ += watch.seconds();
    if (!go_on(values, modes, result)) return;
  }
}

// Another search from the design that `values` did not confirm; false: there is none.
bool TuneSearch::go_on(const std::vector<MetricValue>& values, int modes, TuneResult& result) {
  const Eigen::VectorXd needed = aims_->allowance_for(values);
  const int left = task_.options.max_evaluations - static_cast<int>(result.design.trials.size()) -
                   result.confirmations - 1;  // the next confirmation
  if (result.verified() || result.rounds == most_rounds || left < 1 || !needed.allFinite()) return false;
  if (task_.options.stop && task_.options.stop()) return false;
  const DesignValues& known = result.design.values;
  Eigen::VectorXd off = Eigen::VectorXd::Zero(known.conditions.size());
  if (const auto checked = aims_->design_values(numbers_of(values))) off = checked->conditions - known.conditions;
  ++result.rounds;
  std::string why;
  if (!result.agrees) {
    space_->refine(2);
    why += ", more speeds";
  }
  if (!result.modes_suffice) {
    settings_.modes = modes;
    space_->forget();
    aims_->scale_by(numbers_of(space_->values(start_)));
    why += fmt::format(", {} modes", modes);
  }
  if (!result.holds) {
    // A little more than the errors, which are not quite the same at the next design.
    aims_->allowance = aims_->allowance.cwiseMax(1.05 * (needed + off.cwiseMax(0)));
    why += ", room for the values' errors";
  }
  problem_.start = result.design.x;
  DesignOptions local = task_.options;
  local.only_local = true;
  local.max_evaluations = left;
  DesignResult again = optimise(problem_, local);
  note_trials(again);
  again.trials.insert(again.trials.begin(), result.design.trials.begin(), result.design.trials.end());
  again.num_missing += result.design.num_missing;
  again.num_gradients += result.design.num_gradients;
  again.num_for_slopes += result.design.num_for_slopes;
  again.evidence = fmt::format("{}; with{}: {}", result.design.evidence, why.substr(1), again.evidence);
  result.design = std::move(again);
  return true;
}

DesignProblem TuneSearch::problem_over(DesignSpace& space, const std::vector<double>& start,
                                       const std::vector<double>& lower, const std::vector<double>& upper,
                                       bool with_gradient) {
  DesignProblem problem;
  problem.lower = to_eigen(lower);
  problem.upper = to_eigen(upper);
  problem.start = to_eigen(start);
  problem.num_conditions = static_cast<int>(aims_->parts().size());
  problem.num_parts = static_cast<int>(aims_->goal_parts().size());
  problem.evaluate = [this, &space](const Eigen::VectorXd& x) -> std::optional<DesignValues> {
    const std::vector<MetricValue>* metrics = space.try_values(to_vector(x));
    if (!metrics) return std::nullopt;
    return aims_->design_values(numbers_of(*metrics));
  };
  if (!with_gradient) return problem;
  problem.gradient = [this, &space, lower, upper](const Eigen::VectorXd& x) -> std::optional<DesignGradient> {
    const std::optional<Eigen::MatrixXd> slopes = space.gradients(to_vector(x), lower, upper);
    if (!slopes) return std::nullopt;
    return aims_->design_gradient(*slopes, numbers_of(space.values(to_vector(x))));
  };
  return problem;
}

// Of designs tried; neighbours that a difference asked for are none.
void TuneSearch::note_trials(const DesignResult& found) {
  for (const DesignTrial& trial : found.trials) {
    const std::vector<MetricValue>* metrics = trial.for_slopes ? nullptr : space_->known(to_vector(trial.x));
    if (!metrics) continue;
    if (trial.values)
      note_best(numbers_of(*metrics));
    else
      ++without_response_;
  }
}

void TuneSearch::note_best(const std::vector<double>& numbers) {
  std::vector<double> values;  // by condition, of its worst part
  for (const auto& [keep, of] : aims_->parts()) {
    const double value = aims_->value_of(keep.metric, numbers);
    if (of == values.size()) {
      values.push_back(value);
    } else {
      values[of] = keep.at_least ? std::min(values[of], value) : std::max(values[of], value);
    }
  }
  if (best_.empty()) best_ = values;
  for (std::size_t j = 0; j < values.size(); ++j)
    best_[j] = task_.keeps[j].at_least ? std::max(best_[j], values[j]) : std::min(best_[j], values[j]);
}

}  // namespace hb
