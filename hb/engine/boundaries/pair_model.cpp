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

PairModel::PairModel(std::vector<PairNode> nodes)
    : nodes_(std::move(nodes)), mean_(terms(&LeadingPair::mean)), half_trace_(terms(&LeadingPair::half_trace)) {
  for (std::size_t k = 0; k < std::min<std::size_t>(2, nodes_.size()); ++k) {
    mean_error_ = std::max(mean_error_, nodes_[k].pair.mean_error);
    half_trace_error_ = std::max(half_trace_error_, nodes_[k].pair.half_trace_error);
  }
  for (const PairNode& node : nodes_) largest_ = std::max(largest_, std::abs(node.pair.half_trace));
}

PairModel::Terms PairModel::terms(double LeadingPair::*of) const {
  Terms d;
  d.reserve(nodes_.size());
  for (const PairNode& node : nodes_) d.push_back(node.pair.*of);
  for (std::size_t order = 1; order < d.size(); ++order)
    for (std::size_t k = d.size() - 1; k >= order; --k) d[k] = (d[k] - d[k - 1]) / (nodes_[k].x - nodes_[k - order].x);
  return d;
}

// Not inlined: the same bits whether the error is asked for or not.
[[gnu::noinline]] PairModel::Value PairModel::at(double x, const Terms& terms) const {
  double sum = terms[0], product = 1, last = HUGE_VAL, before = HUGE_VAL;
  for (std::size_t k = 1; k < terms.size(); ++k) {
    product *= x - nodes_[k - 1].x;
    before = last;
    last = std::abs(terms[k] * product);
    sum += terms[k] * product;
  }
  return {sum, terms.size() < 4 ? HUGE_VAL : std::max(of_last_term * last, of_term_before * before)};
}

// The remainder of cos 2 pi phi through n nodes is (2 pi)^n/n! prod (phi - phi_k) at most; twice, as phi is taken for
// linear in x.
PairModel::Value PairModel::half_trace_at(double x) const {
  Value c = at(x, half_trace_);
  const double turned = nodes_[1].turned * (x - nodes_[0].x) / (nodes_[1].x - nodes_[0].x);
  double remainder = 2 * largest_;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    remainder *= two_pi * std::abs(turned - nodes_[k].turned) / static_cast<double>(k + 1);
  if (!(remainder <= c.error)) c.error = std::isnan(remainder) ? HUGE_VAL : remainder;  // not known how far they turned
  return c;
}

PairModel::Bounds PairModel::bounds(double x) const {
  const Value mean = at(x, mean_), c = half_trace_at(x);
  const double E = c.error + half_trace_error_, e = mean.error + mean_error_, size = std::abs(c.value),
               most_apart = std::acosh(std::max(1.0, size + E)) / two_pi;
  return {{mean.value - e + std::acosh(std::max(1.0, size - E)) / two_pi, mean.value + e + most_apart},
          mean.value - e - most_apart};
}

GrowthBounds PairModel::leading(double x) const { return bounds(x).leading; }

double PairModel::predicted(double x) const {
  return at(x, mean_).value + std::acosh(std::max(1.0, std::abs(at(x, half_trace_).value))) / two_pi;
}

double PairModel::lower(double x) const {
  return at(x, mean_).value - std::acosh(std::max(1.0, std::abs(at(x, half_trace_).value))) / two_pi;
}

std::vector<double> PairModel::telling() const {
  std::vector<double> found = probes(nodes_[0].x, nodes_[1].x), places = found;
  places.insert(places.end(), {nodes_[0].x, nodes_[1].x});
  std::ranges::sort(places);
  const auto c = [&](double x) { return at(x, half_trace_).value; };
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
