#include "hb/engine/exponents/periodic_exponents.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "hb/engine/exponents/exponent_summary.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/fourier/fourier.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Coefficients {
  FourierSeries series;
  double error = 0;  // of any entry over its column's weight: harmonics cut, harmonics beyond the samples, rounding
};

// Harmonics that end the series below rounding are cut. What the samples cannot tell, harmonics beyond half their
// number folded back, is guessed from the last quarter of those that they show.
Coefficients series_of(const MatrixXd& samples, const VectorXd& weights) {
  const Index n = weights.size();
  Coefficients result{fourier::analyse(samples), 0};
  FourierSeries& series = result.series;
  VectorXd weight(n * n);
  for (Index k = 0; k < n; ++k) weight.segment(n * k, n).setConstant(weights(k));
  const VectorXd rounding = 4 * eps * samples.cwiseAbs().rowwise().maxCoeff().cwiseQuotient(weight);
  const Index all = series.num_harmonics();
  const auto of = [&](Index k) { return VectorXd(2 * series.c.col(k).cwiseAbs().cwiseQuotient(weight)); };
  VectorXd last_quarter = VectorXd::Zero(n * n);
  for (Index k = all; k > 0 && 4 * k > 3 * all; --k) last_quarter += of(k);
  const double largest = std::max(rounding.maxCoeff(), 1e-300);
  VectorXd cut = VectorXd::Zero(n * n);
  Index H = all;
  for (; H > 0; --H) {
    if (!((cut + of(H)).maxCoeff() <= largest)) break;
    cut += of(H);
  }
  result.error = (rounding + cut + last_quarter).maxCoeff();
  series = fourier::resized(series, H);
  return result;
}

// Of the system averaged over the period: pairs of roots of z^2 + b z + w2, ascending w2.
struct MeanModes {
  VectorXd w2, b;
};

// x'' + beta x' + alpha x = 0 with the means: eigenvalues of its companion matrix, real ones by two in their order.
MeanModes mean_modes(const NormalForm& form) {
  const Index n = form.num_modes();
  MatrixXd companion = MatrixXd::Zero(2 * n, 2 * n);
  const VectorXd alpha = form.alpha.rowwise().mean(), beta = form.beta.rowwise().mean();
  companion.topRightCorner(n, n).setIdentity();
  companion.bottomLeftCorner(n, n) = -Eigen::Map<const MatrixXd>(alpha.data(), n, n);
  companion.bottomRightCorner(n, n) = -Eigen::Map<const MatrixXd>(beta.data(), n, n);
  const Eigen::VectorXcd roots = dense::eigenvalues(companion);
  std::vector<std::array<double, 2>> pairs;
  std::vector<double> real;
  for (Index k = 0; k < 2 * n; ++k) {
    if (roots(k).imag() > 0) pairs.push_back({std::norm(roots(k)), -2 * roots(k).real()});
    if (roots(k).imag() == 0) real.push_back(roots(k).real());
  }
  std::ranges::sort(real);
  for (std::size_t k = 1; k < real.size(); k += 2) pairs.push_back({real[k - 1] * real[k], -real[k - 1] - real[k]});
  if (pairs.size() != static_cast<std::size_t>(n)) return {VectorXd::Zero(n), VectorXd::Zero(n)};
  std::ranges::sort(pairs);
  MeanModes modes{VectorXd(n), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    modes.w2(i) = pairs[std::size_t(i)][0];
    modes.b(i) = pairs[std::size_t(i)][1];
  }
  return modes;
}

}  // namespace

Stability analyse_stability(const NormalForm& form, double speed, const StabilityOptions& options,
                            const CoefficientErrors& errors) {
  const Index n = form.num_modes();
  const VectorXd w = form.weights();
  const Coefficients alpha = series_of(form.alpha, w), beta = series_of(form.beta, VectorXd::Ones(n));
  ReducedSystem whole;
  whole.converged = true;
  whole.num_modes = n;
  whole.alpha = alpha.series;
  whole.beta = beta.series;
  whole.alpha_error = (alpha.error + errors.alpha) * VectorXd::Ones(n) * w.transpose();
  whole.beta_error = MatrixXd::Constant(n, n, beta.error + errors.beta);
  ExponentSearch search;
  search.exponents = propagated_exponents(whole, options.tolerance, options.leading_only);
  search.method = StabilityMethod::propagation;
  search.evidence = "all unknowns propagated over the period by Radau IIA";
  search.complete = true;
  search.kept.resize(std::size_t(n));
  std::iota(search.kept.begin(), search.kept.end(), Index(0));
  const MeanModes modes = mean_modes(form);
  name_modes(search.exponents, modes.w2, modes.b, search.kept);
  return summary(search, speed, options.tolerance);
}

Stability analyse_stability(const PeriodicSystem& system, const StabilityOptions& options,
                            const CoefficientErrors& errors) {
  return analyse_stability(normal_form(system), system.speed, options, errors);
}

}  // namespace hb
