#include "hb/analysis/tune/tune_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "hb/analysis/tune/tune_quantities.hpp"
#include "hb/analysis/tune/tune_stress.hpp"
#include "hb/engine/design/differences.hpp"
#include "hb/engine/exponents/hill_sensitivity.hpp"
#include "lib/constants.hpp"
#include "lib/rod/rod_functional.hpp"
#include "lib/rod/shear.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of a number: differences of coefficients lose its square (truncation) and their rounding over it.
constexpr double relative_step = 1e-5;
// Forces are sums over a sampled turn; differences need them to rounding.
constexpr double force_tolerance = 1e-14;

std::vector<double> numbers_of(const VectorXd& x) { return {x.data(), x.data() + x.size()}; }

struct Neighbour {
  SceneModel model;
  SectionHeights heights;
};

// One design and those beside it, each computed once.
class Neighbourhood {
 public:
  Neighbourhood(const DesignFamily& family, const std::vector<double>& x)
      : family_(family),
        x_(Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()))),
        lower_(Eigen::Map<const VectorXd>(family.lower.data(), x_.size())),
        upper_(Eigen::Map<const VectorXd>(family.upper.data(), x_.size())) {
    step_ = relative_step * (upper_ - lower_);
    for (Index i = 0; i < x_.size(); ++i)
      if (x_(i) != 0) step_(i) = std::min(step_(i), relative_step * std::abs(x_(i)));
  }

  const VectorXd& x() const { return x_; }
  const Neighbour& at(const VectorXd& x) {
    const std::vector<double> key = numbers_of(x);
    auto known = known_.find(key);
    if (known == known_.end()) {
      SceneModel model = family_.model(key);
      SectionHeights heights = family_.heights(model);
      known = known_.emplace(key, Neighbour{std::move(model), std::move(heights)}).first;
    }
    return known->second;
  }
  const Neighbour& here() { return at(x_); }

  std::optional<MatrixXd> jacobian(const std::function<OptionalVector(const VectorXd&)>& f) const {
    return difference_jacobian(f, x_, lower_, upper_, step_);
  }
  OptionalVector gradient(const std::function<double(const Neighbour&, const VectorXd&)>& f) {
    const std::optional<MatrixXd> row =
        jacobian([&](const VectorXd& y) { return OptionalVector(VectorXd::Constant(1, f(at(y), y))); });
    if (!row) return std::nullopt;
    return VectorXd(row->row(0).transpose());
  }

 private:
  const DesignFamily& family_;
  VectorXd x_, lower_, upper_, step_;
  std::map<std::vector<double>, Neighbour> known_;
};

// Largest deflection or stress of one rod at one speed.
OptionalVector shape_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value,
                              const Settings& settings) {
  const double speed = *value.speed;
  const std::size_t r = value.index;
  const bool stress = metric.kind == MetricKind::stress;
  const SceneModel& model = near.here().model;
  const RodModel& rod = model.rods[r];
  const std::optional<FourierSeries> unknowns = rod_unknowns(rod, speed, settings);
  if (!unknowns) return std::nullopt;
  const FourierSeries q = ritz_coordinates(*unknowns, rod.num_modes);
  const RodShape shape = shape_of(model, rod, speed, q);
  const RodPeak peak = stress ? shape.bending_moment : shape.deflection;
  const Index I = q.num_components(), H = q.num_harmonics();
  // The place as a part of the rod's length, which may be a variable.
  const double part = rod.link >= 0 ? peak.x / body_at(*model.linkage(), rod.link)->length : 0;
  const auto functional = [&](const SceneModel& other) -> RodFunctional {
    if (rod.link < 0) return {0, point_functional(I, H, static_cast<Index>(peak.x), peak.crank_angle)};
    const Body& link = *body_at(*other.linkage(), rod.link);
    return rod_functional(link, other.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], speed, I, H,
                          stress ? RodQuantity::bending_moment : RodQuantity::deflection, part * link.length,
                          peak.crank_angle);
  };
  const auto factor = [&](const Neighbour& other) {
    return stress ? stress_factor(other.model, other.model.rods[r], other.heights, metric) : 1.0;
  };
  const RodFunctional J = functional(model);
  const std::optional<FourierSeries> lambda =
      solve_adjoint(rod.system, speed, on_unknowns(J.g, rod.system.num_modes()), H);
  if (!lambda) return std::nullopt;
  const double sign = J.offset + fourier::mean_product(J.g, q) < 0 ? -1 : 1;
  return near.gradient([&](const Neighbour& other, const VectorXd&) {
    const RodFunctional K = functional(other.model);
    const double lagrangian =
        K.offset + fourier::mean_product(K.g, q) +
        fourier::mean_product(*lambda, equation_residual(other.model.rods[r].system, speed, *unknowns));
    return sign * factor(other) * lagrangian;
  });
}

