#include "hb/analysis/damping_fit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "hb/analysis/request.hpp"
#include "hb/engine/design/design.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_ratio = 1e-7, largest_ratio = 0.95;

// Columns of what enters the measurement linearly, for one omega_0 and zeta.
using FitBasis = std::function<MatrixXd(double omega, double zeta)>;

struct LinearFit {
  VectorXd coefficients, fitted;
  double square = 0;  // of what is left
};

// min |A c - y| of a few columns far from parallel: A^T A c = A^T y.
LinearFit linear_fit(const MatrixXd& A, const VectorXd& y) {
  LinearFit fit;
  fit.coefficients = dense::Lu<double>(MatrixXd(A.transpose() * A)).solve(VectorXd(A.transpose() * y));
  fit.fitted = A * fit.coefficients;
  fit.square = (y - fit.fitted).squaredNorm();
  return fit;
}

// Standard errors of omega_0 and zeta from the Jacobian J of the fitted curve, linear coefficients included:
// covariance = s^2 (J^T J)^-1, s^2 = sum of squares/(values - parameters).
void add_errors(const FitBasis& basis, const VectorXd& y, const LinearFit& fit, DampingFit& result) {
  const MatrixXd A = basis(result.frequency, result.ratio);
  const Index n = A.cols() + 2;
  if (y.size() <= n) {
    result.frequency_error = result.ratio_error = HUGE_VAL;
    return;
  }
  constexpr double step = 1e-5;
  const auto slope = [&](double d_omega, double d_zeta) {
    const auto at = [&](double side) -> VectorXd {
      return basis(result.frequency + side * d_omega, result.ratio + side * d_zeta) * fit.coefficients;
    };
    return ((at(1) - at(-1)) / 2).eval();
  };
  const double d_omega = step * std::max(result.ratio, 1e-3) * result.frequency, d_zeta = step * result.ratio;
  MatrixXd J(y.size(), n);
  J << slope(d_omega, 0) / d_omega, slope(0, d_zeta) / d_zeta, A;
  const MatrixXd covariance =
      fit.square / static_cast<double>(y.size() - n) * dense::inverse(MatrixXd(J.transpose() * J));
  result.frequency_error = std::sqrt(std::max(0.0, covariance(0, 0)));
  result.ratio_error = std::sqrt(std::max(0.0, covariance(1, 1)));
}

// Least squares in omega_0 and zeta, the linear coefficients eliminated, from a start near the answer: NLopt's BOBYQA.
DampingFit refined(const FitBasis& basis, const VectorXd& y, double omega, double zeta, double width) {
  DesignProblem problem;
  problem.lower.resize(2);
  problem.upper.resize(2);
  problem.start.resize(2);
  problem.lower << omega * (1 - width), least_ratio;
  problem.upper << omega * (1 + width), largest_ratio;
  problem.start << omega, std::clamp(zeta, 2 * least_ratio, 0.9 * largest_ratio);
  const double size = y.squaredNorm();
  problem.evaluate = [&](const VectorXd& p) -> std::optional<DesignValues> {
    end_if_wished();
    return DesignValues{std::sqrt(linear_fit(basis(p(0), p(1)), y).square / size), VectorXd()};
  };
  DesignOptions options;
  options.algorithm = DesignAlgorithm::bobyqa;
  options.tolerance = 1e-9;
  options.max_evaluations = 400;
  DampingFit result;
  // Again in a narrow box round what was found: a quadratic model is better there.
  for (const double narrow : {1.0, 0.1, 0.01}) {
    const VectorXd found = optimise(problem, options).x;
    problem.start = found;
    const double d_omega = narrow * 0.1 * width * omega;
    problem.lower << found(0) - d_omega, std::max(least_ratio, found(1) * (1 - 0.5 * narrow));
    problem.upper << found(0) + d_omega, std::min(largest_ratio, found(1) * (1 + 0.5 * narrow));
    result.frequency = found(0);
    result.ratio = found(1);
  }
  const LinearFit fit = linear_fit(basis(result.frequency, result.ratio), y);
  result.fitted = fit.fitted;
  add_errors(basis, y, fit, result);
  return result;
}

