#include "hb/engine/boundaries/cluster_model.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/interpolation.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using cplx = std::complex<double>;

// prod (w - roots_j) but for root `without`: coefficients of w^0 .. w^(n-1), 1.
std::vector<cplx> polynomial(std::span<const cplx> roots, std::size_t without) {
  std::vector<cplx> c = {1};
  for (std::size_t j = 0; j < roots.size(); ++j) {
    if (j == without) continue;
    c.push_back(c.back());
    for (std::size_t k = c.size() - 2; k > 0; --k) c[k] = c[k - 1] - roots[j] * c[k];
    c[0] *= -roots[j];
  }
  return c;
}

// w^n + c_(n-2) w^(n-2) + .. + c_0.
cplx value(const std::vector<cplx>& c, cplx w) {
  cplx sum = w;
  for (std::size_t k = c.size(); k-- > 0;) sum = sum * w + c[k];
  return sum;
}

// What w_j is off by in Weierstrass's iteration: p(w_j)/prod_(k != j) (w_j - w_k).
cplx correction(cplx p, const std::vector<cplx>& w, std::size_t j) {
  for (std::size_t k = 0; k < w.size(); ++k)
    if (k != j) p /= w[j] - w[k];
  return p;
}

// w: near them.
std::vector<cplx> roots(const std::vector<cplx>& c, std::vector<cplx> w) {
  constexpr int most_iterations = 100;
  constexpr double apart = 1e-3;  // that no two begin at one place
  const std::size_t n = c.size() + 1;
  double size = 1e-300;
  for (std::size_t k = 0; k < c.size(); ++k) size = std::max(size, std::pow(std::abs(c[k]), 1.0 / double(n - k)));
  for (std::size_t j = 0; j < n; ++j) w[j] += std::polar(apart * size, 0.4 + two_pi * double(j) / double(n));
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    double largest = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const cplx change = correction(value(c, w[j]), w, j);
      if (!std::isfinite(std::abs(change))) return w;
      w[j] -= change;
      largest = std::max(largest, std::abs(change));
    }
    if (largest <= 4 * eps * size) break;
  }
  return w;
}

}  // namespace

ClusterNode cluster_node(double x, std::span<const cplx> s, std::span<const double> error) {
  const std::size_t n = s.size();
  std::vector<cplx> w(n);
  cplx mean = 0;
  double mean_error = 0, largest_error = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const cplx apart = s[j] - s[0];
    w[j] = {apart.imag() - std::round(apart.imag()), -apart.real()};
    mean += w[j] / double(n);
    mean_error += error[j] / double(n);
    largest_error = std::max(largest_error, error[j]);
  }
  for (cplx& root : w) root -= mean;
  ClusterNode node{x, s[0].real() - mean.imag(), mean_error, w, polynomial(w, n), std::vector<double>(n - 1, 0), true};
  node.c.resize(n - 1);
  for (std::size_t j = 0; j < n; ++j) {
    const std::vector<cplx> others = polynomial(w, j);
    for (std::size_t k = 0; k < n - 1; ++k) node.c_error[k] += (error[j] + mean_error) * std::abs(others[k]);
    node.real = node.real && std::ranges::any_of(w, [&](cplx root) {
                  return std::abs(root - std::conj(w[j])) <= 4 * largest_error + 1e-14 * std::abs(root);
                });
  }
  return node;
}

ClusterModel::Bounds ClusterModel::operator()(double x, double told) const {
  const std::size_t n = nodes_.front().c.size() + 1;
  const bool real = std::ranges::all_of(nodes_, &ClusterNode::real);
  const double part = (x - nodes_[0].x) / (nodes_[1].x - nodes_[0].x);
  const auto at_ends = [&](double at_p, double at_q) { return (1 - part) * at_p + part * at_q; };
  const auto [growth, growth_change] =
      interpolated<double>(nodes_, x, [](const ClusterNode& node) { return node.growth; });
  const double mean =
      growth + interpolation_safety * growth_change + at_ends(nodes_[0].growth_error, nodes_[1].growth_error);
  std::vector<cplx> c(n - 1);
  std::vector<double> error(n - 1);
  for (std::size_t k = 0; k < n - 1; ++k) {
    const auto [coefficient, change] =
        interpolated<cplx>(nodes_, x, [k](const ClusterNode& node) { return node.c[k]; });
    c[k] = real ? coefficient.real() : coefficient;
    error[k] = interpolation_safety * change + at_ends(nodes_[0].c_error[k], nodes_[1].c_error[k]);
  }
  // Each component of the discs |w - w_j| <= n |p(w_j)|/prod_(k != j) |w_j - w_k| has as many zeros as discs.
  const std::vector<cplx> w = roots(c, nodes_[part < 0.5 ? 0 : 1].w);
  std::vector<double> radius(n);
  for (std::size_t j = 0; j < n; ++j) {
    double p = std::abs(value(c, w[j])), power = 1;
    for (std::size_t k = 0; k < n - 1; ++k, power *= std::abs(w[j])) p += error[k] * power;
    radius[j] = double(n) * std::abs(correction(p, w, j));
  }
  Bounds bounds{mean, HUGE_VAL};
  for (std::size_t j = 0; j < n; ++j) {
    bool alone = std::abs(w[j].imag()) <= radius[j];
    for (std::size_t k = 0; k < n; ++k) {
      if (k == j) continue;
      const double apart = std::abs(w[j] - w[k]);
      bounds.apart = std::min(bounds.apart, apart);
      alone = alone && apart > radius[j] + radius[k];
    }
    if (real && alone) continue;
    const double high = mean - w[j].imag() + radius[j];
    if (!(high <= bounds.growth)) bounds.growth = std::isnan(high) ? HUGE_VAL : high;
  }
  // On the line Re s = told, where it is nearest to each root, the polynomial is larger than its error: none is beyond.
  constexpr double margin = 2;
  const double away = told - mean;
  const bool below = std::ranges::all_of(w, [&](cplx root) {
    const cplx u(root.real(), -away);
    double E = 0, power = 1;
    for (std::size_t k = 0; k < n - 1; ++k, power *= std::abs(u)) E += error[k] * power;
    return root.imag() > -away && std::abs(value(c, u)) > margin * E;
  });
  if (below) bounds.growth = std::min(bounds.growth, told);
  return bounds;
}

}  // namespace hb
