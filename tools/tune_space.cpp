#include "tools/tune_space.hpp"

#include <chrono>
#include <cmath>
#include <numbers>

namespace hb::tools {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

DesignSpace::DesignSpace(const SceneSource& source, const Settings& settings, SectionHeights given_heights,
                         At overrides, SpanAt span, std::vector<Metric> metrics, double margin, bool per_turn,
                         TuneCounts& counts)
    : source_(source),
      settings_(settings),
      given_heights_(std::move(given_heights)),
      overrides_(std::move(overrides)),
      span_(std::move(span)),
      metrics_(std::move(metrics)),
      margin_(margin),
      per_turn_(per_turn),
      counts_(counts) {
  const std::vector<std::string> paths = source.numeric_paths();
  numbers_.insert(paths.begin(), paths.end());
}

SceneModel DesignSpace::model(const std::vector<double>& x) const {
  return make_model(source_.with(overrides_(x)), settings_);
}

// A section known by its shape gives its height from area and J.
SectionHeights DesignSpace::heights(const SceneModel& model) const {
  SectionHeights heights = given_heights_;
  const Linkage* linkage = model.linkage();
  if (!linkage || heights.contains("*")) return heights;
  for (const int link : elastic_links(*linkage)) {
    const Body& body = *body_at(*linkage, link);
    if (heights.contains(body.name)) continue;
    const double F = body.elastic->area, r2 = body.elastic->second_moment / F;  // radius of gyration squared
    const auto has = [&](const char* key) {
      return numbers_.contains(body.name + ".section." + key) ||
             numbers_.contains(body.name + ".elastic.section." + key);
    };
    if (has("height")) {
      heights[body.name] = std::sqrt(12 * r2);  // J = F h^2/12
    } else if (has("wall")) {
      // J = F (D^2 + d^2)/16, F = pi (D^2 - d^2)/4
      heights[body.name] = std::sqrt((16 * r2 + 4 * F / std::numbers::pi) / 2);
    } else if (has("diameter")) {
      heights[body.name] = 4 * std::sqrt(r2);  // J = F D^2/16
    }
  }
  return heights;
}

SpeedSpan DesignSpace::span(const std::vector<double>& x, int times) const {
  SpeedSpan span = span_(x);
  span.num_nodes *= times;
  return span;
}

void DesignSpace::refine(int times) {
  times_ *= times;
  known_.clear();
}

std::vector<MetricValue> DesignSpace::values(const std::vector<double>& x, int times) const {
  const SceneModel scene = model(x);
  DesignAnalysis analysis(scene, settings_, span(x, times), heights(scene), margin_, per_turn_);
  std::vector<MetricValue> values;
  for (const Metric& metric : metrics_) values.push_back(analysis.value(metric));
  return values;
}

const std::vector<MetricValue>& DesignSpace::values(const std::vector<double>& x) {
  const auto known = known_.find(x);
  if (known != known_.end()) return known->second;
  const Stopwatch watch(counts_.analyses_seconds);
  ++counts_.analyses;
  return known_.emplace(x, values(x, times_)).first->second;
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

std::optional<Eigen::MatrixXd> DesignSpace::gradients(const std::vector<double>& x, const std::vector<double>& lower,
                                                      const std::vector<double>& upper) {
  const std::vector<MetricValue>& here = values(x);
  const Stopwatch watch(counts_.gradients_seconds);
  const DesignFamily family{[this](const std::vector<double>& y) { return model(y); },
                            [this](const SceneModel& scene) { return heights(scene); }, lower, upper, settings_};
  std::optional<Eigen::MatrixXd> found = metric_gradients(family, x, metrics_, here);
  ++(found ? counts_.gradients : counts_.gradients_by_differences);
  return found;
}

DesignSpace::Report DesignSpace::report(const std::vector<double>& x, const std::vector<Metric>& metrics,
                                        int times) const {
  const SceneModel scene = model(x);
  DesignAnalysis analysis(scene, settings_, span(x, times), heights(scene), margin_, per_turn_);
  Report result;
  for (const Metric& metric : metrics) result.values.push_back(analysis.value(metric));
  result.curves = analysis.curves();
  return result;
}

}  // namespace hb::tools
