#include "hb/engine/boundaries/growth_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace hb {

namespace {

using cplx = std::complex<double>;
// The last term of an interpolation may be small by chance: its divided difference is taken for a tenth of the one
// before over the distance of the nodes at least, and the term three times.
constexpr double safety = 3, least_part = 0.1;
// Of more nodes than these the term before the last one counts instead, as for a pair apart.
constexpr std::size_t few_nodes = 4;
constexpr double of_last = 10, of_next_to_last = 3;

}  // namespace

GrowthNode pair_node(double x, cplx a, cplx b, double turns, double error_a, double error_b) {
  const cplx apart(a.real() - b.real(), a.imag() - b.imag() - turns);
  const double error = 0.5 * (error_a + error_b);
  return {x,     0.5 * (a.real() + b.real()),      b.imag() + 0.5 * apart.imag(), 0.25 * apart * apart,
          error, (std::abs(apart) + error) * error};
}

std::vector<double> probes(double from, double to) {
  std::vector<double> x;
  const double width = to - from;
  constexpr int middle = 12;
  x.reserve(40);
  for (int k = 1; k < middle; ++k) x.push_back(from + width * k / middle);
  for (double t = 0.05; t > 1e-6; t *= 0.3) {
    x.push_back(from + t * width);
    x.push_back(to - t * width);
  }
  return x;
}

GrowthModel::GrowthModel(std::vector<GrowthNode> nodes) : nodes_(std::move(nodes)) {
  assert(nodes_.size() <= most_nodes);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const GrowthNode& node = nodes_[k];
    real_ = real_ && std::abs(node.Q.imag()) <= 4 * node.Q_error + 1e-14 * std::abs(node.Q);
    growth_[k] = node.growth;
    angle_[k] = node.angle;
    Q_[k] = node.Q;
  }
  const auto divide = [&](auto& d) {
    for (std::size_t order = 1; order < nodes_.size(); ++order)
      for (std::size_t k = nodes_.size() - 1; k >= order; --k)
        d[k] = (d[k] - d[k - 1]) / (nodes_[k].x - nodes_[k - order].x);
  };
  divide(growth_);
  divide(angle_);
  divide(Q_);
}

// Newton's form through the first `count` nodes.
template <class Value>
Value GrowthModel::at(double x, const std::array<Value, most_nodes>& terms, std::size_t count) const {
  Value sum = terms[count - 1];
  for (std::size_t k = count - 1; k-- > 0;) sum = terms[k] + (x - nodes_[k].x) * sum;
  return sum;
}

template <class Value>
double GrowthModel::last_terms(double x, const std::array<Value, most_nodes>& terms) const {
  const std::size_t n = nodes_.size();
  if (n < 3) return HUGE_VAL;
  double before = 1;
  for (std::size_t k = 0; k + 2 < n; ++k) before *= x - nodes_[k].x;
  const double last = std::abs(before * (x - nodes_[n - 2].x));
  if (n > few_nodes)
    return std::max(of_last * std::abs(terms[n - 1]) * last, of_next_to_last * std::abs(terms[n - 2] * before));
  const auto [low, high] = std::ranges::minmax(nodes_, {}, &GrowthNode::x);
  return safety * std::max(std::abs(terms[n - 1]), least_part * std::abs(terms[n - 2]) / (high.x - low.x)) * last;
}

// Of few nodes the errors at the two ends count in proportion; what they do to higher terms these show. Of more the
// errors of all, by Lagrange's polynomials.
GrowthModel::Errors GrowthModel::errors(double x) const {
  Errors sum{last_terms(x, growth_), last_terms(x, Q_)};
  const bool few = nodes_.size() <= few_nodes;
  const std::size_t count = few ? 2 : nodes_.size();
  for (std::size_t k = 0; k < count; ++k) {
    double weight = 1;
    for (std::size_t j = 0; j < count; ++j)
      if (j != k) weight *= (x - nodes_[j].x) / (nodes_[k].x - nodes_[j].x);
    sum.growth += std::abs(weight) * nodes_[k].growth_error;
    sum.Q += std::abs(weight) * nodes_[k].Q_error;
  }
  return sum;
}

bool GrowthModel::consistent() const {
  constexpr double part = 0.1, angle = 0.01;
  const GrowthNode& last = nodes_.back();
  double scale = 0, moved = 0;
  for (const GrowthNode& node : nodes_) {
    scale = std::max(scale, std::abs(node.Q));
    moved = std::max(moved, std::abs(node.angle - last.angle));
  }
  const std::size_t count = nodes_.size() - 1;
  return std::abs(at(last.x, Q_, count) - last.Q) <= part * scale &&
         std::abs(at(last.x, angle_, count) - last.angle) <= angle + part * moved;
}

GrowthBounds GrowthModel::operator()(double x) const {
  const double growth = at(x, growth_, nodes_.size());
  const cplx Q = at(x, Q_, nodes_.size());
  const auto [growth_error, E] = errors(x);
  double low, high;
  if (real_) {
    low = std::sqrt(std::max(Q.real() - E, 0.0));
    high = std::sqrt(std::max(Q.real() + E, 0.0));
  } else {
    const double root = std::abs(std::sqrt(Q).real()), size = std::abs(Q);
    const double change = size > E ? std::min(std::sqrt(E), E / (2 * std::sqrt(size - E))) : std::sqrt(E);
    low = std::max(root - change, 0.0);
    high = root + change;
  }
  return {growth - growth_error + low, growth + growth_error + high};
}

double GrowthModel::rise() const { return real_Q(centre()) - std::max(nodes_[0].Q.real(), nodes_[1].Q.real()); }

double GrowthModel::centre() const {
  const auto value = [&](double x) { return real_Q(x); };
  double low = nodes_[0].x, high = nodes_[1].x;
  // The best of a few places, then golden sections about it.
  constexpr int places = 16;
  double best = 0.5 * (low + high), f_best = -HUGE_VAL;
  for (int k = 0; k <= places; ++k) {
    const double x = low + (high - low) * k / places;
    if (const double f = value(x); f > f_best) {
      f_best = f;
      best = x;
    }
  }
  const double step = (high - low) / places;
  double a = std::max(low, best - step), b = std::min(high, best + step);
  // A parabola through three values is exact near the vertex.
  const double m = 0.5 * (a + b), fa = value(a), fm = value(m), fb = value(b);
  const double curvature = (fa - 2 * fm + fb) / (0.25 * (b - a) * (b - a));
  double x = curvature < 0 ? m - (fb - fa) / (b - a) / curvature : best;
  for (int k = 0; k < 3 && curvature < 0; ++k) {
    const double h = 1e-3 * (high - low);
    const double slope = (value(x + h) - value(x - h)) / (2 * h),
                 second = (value(x + h) - 2 * value(x) + value(x - h)) / (h * h);
    if (!(second < 0)) break;
    x -= slope / second;
  }
  return std::isfinite(x) && x > low && x < high ? x : best;
}

}  // namespace hb
