#include "hb/analysis/tune/tune_design.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/tune/tune_growth.hpp"
#include "hb/analysis/tune/tune_stress.hpp"
#include "hb/engine/design/worst_case.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

// Modes whose resonances get a sample of their own, and their highest order: above, the load's harmonics have decayed.
constexpr std::size_t resonant_modes = 2;
constexpr double highest_order = 24;

}  // namespace

struct DesignAnalysis::Sample {
  double speed = 0;
  std::vector<FourierSeries> q;  // by rod; empty: no periodic solution
  std::vector<double> deflection, moment;  // by rod
  std::vector<double> forces;  // by joint; empty: not computed
  double ripple = nan;
  std::vector<double> theory;  // by rod; empty: not computed
  std::vector<double> total_stress, usage;  // by rod, of stress_peak; NaN: not computed
  std::vector<double> growth;  // by rod; empty: not computed
};

struct DesignAnalysis::Curve {
  MetricKind kind;
  std::size_t index = 0;  // of rod or joint
  double factor = 1;
  std::string where;
  Body link = {};  // of total_stress and safety: with the height of its section
};

DesignAnalysis::DesignAnalysis(const SceneModel& model, const Settings& settings, SpeedSpan span,
                               SectionHeights heights, const Work& work, std::vector<RequiredDecay> required)
    : model_(model),
      settings_(settings),
      span_(span),
      heights_(std::move(heights)),
      work_(work),
      required_(std::move(required)) {
  required_.insert(required_.begin(), RequiredDecay{});
  const int count = span.from == span.to ? 1 : std::max(2, span.num_nodes);
  for (int k = 0; k < count; ++k) {
    auto sample = std::make_unique<Sample>();
    const double t = count == 1 ? 0 : static_cast<double>(k) / (count - 1);
    sample->speed = k + 1 == count ? span.to : span.from * std::pow(span.to / span.from, t);
    nodes_.push_back(std::move(sample));
  }
}

DesignAnalysis::~DesignAnalysis() = default;

void DesignAnalysis::place_nodes() {
  if (placed_) return;
  placed_ = true;
  // Resonances omega_i = n Omega narrower than the distance of two nodes get a node of their own.
  std::vector<double> more;
  if (nodes_.size() > 1) {
    for (const RodModel& rod : model_.rods) {
      if (!rod.reported) continue;
      std::vector<std::vector<ModeState>> modes;
      for (const auto& node : nodes_) modes.push_back(mean_modes(scale_system(rod.system, node->speed)));
      for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
        const double a = nodes_[k]->speed, b = nodes_[k + 1]->speed;
        for (std::size_t i = 0; i < std::min(resonant_modes, modes[k].size()); ++i) {
          const double first = modes[k][i].frequency / a, last = modes[k + 1][i].frequency / b;
          if (!std::isfinite(first) || !std::isfinite(last)) continue;
          const double low = std::min(first, last), high = std::max(first, last);
          const double half_width = modes[k][i].damping() / a;
          if (!(half_width < 2 * (high - low))) continue;
          for (double n = std::max(1.0, std::floor(low) + 1); n < high && n <= highest_order; ++n)
            more.push_back(a + (n - first) / (last - first) * (b - a));
        }
      }
    }
  }
  for (const double speed : more) {
    auto sample = std::make_unique<Sample>();
    sample->speed = speed;
    nodes_.push_back(std::move(sample));
  }
  std::ranges::sort(nodes_, {}, [](const auto& node) { return node->speed; });
}

void DesignAnalysis::respond() {
  place_nodes();
  work_.for_each(nodes_.size(), [&](std::size_t k) {
    Sample& node = *nodes_[k];
    if (!node.deflection.empty()) return;
    for (std::vector<double>* values : {&node.deflection, &node.moment, &node.total_stress, &node.usage})
      values->assign(model_.rods.size(), nan);
    for (std::size_t r = 0; r < model_.rods.size(); ++r) {
      std::optional<FourierSeries> q = rod_response(model_.rods[r], node.speed, settings_);
      if (!q) {
        node.q.clear();
        return;
      }
      const RodShape shape = shape_of(model_, model_.rods[r], node.speed, *q);
      node.deflection[r] = shape.deflection.max_abs;
      node.moment[r] = shape.bending_moment.max_abs;
      node.q.push_back(std::move(*q));
    }
  });
}

