#include "hb/analysis/tune/tune_space.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lib/stopwatch.hpp"

namespace hb {
namespace {

class TimeCounted {
 public:
  explicit TimeCounted(double& seconds) : seconds_(seconds) {}
  ~TimeCounted() { seconds_ += watch_.seconds(); }
  TimeCounted(const TimeCounted&) = delete;
  TimeCounted& operator=(const TimeCounted&) = delete;

 private:
  double& seconds_;
  Stopwatch watch_;
};

// Names of all that a condition without a name holds for; empty where it is one number.
std::vector<std::string> names_of(const SceneModel& model, const Metric& metric) {
  std::vector<std::string> names;
  switch (metric.kind) {
    case MetricKind::deflection:
    case MetricKind::stress:
    case MetricKind::total_stress:
    case MetricKind::safety:
    case MetricKind::theory:
    case MetricKind::frequency:
    case MetricKind::margin:
    case MetricKind::margin_per_turn:
      for (const RodModel& rod : model.rods)
        if (rod.reported) names.push_back(rod.name);
      break;
    case MetricKind::force:
      if (model.linkage())
        for (const JointForce& joint : forces_of(model, 1, {}).joints) names.push_back(joint.name);
      break;
    default:
      break;
  }
  if (!metric.name.empty() || names.size() < 2) names.clear();
  return names;
}

}  // namespace

DesignSpace::DesignSpace(const SceneFamily& family, const Settings& settings, SectionHeights given_heights, At numbers,
                         SpanAt span, std::vector<Metric> metrics, std::vector<RequiredDecay> required,
                         TuneCounts& counts, const Work& work)
    : family_(family),
      settings_(settings),
      given_heights_(std::move(given_heights)),
      numbers_(std::move(numbers)),
      span_(std::move(span)),
      metrics_(std::move(metrics)),
      required_(std::move(required)),
      counts_(counts),
      work_(work) {}

SceneModel DesignSpace::model(const std::vector<double>& x) const {
  return make_model(family_.scene(numbers_(x)), settings_);
}

// A section known by its shape has a height, whatever is given for all rods.
SectionHeights DesignSpace::heights(const SceneModel& model) const {
  SectionHeights heights = given_heights_;
  const Linkage* linkage = model.linkage();
  if (!linkage) return heights;
  for (const int link : elastic_links(*linkage)) {
    const Body& body = *body_at(*linkage, link);
    if (body.elastic->section_height > 0) heights[body.name] = body.elastic->section_height;
  }
  return heights;
}

SpeedSpan DesignSpace::span(const std::vector<double>& x, int times) const {
  SpeedSpan span = span_(x);
  span.num_nodes *= times_ * times;
  return span;
}

void DesignSpace::refine(int times) {
  times_ *= times;
  known_.clear();
}

std::vector<MetricValue> DesignSpace::values(const std::vector<double>& x, int times) const {
  const SceneModel scene = model(x);
  const SpeedSpan speeds = span(x, times);
  const SectionHeights section = heights(scene);
  DesignAnalysis analysis(scene, settings_, speeds, section, work_, required_);
  std::vector<MetricValue> values;
  for (const Metric& metric : metrics_) {
    values.push_back(analysis.value(metric));
    if (times > 1) complete(values.back(), scene, section, speeds, settings_, metric);
  }
  return values;
}

const std::vector<MetricValue>& DesignSpace::values(const std::vector<double>& x) {
  const auto known = known_.find(x);
  if (known != known_.end()) return known->second;
  const TimeCounted counted(counts_.analyses_seconds);
  ++counts_.analyses;
  return known_.emplace(x, values(x, 1)).first->second;
}

const std::vector<MetricValue>* DesignSpace::try_values(const std::vector<double>& x) {
  try {
    return &values(x);
  } catch (const ObstructedLinkage&) {
    ++counts_.not_closing;
  } catch (const SceneError&) {
    ++counts_.refused;
  }
  return nullptr;
}

const std::vector<MetricValue>* DesignSpace::known(const std::vector<double>& x) const {
  const auto found = known_.find(x);
  return found == known_.end() ? nullptr : &found->second;
}

std::optional<Eigen::MatrixXd> DesignSpace::gradients(const std::vector<double>& x, const std::vector<double>& lower,
                                                      const std::vector<double>& upper) {
  const std::vector<MetricValue>& here = values(x);
  const TimeCounted counted(counts_.gradients_seconds);
  const DesignFamily family{[this](const std::vector<double>& y) { return model(y); },
                            [this](const SceneModel& scene) { return heights(scene); }, lower, upper, settings_};
  std::optional<Eigen::MatrixXd> found = metric_gradients(family, x, metrics_, here);
  ++(found ? counts_.gradients : counts_.gradients_by_differences);
  return found;
}

DesignSpace::Report DesignSpace::report(const std::vector<double>& x, const std::vector<Metric>& metrics, int times,
                                        double tolerance) const {
  const SceneModel scene = model(x);
  const SectionHeights section = heights(scene);
  DesignAnalysis rough(scene, settings_, span(x, 1), section, work_, required_);
  const SpeedSpan speeds = span(x, times);
  DesignAnalysis fine(scene, settings_, speeds, section, work_, required_);
  Report result;
  for (const Metric& metric : metrics) {
    const MetricValue first = rough.value(metric), second = fine.value(metric);
    const bool first_is_worse = better_large(metric.kind) ? first.value < second.value : first.value > second.value;
    MetricValue& worst = result.values.emplace_back(first_is_worse ? first : second);
    complete(worst, scene, section, speeds, settings_, metric);
    result.confirmed.push_back(std::abs(first.value - second.value) <= tolerance * std::abs(worst.value));
  }
  result.curves = fine.curves();
  result.margins = fine.margins();
  for (MetricValue& margin : result.margins)
    complete(margin, scene, section, speeds, settings_, {MetricKind::margin, "", 1, "stable"});
  return result;
}

DesignAims::DesignAims(const Goal& goal, const std::vector<Keep>& keeps, const SceneModel& model) : goal_(goal) {
  const auto add = [&](const Metric& metric) {
    if (std::ranges::find(metrics_, metric) == metrics_.end()) metrics_.push_back(metric);
  };
  const auto part_of = [](Metric metric, const std::string& name) {
    metric.name = name;
    metric.text += ":" + name;
    return metric;
  };
  // Joints are too many to be worth a search each.
  const Metric& first = goal.terms[0].metric;
  if (!goal.weighted && first.kind != MetricKind::force)
    for (const std::string& name : names_of(model, first)) goal_parts_.push_back(part_of(first, name));
  for (const Metric& part : goal_parts_) add(part);
  if (goal_parts_.empty())
    for (const GoalTerm& term : goal.terms) add(term.metric);
  for (std::size_t j = 0; j < keeps.size(); ++j) {
    const std::vector<std::string> names = names_of(model, keeps[j].metric);
    if (names.empty()) parts_.push_back({keeps[j], j});
    for (const std::string& name : names) {
      ConditionPart& part = parts_.emplace_back(keeps[j], j);
      part.keep.metric = part_of(keeps[j].metric, name);
    }
  }
  for (const ConditionPart& part : parts_) add(part.keep.metric);
  allowance = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parts_.size()));
}