double rms_of(const VectorXd& values) { return values.norm() / std::sqrt(static_cast<double>(values.size())); }

void require_increasing(const char* field, const VectorXd& at, Index least) {
  if (at.size() < least)
    throw RequestError(field, fmt::format("{} values", at.size()), fmt::format("{} or more", least));
  for (Index k = 1; k < at.size(); ++k)
    if (!(at(k) > at(k - 1)))
      throw RequestError(field, fmt::format("{} behind {}", at(k), at(k - 1)), "increasing places");
}

FitBasis decay_basis(const VectorXd& t) {
  return [&t](double omega, double zeta) {
    const VectorXd tau = t.array() - t(0);
    const double damped = omega * std::sqrt(1 - zeta * zeta);
    const Eigen::ArrayXd envelope = (-zeta * omega * tau.array()).exp();
    MatrixXd A(t.size(), 3);
    A << (envelope * (damped * tau.array()).cos()).matrix(), (envelope * (damped * tau.array()).sin()).matrix(),
        VectorXd::Ones(t.size());
    return A;
  };
}

}  // namespace

DampingFit fit_decay(const VectorXd& t, const VectorXd& x) {
  constexpr Index least = 8;
  require_increasing("decay", t, least);
  const double length = t(t.size() - 1) - t(0);
  const double spread = rms_of((x.array() - x.mean()).matrix());
  if (!(spread > 1e-12 * std::abs(x.mean())))
    throw RequestError("decay", "values that do not change", "a vibration that dies out");
  // Start: the best of frequencies a quarter of the record's resolution apart, and of damping, on a coarse grid.
  const FitBasis basis = decay_basis(t);
  const double resolution = 2 * std::numbers::pi / length;
  const double highest = std::numbers::pi / (length / static_cast<double>(t.size() - 1));
  double best = HUGE_VAL, omega = resolution, zeta = 0.01;
  for (double w = resolution; w <= highest; w += resolution / 4) {
    end_if_wished();
    for (const double cycles : {0.1, 0.5, 2.0}) {  // e-folds over the record
      const double ratio = std::min(0.5, cycles / (w * length));
      const double square = linear_fit(basis(w, ratio), x).square;
      if (square < best) best = square, omega = w, zeta = ratio;
    }
  }
  if (!(omega < highest * 2 / 3))
    throw RequestError("decay", "fewer than three values in a period", "a record with more values");
  DampingFit fit = refined(basis, x, omega, zeta, 0.6 * resolution / omega);
  fit.residual = rms_of(x - fit.fitted) / spread;
  return fit;
}

DampingFit fit_peak(const VectorXd& omega, const VectorXd& amplitude) {
  constexpr Index least = 5;
  require_increasing("peak", omega, least);
  if (!(omega(0) > 0)) throw RequestError("peak", fmt::format("the frequency {}", omega(0)), "frequencies > 0");
  if (!(amplitude.minCoeff() >= 0))
    throw RequestError("peak", fmt::format("the amplitude {}", amplitude.minCoeff()), "amplitudes >= 0");
  Index top = 0;
  const double largest = amplitude.maxCoeff(&top);
  if (top == 0 || top == amplitude.size() - 1)
    throw RequestError("peak", "the largest amplitude at an end", "values on both sides of a peak");
  // Start: the half-power width, 2 zeta omega_0.
  Index from = top, to = top;
  while (from > 0 && amplitude(from) > largest / std::numbers::sqrt2) --from;
  while (to < amplitude.size() - 1 && amplitude(to) > largest / std::numbers::sqrt2) ++to;
  const double zeta = (omega(to) - omega(from)) / (2 * omega(top));
  const FitBasis basis = [&](double w, double ratio) -> MatrixXd {
    const Eigen::ArrayXd square = omega.array().square(), difference = w * w - square;
    return (w * w / (difference.square() + 4 * ratio * ratio * w * w * square).sqrt()).matrix();
  };
  DampingFit fit = refined(basis, amplitude, omega(top), zeta, std::min(0.5, std::max(2 * zeta, 1e-3)));
  fit.residual = rms_of(amplitude - fit.fitted) / rms_of(amplitude);
  return fit;
}

}  // namespace hb