void DesignAnalysis::need_forces() {
  respond();
  const std::size_t joints = forces_of(model_, nodes_.front()->speed, {}).joints.size();
  work_.for_each(nodes_.size(), [&](std::size_t k) {
    Sample& node = *nodes_[k];
    if (!node.forces.empty()) return;
    node.forces.assign(joints, nan);
    if (node.q.size() != model_.rods.size()) return;
    JointQuantities quantities = joint_quantities(forces_of(model_, node.speed, node.q));
    node.forces = std::move(quantities.force);
    node.ripple = quantities.torque.max.value - quantities.torque.min.value;
  });
}

void DesignAnalysis::need_theory() {
  respond();
  work_.for_each(nodes_.size(), [&](std::size_t k) {
    Sample& node = *nodes_[k];
    if (!node.theory.empty()) return;
    node.theory = node.q.size() == model_.rods.size() ? theory_of(model_, node.speed, node.q)
                                                      : std::vector<double>(model_.rods.size(), nan);
  });
}

double DesignAnalysis::whole_stress(const Curve& curve, double speed, const FourierSeries& q) const {
  const auto coefficients = static_cast<std::size_t>(model_.rods[curve.index].coefficients);
  const StressCycle cycle = stress_cycle(curve.link, model_.coefficients.rods[coefficients], speed, q, {}, 0);
  return stress_peak(curve.kind, cycle, curve.link.elastic->strength).value;
}

void DesignAnalysis::need_whole_stress(const std::vector<Curve>& curves) {
  respond();
  work_.for_each(nodes_.size(), [&](std::size_t k) {
    Sample& node = *nodes_[k];
    if (node.q.size() != model_.rods.size()) return;
    for (const Curve& curve : curves) {
      double& value = (curve.kind == MetricKind::safety ? node.usage : node.total_stress)[curve.index];
      if (std::isnan(value)) value = whole_stress(curve, node.speed, node.q[curve.index]);
    }
  });
}

// Growth of every rod at every node, and at new ones in narrow bands between them.
void DesignAnalysis::find_instabilities() {
  if (!nodes_.front()->growth.empty()) return;
  place_nodes();
  for (auto& node : nodes_) node->growth.resize(model_.rods.size());
  std::vector<double> found;
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    // The verdict is the mechanism's; conditions are those of the rods asked for.
    const auto asked = model_.rods[r].reported ? required_ : std::vector<RequiredDecay>(1);
    std::vector<double> speeds, growth;
    for (const auto& node : nodes_) speeds.push_back(node->speed);
    const std::vector<double> own = unstable_speeds(model_.rods[r].system, asked, settings_, work_, speeds, growth);
    for (std::size_t k = 0; k < nodes_.size(); ++k) nodes_[k]->growth[r] = growth[k];
    found.insert(found.end(), own.begin(), own.end());
  }
  std::vector<std::unique_ptr<Sample>> more(found.size());
  work_.for_each(found.size(), [&](std::size_t k) {
    more[k] = std::make_unique<Sample>();
    more[k]->speed = found[k];
    for (const RodModel& rod : model_.rods)
      more[k]->growth.push_back(growth_of(leading_stability(scale_system(rod.system, found[k]), settings_)));
  });
  for (auto& sample : more) nodes_.push_back(std::move(sample));
  std::ranges::sort(nodes_, {}, [](const auto& node) { return node->speed; });
}

std::vector<DesignAnalysis::Curve> DesignAnalysis::curves_of(const Metric& metric) {
  std::vector<Curve> curves;
  std::vector<std::string> names;
  const Units& units = model_.scene.units;
  const auto choose = [&](std::size_t index, const std::string& name, double factor) {
    names.push_back(name);
    if (metric.name.empty() || metric.name == name) curves.push_back({metric.kind, index, factor, name});
  };
  const bool needs_linkage = metric.kind == MetricKind::stress || is_whole_stress(metric) ||
                             metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple ||
                             metric.kind == MetricKind::mass || metric.kind == MetricKind::theory;
  if (needs_linkage && !model_.linkage())
    throw RequestError(metric.text, "a [hill] scene", "deflection, stable, frequency, clearance",
                       "found in a [hill] scene, which has no links; allowed there: deflection, stable, frequency, "
                       "clearance");
  const bool needs_rods = metric.kind != MetricKind::force && metric.kind != MetricKind::torque_ripple;
  if (needs_rods && model_.rods.empty())
    throw RequestError(metric.text, "no elastic link", "force, torque-ripple where no link is elastic");
  switch (metric.kind) {
    case MetricKind::force: {
      const JointForces forces = forces_of(model_, nodes_.front()->speed, {});
      for (std::size_t j = 0; j < forces.joints.size(); ++j) choose(j, forces.joints[j].name, units.force_in_newton());
      break;
    }
    case MetricKind::torque_ripple:
      choose(0, "", units.torque_in_newton_metre());
      break;
    default:
      for (std::size_t r = 0; r < model_.rods.size(); ++r) {
        const RodModel& rod = model_.rods[r];
        if (!rod.reported) continue;
        double factor = 1;
        if (metric.kind == MetricKind::stress && (metric.name.empty() || metric.name == rod.name))
          factor = stress_factor(model_, rod, heights_, metric);
        if (metric.kind == MetricKind::total_stress) factor = in_megapascal(units);
        choose(r, rod.name, factor);
        if (!is_whole_stress(metric) || curves.empty() || curves.back().index != r) continue;
        curves.back().link = with_height(model_, rod, heights_, metric);
        require_strength(curves.back().link, metric);
      }
  }
  if (curves.empty())
    throw RequestError(metric.text, fmt::format("no \"{}\"", metric.name), fmt::format("{}", fmt::join(names, ", ")));
  return curves;
}

