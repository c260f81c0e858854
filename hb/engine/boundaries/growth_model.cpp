#include "hb/engine/boundaries/growth_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hb/engine/boundaries/interpolation.hpp"

namespace hb {

namespace {

using cplx = std::complex<double>;

}  // namespace

GrowthNode pair_node(double x, cplx a, cplx b, double error_a, double error_b) {
  const cplx apart(a.real() - b.real(), a.imag() - b.imag() - std::round(a.imag() - b.imag()));
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
  for (GrowthNode& node : nodes_) {
    real_ = real_ && std::abs(node.Q.imag()) <= 4 * node.Q_error + 1e-14 * std::abs(node.Q);
    node.angle -= std::round(node.angle - nodes_.front().angle);
  }
  if (nodes_.size() < 3) return;
  constexpr double beside = 0.05, together = 0.01;
  const GrowthNode &p = nodes_[0], &q = nodes_[1], &third = nodes_[2];
  const bool at_p = std::abs(third.x - p.x) < std::abs(third.x - q.x);
  const GrowthNode &near = at_p ? p : q, &other = at_p ? q : p;
  const auto passes = [&](const GrowthNode& node) {
    return node.Q.real() <= node.Q_error && std::abs(node.Q) <= together * std::abs(other.Q);
  };
  pass_beside_ = real_ && std::abs(third.x - near.x) <= beside * std::abs(q.x - p.x) && passes(near) && passes(third);
}

bool GrowthModel::consistent() const {
  constexpr double part = 0.1, angle = 0.01;
  GrowthModel others({nodes_.begin(), nodes_.end() - 1});
  const GrowthNode& last = nodes_.back();
  double scale = 0, moved = 0;
  for (const GrowthNode& node : nodes_) {
    scale = std::max(scale, std::abs(node.Q));
    moved = std::max(moved, std::abs(node.angle - last.angle));
  }
  const cplx Q = interpolated<cplx>(others.nodes_, last.x, [](const GrowthNode& node) { return node.Q; }).first;
  const double turns =
      interpolated<double>(others.nodes_, last.x, [](const GrowthNode& node) { return node.angle; }).first;
  return std::abs(Q - last.Q) <= part * scale && std::abs(turns - last.angle) <= angle + part * moved;
}

GrowthBounds GrowthModel::operator()(double x) const {
  const auto [growth, growth_change] =
      interpolated<double>(nodes_, x, [](const GrowthNode& node) { return node.growth; });
  const auto [Q, Q_change] = interpolated<cplx>(
      nodes_, x, [](const GrowthNode& node) { return node.Q; }, pass_beside_);
  double growth_error = interpolation_safety * growth_change, E = interpolation_safety * Q_change;
  // Errors at the two ends count in proportion; what they do to higher terms these show.
  const double part = (x - nodes_[0].x) / (nodes_[1].x - nodes_[0].x);
  growth_error += (1 - part) * nodes_[0].growth_error + part * nodes_[1].growth_error;
  E += (1 - part) * nodes_[0].Q_error + part * nodes_[1].Q_error;
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

double GrowthModel::rise() const {
  const double x = centre();
  const double Q = interpolated<cplx>(nodes_, x, [](const GrowthNode& node) { return node.Q; }).first.real();
  return Q - std::max(nodes_[0].Q.real(), nodes_[1].Q.real());
}

double GrowthModel::centre() const {
  const auto value = [&](double x) {
    return interpolated<cplx>(nodes_, x, [](const GrowthNode& node) { return node.Q; }).first.real();
  };
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
