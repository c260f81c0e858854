// Damping from measurements that are made up: what they were made with comes back.
#include "hb/analysis/damping_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hb/analysis/request.hpp"

namespace hb {
namespace {

constexpr double omega = 512.5, zeta = 0.0123;

Eigen::VectorXd decay_at(const Eigen::VectorXd& t) {
  const double damped = omega * std::sqrt(1 - zeta * zeta);
  return t.unaryExpr([&](double s) { return 0.3 + 2e-3 * std::exp(-zeta * omega * s) * std::cos(damped * s + 0.7); });
}

Eigen::VectorXd peak_at(const Eigen::VectorXd& w) {
  return w.unaryExpr([](double s) { return 7 / std::hypot(omega * omega - s * s, 2 * zeta * omega * s); });
}

TEST(DampingFit, OfAnExactDecayIsExact) {
  // Uneven times: 40 periods of about 12 values.
  Eigen::VectorXd t(480);
  for (Eigen::Index k = 0; k < t.size(); ++k)
    t(k) = 0.02 + 1e-3 * (static_cast<double>(k) + 0.3 * std::sin(static_cast<double>(k)));
  const DampingFit fit = fit_decay(t, decay_at(t));
  EXPECT_NEAR(fit.frequency, omega, 1e-6 * omega);
  EXPECT_NEAR(fit.ratio, zeta, 1e-4 * zeta);
  EXPECT_LT(fit.residual, 1e-5);
  EXPECT_LT((fit.fitted - decay_at(t)).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(DampingFit, OfAnExactPeakIsExact) {
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(41, 470, 560);
  const DampingFit fit = fit_peak(w, peak_at(w));
  EXPECT_NEAR(fit.frequency, omega, 1e-6 * omega);
  EXPECT_NEAR(fit.ratio, zeta, 1e-4 * zeta);
  EXPECT_LT(fit.residual, 1e-5);
}

// Of 100 noisy records the errors are as large as the standard errors say: mean of their squares 1, with spread 0.14.
TEST(DampingFit, ErrorsAreThoseOfNoise) {
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(300, 0, 0.3), clean = decay_at(t);
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(41, 470, 560), peak = peak_at(w);
  double of_decay = 0, of_frequency = 0, of_peak = 0;
  constexpr int records = 100;
  for (int k = 0; k < records; ++k) {
    const auto noisy = [&](const Eigen::VectorXd& y, double size) {
      return (y.unaryExpr([&](double v) { return v + size * normal(engine); })).eval();
    };
    const DampingFit decay = fit_decay(t, noisy(clean, 5e-5));
    of_decay += std::pow((decay.ratio - zeta) / decay.ratio_error, 2) / records;
    of_frequency += std::pow((decay.frequency - omega) / decay.frequency_error, 2) / records;
    const DampingFit top = fit_peak(w, noisy(peak, 0.02 * peak.maxCoeff()).cwiseMax(0));
    of_peak += std::pow((top.ratio - zeta) / top.ratio_error, 2) / records;
  }
  for (const double mean : {of_decay, of_frequency, of_peak}) {
    EXPECT_GT(mean, 0.5);
    EXPECT_LT(mean, 1.7);
  }
}

TEST(DampingFit, RefusesWhatHoldsNoDamping) {
  const Eigen::VectorXd few = Eigen::VectorXd::LinSpaced(5, 0, 1), many = Eigen::VectorXd::LinSpaced(50, 0, 1);
  EXPECT_THROW((void)fit_decay(few, few), RequestError);
  EXPECT_THROW((void)fit_decay(many, Eigen::VectorXd::Constant(50, 3)), RequestError);
  EXPECT_THROW((void)fit_decay(-many, many), RequestError);
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(50, 1, 2);
  EXPECT_THROW((void)fit_peak(w, w), RequestError);
  EXPECT_THROW((void)fit_peak(w, -w), RequestError);
}

}  // namespace
}  // namespace hb