double DesignAnalysis::at_node(const Curve& curve, std::size_t node) {
  const Sample& sample = *nodes_[node];
  switch (curve.kind) {
    case MetricKind::deflection:
      return curve.factor * sample.deflection[curve.index];
    case MetricKind::stress:
      return curve.factor * sample.moment[curve.index];
    case MetricKind::total_stress:
      return curve.factor * sample.total_stress[curve.index];
    case MetricKind::safety:
      return sample.usage[curve.index];
    case MetricKind::force:
      return curve.factor * sample.forces[curve.index];
    case MetricKind::torque_ripple:
      return curve.factor * sample.ripple;
    case MetricKind::theory:
      return sample.theory[curve.index];
    case MetricKind::margin:
      return sample.growth[curve.index];
    case MetricKind::margin_per_turn:
      return sample.growth[curve.index] * 2 * pi / sample.speed;
    default:
      return nan;
  }
}

double DesignAnalysis::at(const Curve& curve, double speed) {
  switch (curve.kind) {
    case MetricKind::deflection:
    case MetricKind::stress: {
      const RodModel& rod = model_.rods[curve.index];
      const std::optional<FourierSeries> q = rod_response(rod, speed, settings_);
      if (!q) return nan;
      const RodShape shape = shape_of(model_, rod, speed, *q);
      return curve.factor *
             (curve.kind == MetricKind::stress ? shape.bending_moment.max_abs : shape.deflection.max_abs);
    }
    case MetricKind::total_stress:
    case MetricKind::safety: {
      const std::optional<FourierSeries> q = rod_response(model_.rods[curve.index], speed, settings_);
      return q ? curve.factor * whole_stress(curve, speed, *q) : nan;
    }
    case MetricKind::theory:
    case MetricKind::force:
    case MetricKind::torque_ripple: {
      std::vector<FourierSeries> all;
      for (const RodModel& rod : model_.rods) {
        std::optional<FourierSeries> q = rod_response(rod, speed, settings_);
        if (!q) return nan;
        all.push_back(std::move(*q));
      }
      if (curve.kind == MetricKind::theory) return theory_of(model_, speed, all)[curve.index];
      const JointForces forces = forces_of(model_, speed, all);
      if (curve.kind == MetricKind::force) return curve.factor * joint_quantities(forces).force[curve.index];
      const Range torque = fourier::range(forces.torque, 0);
      return curve.factor * (torque.max.value - torque.min.value);
    }
    case MetricKind::margin:
    case MetricKind::margin_per_turn: {
      const double growth =
          growth_of(leading_stability(scale_system(model_.rods[curve.index].system, speed), settings_));
      return curve.kind == MetricKind::margin ? growth : growth * 2 * pi / speed;
    }
    default:
      return nan;
  }
}

MetricValue DesignAnalysis::worst(const Metric& metric, const std::vector<Curve>& curves) {
  std::vector<double> speeds;
  for (const auto& node : nodes_) speeds.push_back(node->speed);
  std::vector<std::vector<double>> values(curves.size());
  double highest = -HUGE_VAL, lowest = HUGE_VAL;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      values[c].push_back(at_node(curves[c], k));
      if (std::isnan(values[c].back())) return {nan, speeds[k], curves[c].where, curves[c].index};
      highest = std::max(highest, values[c].back());
      lowest = std::min(lowest, values[c].back());
    }
  }
  MetricValue result;
  result.value = -HUGE_VAL;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    // A curve that stays far below the others cannot hold the worst case.
    const double own = *std::ranges::max_element(values[c]);
    if (own < highest - 0.5 * (highest - lowest)) continue;
    const WorstCase found = worst_case([&](double speed) { return at(curves[c], speed); }, speeds, values[c]);
    if (std::isnan(found.value)) return {nan, found.x, curves[c].where, curves[c].index, 1};
    if (found.value > result.value) result = {found.value, found.x, curves[c].where, curves[c].index, curves[c].factor};
  }
  if (metric.kind == MetricKind::margin || metric.kind == MetricKind::margin_per_turn) result.value = -result.value;
  if (metric.kind == MetricKind::safety) result.value = 1 / result.value;
  return result;
}

