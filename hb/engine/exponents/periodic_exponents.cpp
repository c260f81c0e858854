#include "hb/engine/exponents/periodic_exponents.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hb/engine/exponents/exponent_summary.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "lib/constants.hpp"
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
  const auto mean_diagonal = [n](const MatrixXd& samples) {
    const VectorXd means = samples.rowwise().mean();
    return VectorXd(means(Eigen::seqN(0, n, n + 1)));
  };
  name_modes(search.exponents, mean_diagonal(form.alpha), mean_diagonal(form.beta), search.kept);
  return summary(search, speed, options.tolerance);
}

Stability analyse_stability(const PeriodicSystem& system, const StabilityOptions& options,
                            const CoefficientErrors& errors) {
  return analyse_stability(normal_form(system), system.speed, options, errors);
}

}  // namespace hb
