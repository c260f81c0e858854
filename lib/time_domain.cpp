#include "lib/time_domain.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

namespace hb {

namespace {

// f = a_0 + sum_k (a_k cos k tau + b_k sin k tau), with a_0 = c_0, a_k = 2 Re c_k, b_k = -2 Im c_k, for the components
// that are not identically zero.
struct TrigonometricSum {
  Eigen::MatrixXd a, b;  // components x (H+1)

  TrigonometricSum(const std::array<FourierSeries, 3>& powers, Eigen::Index num_components, double Omega) {
    Eigen::Index columns = 1;
    for (const FourierSeries& series : powers) columns = std::max(columns, series.c.cols());
    a.setZero(num_components, columns);
    b.setZero(num_components, columns);
    double factor = 1;
    for (const FourierSeries& series : powers) {
      if (series.c.cols() > 0) {
        a.leftCols(series.c.cols()) += 2 * factor * series.c.real();
        b.leftCols(series.c.cols()) -= 2 * factor * series.c.imag();
      }
      factor *= Omega;
    }
    a.col(0) *= 0.5;
  }

  void evaluate(double tau, Eigen::Ref<Eigen::VectorXd> f) const {
    f = a.col(0);
    for (Eigen::Index k = 1; k < a.cols(); ++k)
      f += std::cos(static_cast<double>(k) * tau) * a.col(k) + std::sin(static_cast<double>(k) * tau) * b.col(k);
  }
};

}  // namespace

TimeDomainSystem time_domain_system(const HillSystem& system, double speed) {
  if (!(speed > 0 && std::isfinite(speed)))
    throw std::invalid_argument("time_domain_system: speed must be positive and finite, is " + std::to_string(speed));
  const Eigen::Index I = system.num_modes();
  const auto stiffness = std::make_shared<const TrigonometricSum>(system.stiffness, I * I, speed);
  const auto load = std::make_shared<const TrigonometricSum>(system.load, I, speed);
  Eigen::VectorXd entries(I * I);
  return {
      speed, system.mass, system.damping,
      [I, stiffness, load, entries](double tau, Eigen::Ref<Eigen::MatrixXd> C, Eigen::Ref<Eigen::VectorXd> h) mutable {
        stiffness->evaluate(tau, entries);
        C = Eigen::Map<const Eigen::MatrixXd>(entries.data(), I, I);
        load->evaluate(tau, h);
      }};
}

}  // namespace hb