// For order n the range of r = omega_1/Omega over all speeds must lie on one side of n:
//     c_n = max(min r/n - 1, 1 - max r/n),   clearance = min over rods and n.
MetricValue DesignAnalysis::clearance(const Metric& metric) {
  MetricValue result{HUGE_VAL, std::nullopt, "", 0, 1};
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const RodModel& rod = model_.rods[r];
    if (!rod.reported) continue;
    const auto ratio = [&](double speed) { return frequency_ratio(rod.system, speed); };
    std::vector<double> speeds, values, negative;
    for (const auto& node : nodes_) {
      speeds.push_back(node->speed);
      values.push_back(ratio(node->speed));
      negative.push_back(-values.back());
    }
    const WorstCase most = worst_case(ratio, speeds, values);
    const WorstCase least = worst_case([&](double speed) { return -ratio(speed); }, speeds, negative);
    for (int n = 1; n <= metric.orders; ++n) {
      const double above = -least.value / n - 1, below = 1 - most.value / n;
      const double c = std::max(above, below);
      if (c < result.value) result = {c, above > below ? least.x : most.x, rod.name, r, 1};
    }
  }
  return result;
}

MetricValue DesignAnalysis::value(const Metric& metric) {
  if (metric.kind == MetricKind::clearance) return clearance(metric);
  if (metric.kind == MetricKind::speed_range)
    return {rpm_from_speed(span_.to, model_.scene.units) - rpm_from_speed(span_.from, model_.scene.units), std::nullopt,
            "", 0, 1};
  const std::vector<Curve> curves = curves_of(metric);
  if (metric.kind == MetricKind::mass) return {mass_of(model_, metric.name), std::nullopt, metric.name, 0, 1};
  if (metric.kind == MetricKind::frequency) {
    MetricValue result{HUGE_VAL, std::nullopt, "", 0, 1};
    const double hertz = 1 / (2 * pi * model_.scene.units.time_in_s);
    for (const Curve& curve : curves) {
      const double value = hertz * lowest_frequency(model_.rods[curve.index].system);
      if (value < result.value) result = {value, std::nullopt, curve.where, curve.index, hertz};
    }
    return result;
  }
  if (metric.kind == MetricKind::margin || metric.kind == MetricKind::margin_per_turn) {
    find_instabilities();
  } else if (metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple) {
    need_forces();
  } else if (metric.kind == MetricKind::theory) {
    need_theory();
  } else if (is_whole_stress(metric)) {
    need_whole_stress(curves);
  } else {
    respond();
  }
  return worst(metric, curves);
}

std::vector<MetricValue> DesignAnalysis::margins() {
  find_instabilities();
  std::vector<MetricValue> result;
  for (std::size_t r = 0; r < model_.rods.size(); ++r)
    result.push_back(worst({MetricKind::margin, "", 1, "stable"}, {{MetricKind::margin, r, 1, model_.rods[r].name}}));
  return result;
}

DesignCurves DesignAnalysis::curves() {
  find_instabilities();
  respond();
  DesignCurves result;
  std::vector<std::size_t> rods;
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    if (!model_.rods[r].reported) continue;
    rods.push_back(r);
    result.rods.push_back(model_.rods[r].name);
  }
  const auto rows = static_cast<Eigen::Index>(nodes_.size());
  result.deflection.resize(rows, static_cast<Eigen::Index>(rods.size()));
  result.growth.resize(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Sample& node = *nodes_[static_cast<std::size_t>(k)];
    result.speed.push_back(node.speed);
    result.growth(k) = -HUGE_VAL;
    for (std::size_t j = 0; j < rods.size(); ++j) {
      result.deflection(k, static_cast<Eigen::Index>(j)) = node.deflection[rods[j]];
      result.growth(k) = std::max(result.growth(k), node.growth[rods[j]]);
    }
  }
  return result;
}

}  // namespace hb
