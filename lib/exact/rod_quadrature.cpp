#include "lib/exact/rod_quadrature.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "lib/constants.hpp"

namespace hb {

namespace {

// P_0 .. P_n at s by (k+1) P_{k+1} = (2k+1) s P_k - k P_{k-1}.
Eigen::VectorXd legendre(Eigen::Index n, double s) {
  Eigen::VectorXd P(n + 1);
  P(0) = 1;
  if (n > 0) P(1) = s;
  for (Eigen::Index k = 1; k < n; ++k) {
    const double m = static_cast<double>(k);
    P(k + 1) = ((2 * m + 1) * s * P(k) - m * P(k - 1)) / (m + 1);
  }
  return P;
}

// P_{n-1} and P_n at s, n > 0.
std::pair<double, double> last_legendre(Eigen::Index n, double s) {
  double before = 1, last = s;
  for (Eigen::Index k = 1; k < n; ++k) {
    const double m = static_cast<double>(k);
    before = std::exchange(last, ((2 * m + 1) * s * last - m * before) / (m + 1));
  }
  return {before, last};
}

// On (-1, 1): points, weights and int_{-1}^{s_k} of the Lagrange polynomial of point m.
struct UnitRule {
  Eigen::VectorXd roots, weight;
  Eigen::MatrixXd integral;
};

// Points are the roots of P_Q by Newton's iteration, weights 2/((1 - s^2) P_Q'(s)^2). The Lagrange polynomial of point
// m is sum_{j<Q} (2j+1)/2 weight_m P_j(s_m) P_j(s), and
//     int_{-1}^s P_0 = s + 1,   int_{-1}^s P_j = (P_{j+1} - P_{j-1})/(2j+1).
UnitRule make_unit_rule(Eigen::Index Q) {
  const double n = static_cast<double>(Q);
  UnitRule rule{Eigen::VectorXd(Q), Eigen::VectorXd(Q), {}};
  Eigen::MatrixXd P(Q + 1, Q);
  for (Eigen::Index k = 0; k < Q; ++k) {
    double s = -std::cos(pi * (static_cast<double>(k) + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      const auto [before, last] = last_legendre(Q, s);
      slope = n * (s * last - before) / (s * s - 1);
      const double change = last / slope;
      s -= change;
      if (std::abs(change) < eps) break;
    }
    rule.roots(k) = s;
    rule.weight(k) = 2 / ((1 - s * s) * slope * slope);
    P.col(k) = legendre(Q, s);
  }
  Eigen::MatrixXd antiderivative(Q, Q);  // row k, column j: int_{-1}^{s_k} P_j
  antiderivative.col(0) = rule.roots.array() + 1;
  for (Eigen::Index j = 1; j < Q; ++j)
    antiderivative.col(j) = (P.row(j + 1) - P.row(j - 1)).transpose() / static_cast<double>(2 * j + 1);
  const Eigen::VectorXd half_odd = Eigen::VectorXd::LinSpaced(Q, 0.5, n - 0.5);  // (2j+1)/2
  rule.integral = antiderivative * half_odd.asDiagonal() * P.topRows(Q) * rule.weight.asDiagonal();
  return rule;
}

// Kept per thread: rods of a sweep use the same ones at every point.
const UnitRule& unit_rule(Eigen::Index Q) {
  thread_local std::map<Eigen::Index, UnitRule> kept;
  const auto found = kept.find(Q);
  if (found != kept.end()) return found->second;
  if (kept.size() > 16) kept.clear();
  return kept.emplace(Q, make_unit_rule(Q)).first->second;
}

}  // namespace

RodQuadrature::RodQuadrature(double l, Eigen::Index num_modes, Eigen::Index num_points) : length(l) {
  const Eigen::Index I = num_modes, Q = num_points > 0 ? num_points : 2 * I + 16;
  const UnitRule& unit = unit_rule(Q);
  x = l / 2 * (1 + unit.roots.array()).matrix();
  weight = l / 2 * unit.weight;
  integral = l / 2 * unit.integral;
  weighted_integral = weight.asDiagonal() * integral;

  shapes.reserve(static_cast<std::size_t>(I * Q));
  for (Eigen::Index point = 0; point < Q; ++point)
    for (Eigen::Index i = 0; i < I; ++i) {
      const double k = static_cast<double>(i + 1) * pi / l, sine = std::sin(k * x(point));
      shapes.push_back({sine, k * std::cos(k * x(point)), -k * k * sine});
    }
}

}  // namespace hb
