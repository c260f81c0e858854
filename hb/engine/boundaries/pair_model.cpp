#include "hb/engine/boundaries/pair_model.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/golden_section.hpp"
#include "lib/zero_between.hpp"

namespace hb {

namespace {

// The last term of an interpolation may be small by chance.
constexpr double of_last_term = 3, of_term_before = 0.75;

// Of the distance between two places that lie beside what is looked for.
constexpr double accuracy_inside = 1e-9;
constexpr int steps_inside = 30;

}  // namespace

PairModel::PairModel(std::vector<PairNode> nodes) : nodes_(std::move(nodes)), terms_(terms()) {
  for (std::size_t k = 0; k < std::min<std::size_t>(2, nodes_.size()); ++k) {
    mean_error_ = std::max(mean_error_, nodes_[k].pair.mean_error);
    half_trace_error_ = std::max(half_trace_error_, nodes_[k].pair.half_trace_error);
  }
  for (const PairNode& node : nodes_) largest_ = std::max(largest_, std::abs(node.pair.half_trace));
}

std::vector<PairModel::Both> PairModel::terms() const {
  std::vector<Both> d;
  d.reserve(nodes_.size());
  for (const PairNode& node : nodes_) d.emplace_back(node.pair.mean, node.pair.half_trace);
  for (std::size_t order = 1; order < d.size(); ++order)
    for (std::size_t k = d.size() - 1; k >= order; --k) d[k] = (d[k] - d[k - 1]) / (nodes_[k].x - nodes_[k - order].x);
  return d;
}

// Not inlined: the same bits whether errors are asked for or not.
[[gnu::noinline]] PairModel::Values PairModel::at(double x) const {
  Both sum = terms_[0], last = Both::Constant(HUGE_VAL), before = last;
  double product = 1;
  for (std::size_t k = 1; k < terms_.size(); ++k) {
    product *= x - nodes_[k - 1].x;
    const Both term = terms_[k] * product;
    before = last;
    last = term.abs();
    sum += term;
  }
  const Both error =
      terms_.size() < 4 ? Both::Constant(HUGE_VAL) : Both((of_last_term * last).max(of_term_before * before));
  return {{sum[0], error[0]}, {sum[1], error[1]}};
}

// The remainder of cos 2 pi phi through n nodes is (2 pi)^n/n! prod (phi - phi_k) at most; twice, as phi is taken for
// linear in x.
PairModel::Values PairModel::bounded_at(double x) const {
  Values values = at(x);
  Value& c = values.half_trace;
  const double turned = nodes_[1].turned * (x - nodes_[0].x) / (nodes_[1].x - nodes_[0].x);
  double remainder = 2 * largest_;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    remainder *= two_pi * std::abs(turned - nodes_[k].turned) / static_cast<double>(k + 1);
  if (!(remainder <= c.error)) c.error = std::isnan(remainder) ? HUGE_VAL : remainder;  // not known how far they turned
  return values;
}

PairModel::Bounds PairModel::bounds(double x) const {
  const auto [mean, c] = bounded_at(x);
  const double E = c.error + half_trace_error_, e = mean.error + mean_error_, size = std::abs(c.value),
               most_apart = std::acosh(std::max(1.0, size + E)) / two_pi;
  return {{mean.value - e + std::acosh(std::max(1.0, size - E)) / two_pi, mean.value + e + most_apart},
          mean.value - e - most_apart};
}

GrowthBounds PairModel::leading(double x) const { return bounds(x).leading; }

double PairModel::predicted(double x) const {
  const auto [mean, c] = at(x);
  return mean.value + std::acosh(std::max(1.0, std::abs(c.value))) / two_pi;
}

double PairModel::lower(double x) const {
  const auto [mean, c] = at(x);
  return mean.value - std::acosh(std::max(1.0, std::abs(c.value))) / two_pi;
}

std::vector<double> PairModel::telling() const {
  std::vector<double> found = probes(nodes_[0].x, nodes_[1].x), places = found;
  places.insert(places.end(), {nodes_[0].x, nodes_[1].x});
  std::ranges::sort(places);
  const auto c = [&](double x) { return at(x).half_trace.value; };
  const auto size = [&](double x) { return std::abs(c(x)); };
  std::vector<double> values(places.size());
  std::ranges::transform(places, values.begin(), c);
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const double here = std::abs(values[k]), next = std::abs(values[k + 1]);
    if ((values[k] > 0) != (values[k + 1] > 0))
      found.push_back(zero_between(places[k], places[k + 1], accuracy_inside * (places[k + 1] - places[k]), c));
    if (k == 0) continue;
    const double before = std::abs(values[k - 1]);
    if (here >= before && here >= next)
      found.push_back(largest_between(places[k - 1], places[k + 1], size, steps_inside));
    if (here <= before && here <= next)
      found.push_back(largest_between(
          places[k - 1], places[k + 1], [&](double x) { return -size(x); }, steps_inside));
  }
  return found;
}

}  // namespace hb
