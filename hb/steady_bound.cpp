#include "hb/steady_bound.hpp"

#include <cmath>
#include <random>

namespace hb::steady {

namespace {

using Index = Eigen::Index;

// Two solves estimate the norm of the inverse from below; this factor is a choice, its coverage is tested, not proved.
constexpr double safety = 3;
// Cap on the amplification granted to omitted rows that are coupled more strongly than their diagonal: a choice, not a
// bound; coverage is tested on such systems.
constexpr double most_tail_slack = 30;

double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T) { return (T.cwiseAbs() * sizes).maxCoeff(); }

Eigen::VectorXd wiener(const Eigen::MatrixXd& moduli) {
  return 2 * moduli.colwise().sum().transpose() - moduli.row(0).transpose();
}

}  // namespace

double size_in_q(const Spectrum& x, const Eigen::MatrixXd& T) { return weigh(wiener_norms(x), T); }

double response(Operator& A, Inverse& inverse, const Eigen::MatrixXd& T) {
  constexpr double accuracy = 0.1;
  const Index H = A.num_harmonics(), I = A.num_modes();
  // Phases at random, the same ones every time; size falling with k as that of rounding errors does, u = D^-1 rhs.
  std::mt19937 random(12345);
  Spectrum rhs(H + 1, I), z;
  const double unit = 2.0 / 4294967295.0;
  for (Index k = 0; k <= H; ++k)
    for (Index i = 0; i < I; ++i) {
      const double re = unit * static_cast<double>(random()) - 1;
      const double im = k > 0 ? unit * static_cast<double>(random()) - 1 : 0;
      const double n = static_cast<double>(k);
      rhs(k, i) = std::complex<double>(re, im) / (A.system().coupling(i) + 1 + n) * (1 + std::abs(A.system().mean(i)));
    }
  double largest = 1;
  for (int step = 0; step < 2; ++step) {
    const Spectrum u = rhs.cwiseQuotient(A.magnitude().cast<std::complex<double>>());
    const double size = size_in_q(u, T);
    inverse.solve(rhs, accuracy, z);
    const double gained = size_in_q(z, T) / size;
    if (!std::isfinite(gained)) return std::nan("");
    largest = std::max(largest, gained);
    rhs = (z * (1 / z.cwiseAbs().maxCoeff())).cwiseProduct(A.magnitude().cast<std::complex<double>>());
  }
  return largest;
}

double amplified(const Operator& A, const Eigen::MatrixXd& r, double response, const Eigen::MatrixXd& T) {
  return amplified(wiener(r.cwiseQuotient(A.magnitude())), response, T);
}

double amplified(const Eigen::VectorXd& sizes, double response, const Eigen::MatrixXd& T) {
  return safety * response * weigh(sizes, T);
}

double tail_row(const Operator& A, const Spectrum& r, Eigen::Index k, const Eigen::MatrixXd& T) {
  Eigen::VectorXd sizes(r.cols());
  for (Index i = 0; i < r.cols(); ++i) {
    const double size = std::abs(r(k, i));
    sizes(i) = size > 0 ? size / std::abs(A.system().D(i, k)) : 0;
  }
  return weigh(sizes, T);
}

// Coupling E shifts w^2 by about E^2/|D(k +- m)|, |D(k +- m)| >= k.
bool resonant_beyond(const WeightedSystem& system, Index H) {
  constexpr double eps = 2.220446049250313e-16;
  for (Index i = 0; i < system.I; ++i) {
    if (!(system.mean(i) > 0 && system.mean(i) < 1e15)) continue;
    const Index k = static_cast<Index>(std::llround(std::sqrt(system.mean(i))));
    if (k <= H) continue;
    const double closest = 32 * eps * system.magnitude(i, k), shift = system.coupling(i) * system.coupling(i);
    if (std::abs(system.D(i, k)) <= closest && shift <= closest * static_cast<double>(k)) return true;
  }
  return false;
}

double tail_slack(const Operator& A, double response) {
  double contraction = 0;
  for (Index k = A.num_harmonics() + 1; k <= A.last_row(); ++k)
    for (Index i = 0; i < A.num_modes(); ++i) {
      const double d = std::abs(A.system().D(i, k));
      if (A.system().coupling(i) > 0) contraction = std::max(contraction, A.system().coupling(i) / d);
    }
  const double among = contraction < 1 - 1 / most_tail_slack ? 1 / (1 - contraction) : most_tail_slack;
  return among * response;
}

}  // namespace hb::steady
