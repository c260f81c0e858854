#include "tools/sweep_parts.hpp"

#include <array>
#include <complex>
#include <stdexcept>

#include "tools/checkpoint.hpp"

namespace hb::tools {
namespace {

// Writes numbers one after the other, reads them in the same order. One function for both directions keeps them alike.
class Packer {
 public:
  explicit Packer(std::vector<double>& numbers) : numbers_(numbers) {}
  void operator()(double& value) const { numbers_.push_back(value); }

 private:
  std::vector<double>& numbers_;
};

class Unpacker {
 public:
  explicit Unpacker(const std::vector<double>& numbers) : numbers_(numbers) {}
  void operator()(double& value) const {
    if (next_ == numbers_.size()) throw std::out_of_range("part of a sweep");
    value = numbers_[next_++];
  }
  bool at_end() const { return next_ == numbers_.size(); }

 private:
  const std::vector<double>& numbers_;
  mutable std::size_t next_ = 0;
};

template <class Visit, class Number>
void as_number(Visit& visit, Number& value) {
  auto number = static_cast<double>(value);
  visit(number);
  value = static_cast<Number>(number);
}

// The size, then each element by `each`.
template <class Visit, class Container, class Each>
void elements(Visit& visit, Container& container, const Each& each) {
  auto size = static_cast<double>(container.size());
  visit(size);
  if (!(size >= 0 && size <= 1e6)) throw std::out_of_range("part of a sweep");
  container.resize(static_cast<std::size_t>(size));
  for (auto& element : container) each(element);
}

template <class Visit, class Value, class Each>
void maybe(Visit& visit, std::optional<Value>& value, const Each& each) {
  double there = value ? 1 : 0;
  visit(there);
  if (there == 0) {
    value.reset();
  } else {
    if (!value) value.emplace();
    each(*value);
  }
}

template <class Visit>
void visit_stability(Visit& visit, StabilitySample& sample) {
  Stability& stability = sample.stability;
  visit(sample.x);
  visit(sample.speed);
  elements(visit, stability.exponents, [&](Exponent& exponent) {
    double re = exponent.value.real(), im = exponent.value.imag();
    visit(re);
    visit(im);
    exponent.value = {re, im};
    visit(exponent.error);
    as_number(visit, exponent.mode);
    visit(exponent.frequency);
  });
  visit(stability.growth_rate);
  visit(stability.growth_error);
  int verdict = static_cast<int>(stability.verdict);
  as_number(visit, verdict);
  stability.verdict = static_cast<Verdict>(verdict);
  as_number(visit, stability.converged);
}

template <class Visit>
void visit_range(Visit& visit, TurnRange& range) {
  visit(range.min);
  visit(range.max);
}

template <class Visit>
void visit_point(Visit& visit, SweepPoint& point) {
  visit(point.x);
  visit(point.speed);
  elements(visit, point.problem, [&](char& c) { as_number(visit, c); });
  elements(visit, point.rods, [&](RodPoint& rod) {
    maybe(visit, rod.steady, [&](SteadyStatus& status) {
      int number = static_cast<int>(status);
      as_number(visit, number);
      status = static_cast<SteadyStatus>(number);
    });
    as_number(visit, rod.num_harmonics);
    visit(rod.error_bound);
    visit(rod.resonance_distance);
    elements(visit, rod.max_abs, visit);
    maybe(visit, rod.deflection, visit);
    maybe(visit, rod.bending_moment, visit);
    maybe(visit, rod.stability, [&](StabilitySample& sample) { visit_stability(visit, sample); });
  });
  elements(visit, point.joints, [&](TurnRange& range) { visit_range(visit, range); });
  elements(visit, point.joints_rigid, [&](TurnRange& range) { visit_range(visit, range); });
  maybe(visit, point.torque, [&](TurnRange& range) { visit_range(visit, range); });
  maybe(visit, point.torque_rigid, [&](TurnRange& range) { visit_range(visit, range); });
}

void add(TaskKey& key, const std::array<FourierSeries, 3>& powers) {
  for (const FourierSeries& series : powers) {
    key.add(static_cast<double>(series.c.rows())).add(static_cast<double>(series.c.cols()));
    for (const std::complex<double> c : series.c.reshaped()) key.add(c.real()).add(c.imag());
  }
}

}  // namespace

std::vector<double> packed(const SweepPoint& point) {
  std::vector<double> numbers;
  Packer packer(numbers);
  SweepPoint copy = point;
  visit_point(packer, copy);
  return numbers;
}

std::optional<SweepPoint> unpacked(const std::vector<double>& numbers) {
  SweepPoint point;
  Unpacker unpacker(numbers);
  try {
    visit_point(unpacker, point);
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
  if (!unpacker.at_end()) return std::nullopt;
  return point;
}

std::uint64_t sweep_key(const SweepScene& scene) {
  TaskKey key;
  const Settings& settings = scene.settings();
  key.add("sweep").add(scene.axis().path);
  for (const double x : scene.axis().values) key.add(x);
  key.add(static_cast<double>(std::get<int>(settings.modes))).add(settings.tolerance);
  key.add(settings.only.steady).add(settings.only.stability).add(settings.only.reactions).add(settings.only.shape);
  for (const std::string& rod : settings.rods) key.add(rod);
  key.add(static_cast<double>(settings.steady_method)).add(static_cast<double>(settings.stability_method));
  // Numbers of the scene by what they lead to, at both ends of the axis; files that the scene names are in them.
  for (const double x : {scene.axis().values.front(), scene.axis().values.back()}) {
    const ScenePlace place = scene.at(x);
    key.add(place.speed);
    if (!place.model) continue;
    for (const RodModel& rod : place.model->rods) {
      key.add(rod.name);
      for (const double value : rod.system.mass.reshaped()) key.add(value);
      for (const double value : rod.system.damping.reshaped()) key.add(value);
      add(key, rod.system.stiffness);
      add(key, rod.system.load);
    }
    if (settings.only.reactions && place.model->linkage()) {
      // Masses of rigid links do not reach the rods.
      const JointForces forces = joint_forces(*place.model->linkage(), place.speed, {});
      for (const std::complex<double> c : forces.torque_rigid.c.reshaped()) key.add(c.real()).add(c.imag());
    }
  }
  return key.value();
}

}  // namespace hb::tools