std::vector<RequiredDecay> DesignAims::required() const {
  std::vector<RequiredDecay> required;
  for (const ConditionPart& part : parts_)
    if (is_margin(part.keep.metric) && part.keep.bound > 0)
      required.push_back({part.keep.bound, part.keep.metric.kind == MetricKind::margin_per_turn});
  const auto same = [](const RequiredDecay& a, const RequiredDecay& b) {
    return a.bound == b.bound && a.per_turn == b.per_turn;
  };
  required.erase(std::ranges::unique(required, same).begin(), required.end());  // parts of one condition
  return required;
}

void DesignAims::scale_by(std::vector<double> start) {
  start_ = std::move(start);
  if (!goal_.weighted) return;
  for (const GoalTerm& term : goal_.terms) {
    const double value = value_of(term.metric, start_);
    if (std::isfinite(value) && value != 0 && std::isfinite(term.weight / value)) continue;
    const std::string found = fmt::format("{} with the value {} at the start", term.metric.text, value);
    const char* allowed = "quantities that exist there and are not 0, nor so small that the sum overflows";
    throw RequestError("minimise", found, allowed,
                       fmt::format("found {}, allowed in a weighted sum: {}", found, allowed));
  }
}

std::size_t DesignAims::place_of(const Metric& metric) const {
  return static_cast<std::size_t>(std::ranges::find(metrics_, metric) - metrics_.begin());
}