// Largest stress, axial and bending together, or smallest safety of one rod at one speed.
OptionalVector whole_stress_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value,
                                     const Settings& settings) {
  const double speed = *value.speed;
  const std::size_t r = value.index;
  const Neighbour& here = near.here();
  const RodModel& rod = here.model.rods[r];
  const std::optional<FourierSeries> unknowns = rod_unknowns(rod, speed, settings);
  if (!unknowns) return std::nullopt;
  const FourierSeries q = ritz_coordinates(*unknowns, rod.num_modes);
  const auto coefficients = [&](const Neighbour& other) -> const RodCoefficients& {
    return other.model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  };
  const auto link = [&](const Neighbour& other) {
    return with_height(other.model, other.model.rods[r], other.heights, metric);
  };
  const Body own = link(here);
  const StressPeak peak =
      stress_peak(metric.kind, stress_cycle(own, coefficients(here), speed, q, {}, 0), own.elastic->strength);
  const auto functional = [&](const Neighbour& other) {
    return stress_functional(metric.kind, link(other), coefficients(other), speed, q.num_components(),
                             q.num_harmonics(), peak, peak.x / own.length);
  };
  const RodFunctional J = functional(here);
  const std::optional<FourierSeries> lambda =
      solve_adjoint(rod.system, speed, on_unknowns(J.g, rod.system.num_modes()), q.num_harmonics());
  if (!lambda) return std::nullopt;
  const double at = J.offset + fourier::mean_product(J.g, q), sign = at < 0 ? -1 : 1;
  // Of a safety n = 1/usage: d n = -n^2 d usage.
  const double factor = metric.kind == MetricKind::safety ? -1 / (at * at) : in_megapascal(here.model.scene.units);
  return near.gradient([&](const Neighbour& other, const VectorXd&) {
    const RodFunctional K = functional(other);
    const double lagrangian =
        K.offset + fourier::mean_product(K.g, q) +
        fourier::mean_product(*lambda, equation_residual(other.model.rods[r].system, speed, *unknowns));
    return sign * factor * lagrangian;
  });
}

// Joint force or torque ripple: all rods take part.
OptionalVector force_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value,
                              const Settings& settings) {
  const double speed = *value.speed;
  const SceneModel& model = near.here().model;
  const Index n = near.x().size();
  std::vector<FourierSeries> q;
  std::vector<std::vector<FourierSeries>> slopes;  // by rod and variable: dq/dx_i
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    const RodModel& rod = model.rods[r];
    const std::optional<FourierSeries> response = rod_unknowns(rod, speed, settings);
    if (!response) return std::nullopt;
    const Index I = response->num_components(), columns = response->c.cols();
    const std::optional<MatrixXd> residuals = near.jacobian([&](const VectorXd& y) {
      const Eigen::MatrixXcd c = equation_residual(near.at(y).model.rods[r].system, speed, *response).c;
      VectorXd parts(2 * c.size());
      parts << c.real().reshaped(), c.imag().reshaped();
      return OptionalVector(parts);
    });
    if (!residuals) return std::nullopt;
    std::vector<FourierSeries>& own = slopes.emplace_back();
    for (Index i = 0; i < n; ++i) {
      FourierSeries change(I, columns - 1);
      change.c.real() = residuals->col(i).head(I * columns).reshaped(I, columns);
      change.c.imag() = residuals->col(i).tail(I * columns).reshaped(I, columns);
      std::optional<FourierSeries> slope = solve_linearised(rod.system, speed, std::move(change), columns - 1);
      if (!slope) return std::nullopt;
      own.push_back(ritz_coordinates(*slope, rod.num_modes));
    }
    q.push_back(ritz_coordinates(*response, rod.num_modes));
  }
  const JointForces forces = forces_of(model, speed, q, force_tolerance);
  const JointQuantities quantities = joint_quantities(forces);
  const auto at_neighbour = [&](const Neighbour& other, const VectorXd& y) {
    std::vector<FourierSeries> moved = q;
    for (std::size_t r = 0; r < q.size(); ++r)
      for (Index i = 0; i < n; ++i) moved[r].c += (y(i) - near.x()(i)) * slopes[r][static_cast<std::size_t>(i)].c;
    return forces_of(other.model, speed, moved, force_tolerance);
  };
  if (metric.kind == MetricKind::torque_ripple) {
    return near.gradient([&](const Neighbour& other, const VectorXd& y) {
      const FourierSeries torque = at_neighbour(other, y).torque;
      return value.factor * (fourier::evaluate(torque, quantities.torque.max.crank_angle)(0) -
                             fourier::evaluate(torque, quantities.torque.min.crank_angle)(0));
    });
  }
  const std::size_t j = value.index;
  const VectorXd direction = fourier::evaluate(forces.joints[j].elastic, quantities.at[j]).normalized();
  return near.gradient([&](const Neighbour& other, const VectorXd& y) {
    return value.factor * direction.dot(fourier::evaluate(at_neighbour(other, y).joints[j].elastic, quantities.at[j]));
  });
}

OptionalVector margin_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value,
                               const Settings& settings) {
  const double speed = *value.speed;
  const std::size_t r = value.index;
  const HillSystem& system = near.here().model.rods[r].system;
  const Stability stability = leading_stability(scale_system(system, speed), settings);
  if (stability.exponents.empty()) return std::nullopt;
  const std::optional<FloquetVectors> vectors = floquet_vectors(system, speed, stability.exponents.front());
  if (!vectors) return std::nullopt;
  const double factor = metric.kind == MetricKind::margin ? -1 : -2 * pi / speed;
  return near.gradient([&](const Neighbour& other, const VectorXd&) {
    return factor * exponent_nearby(*vectors, other.model.rods[r].system).real();
  });
}

// side (r/n - 1), r = omega_1/Omega, of the order and side that the value belongs to.
OptionalVector clearance_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value) {
  const double speed = *value.speed;
  const std::size_t r = value.index;
  const double ratio = frequency_ratio(near.here().model.rods[r].system, speed);
  int order = 1;
  double side = 1, nearest = HUGE_VAL;
  for (int n = 1; n <= metric.orders; ++n) {
    for (const double s : {-1.0, 1.0}) {
      const double off = std::abs(s * (ratio / n - 1) - value.value);
      if (off >= nearest) continue;
      nearest = off;
      order = n;
      side = s;
    }
  }
  return near.gradient([&](const Neighbour& other, const VectorXd&) {
    return side * (frequency_ratio(other.model.rods[r].system, speed) / order - 1);
  });
}

OptionalVector metric_gradient(Neighbourhood& near, const Metric& metric, const MetricValue& value,
                               const Settings& settings) {
  if (!std::isfinite(value.value)) return std::nullopt;
  switch (metric.kind) {
    case MetricKind::deflection:
    case MetricKind::stress:
      return shape_gradient(near, metric, value, settings);
    case MetricKind::total_stress:
    case MetricKind::safety:
      return whole_stress_gradient(near, metric, value, settings);
    case MetricKind::force:
    case MetricKind::torque_ripple:
      return force_gradient(near, metric, value, settings);
    case MetricKind::margin:
    case MetricKind::margin_per_turn:
      return margin_gradient(near, metric, value, settings);
    case MetricKind::clearance:
      return clearance_gradient(near, metric, value);
    case MetricKind::speed_range:
      return VectorXd(VectorXd::Zero(near.x().size()));
    case MetricKind::theory:
      return std::nullopt;  // by differences of whole analyses
    case MetricKind::mass:
      return near.gradient([&](const Neighbour& other, const VectorXd&) { return mass_of(other.model, metric.name); });
    case MetricKind::frequency:
      return near.gradient([&](const Neighbour& other, const VectorXd&) {
        return value.factor * lowest_frequency(other.model.rods[value.index].system);
      });
  }
  return std::nullopt;
}

}  // namespace

std::optional<MatrixXd> metric_gradients(const DesignFamily& family, const std::vector<double>& x,
                                         const std::vector<Metric>& metrics, const std::vector<MetricValue>& values) {
  MatrixXd result(static_cast<Index>(metrics.size()), static_cast<Index>(x.size()));
  try {
    Neighbourhood near(family, x);
    for (std::size_t k = 0; k < metrics.size(); ++k) {
      const OptionalVector row = metric_gradient(near, metrics[k], values[k], family.settings);
      if (!row) return std::nullopt;
      result.row(static_cast<Index>(k)) = row->transpose();
    }
  } catch (const SceneError&) {  // a neighbour that is no scene or does not close
    return std::nullopt;
  }
  return result;
}

}  // namespace hb