double DesignAims::value_of(const Metric& metric, const std::vector<double>& values) const {
  const std::size_t place = place_of(metric);
  if (place < values.size()) return values[place];
  double worst = values[place_of(goal_parts_.front())];
  for (const Metric& part : goal_parts_) {
    const double value = values[place_of(part)];
    if (std::isnan(value) || (better_large(metric.kind) ? value < worst : value > worst)) worst = value;
  }
  return worst;
}

double DesignAims::factor(const GoalTerm& term) const {
  return goal_.weighted ? term.weight / value_of(term.metric, start_) : 1;
}

double DesignAims::goal(const std::vector<double>& values) const {
  double sum = 0;
  for (const GoalTerm& term : goal_.terms) sum += factor(term) * value_of(term.metric, values);
  return sum;
}

double DesignAims::goal_error(const std::vector<MetricValue>& values) const {
  double sum = 0;
  for (const GoalTerm& term : goal_.terms) sum += std::abs(factor(term)) * values[place_of(term.metric)].error;
  return sum;
}

// The bound; a margin's is the start's where that is larger.
double DesignAims::unit_of(const Keep& keep) const {
  const double at_start = std::abs(value_of(keep.metric, start_));
  double unit = keep.bound;
  if (is_margin(keep.metric) && std::isfinite(at_start)) unit = std::max(unit, at_start);
  return unit > 0 ? unit : 1;
}

double DesignAims::excess(const Keep& keep, double value) const {
  return (keep.at_least ? keep.bound - value : value - keep.bound) / unit_of(keep);
}

std::optional<DesignValues> DesignAims::design_values(const std::vector<double>& values) const {
  DesignValues result;
  result.goal = sign() * goal(values);
  result.conditions = allowance;
  for (std::size_t j = 0; j < parts_.size(); ++j)
    result.conditions(static_cast<Eigen::Index>(j)) += excess(parts_[j].keep, value_of(parts_[j].keep.metric, values));
  result.parts.resize(static_cast<Eigen::Index>(goal_parts_.size()));
  for (std::size_t k = 0; k < goal_parts_.size(); ++k)
    result.parts(static_cast<Eigen::Index>(k)) = sign() * value_of(goal_parts_[k], values);
  if (!std::isfinite(result.goal) || !result.conditions.allFinite() || !result.parts.allFinite()) return std::nullopt;
  return result;
}

DesignGradient DesignAims::design_gradient(const Eigen::MatrixXd& slopes, const std::vector<double>& values) const {
  const auto row = [&](const Metric& metric) { return slopes.row(static_cast<Eigen::Index>(place_of(metric))); };
  DesignGradient result;
  result.goal = Eigen::VectorXd::Zero(slopes.cols());
  result.parts.resize(static_cast<Eigen::Index>(goal_parts_.size()), slopes.cols());
  for (std::size_t k = 0; k < goal_parts_.size(); ++k)
    result.parts.row(static_cast<Eigen::Index>(k)) = sign() * row(goal_parts_[k]);
  if (goal_parts_.empty()) {
    for (const GoalTerm& term : goal_.terms) result.goal += sign() * factor(term) * row(term.metric).transpose();
  } else {
    const auto worst =
        std::ranges::max_element(goal_parts_, {}, [&](const Metric& part) { return sign() * value_of(part, values); });
    result.goal = sign() * row(*worst).transpose();
  }
  result.conditions.resize(allowance.size(), slopes.cols());
  for (std::size_t j = 0; j < parts_.size(); ++j) {
    const Keep& keep = parts_[j].keep;
    result.conditions.row(static_cast<Eigen::Index>(j)) = (keep.at_least ? -1 : 1) / unit_of(keep) * row(keep.metric);
  }
  return result;
}

Eigen::VectorXd DesignAims::allowance_for(const std::vector<MetricValue>& values) const {
  Eigen::VectorXd result(allowance.size());
  for (std::size_t j = 0; j < parts_.size(); ++j) {
    const Keep& keep = parts_[j].keep;
    result(static_cast<Eigen::Index>(j)) = values[place_of(keep.metric)].error / unit_of(keep);
  }
  return result;
}

}  // namespace hb
