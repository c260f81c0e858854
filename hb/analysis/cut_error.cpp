#include "hb/analysis/cut_error.hpp"

#include <cmath>
#include <numbers>

#include "lib/stop_wish.hpp"

namespace hb {
namespace {

// The error of I modes falls at least like I^-3, and I grows by half: the difference is at least 1 - 1.5^-3 = 0.7 of
// the error. The factor 2 covers that and neighbouring modes of unequal weight (chosen by experiment).
constexpr double cut_safety = 2;

double relative_change(const Eigen::MatrixXd& coarse, const Eigen::MatrixXd& fine) {
  const double scale = fine.cwiseAbs().maxCoeff();
  return scale == 0 ? 0 : cut_safety * ((coarse - fine).cwiseAbs().maxCoeff() / scale);
}

}  // namespace

CutError cut_error(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                   const FourierSeries& finer) {
  // Four points per half-wave of the finest mode, and at least as many per period of the highest harmonic. At joint 0
  // both are zero.
  const Eigen::Index num_x = std::max<Eigen::Index>(32, 4 * finer.num_components());
  const Eigen::Index harmonics = std::max(q.num_harmonics(), finer.num_harmonics());
  const Eigen::Index num_samples = fourier::fast_length(4 * std::max<Eigen::Index>(16, harmonics));
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(num_x, link.length / static_cast<double>(num_x), link.length);
  const RodField coarse = rod_field(link, rod, speed, q, x, num_samples);
  end_if_wished();
  const RodField fine = rod_field(link, rod, speed, finer, x, num_samples);
  return {relative_change(coarse.w, fine.w), relative_change(coarse.bending_moment, fine.bending_moment)};
}

PeakErrors peak_errors(const Body& link, const RodShape& shape, const FourierSeries& q, double error_bound,
                       const CutError& cut) {
  double largest = 0;
  for (Eigen::Index i = 0; i < q.num_components(); ++i) largest = std::max(largest, fourier::max_abs(q, i).value);
  // w = sum q_i sin(i pi x/l): at most I times the error of a q_i; w'': sum (i pi/l)^2 times.
  const auto I = static_cast<double>(q.num_components());
  const double k = std::numbers::pi / link.length, of_each = error_bound * largest;
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  return {I * of_each + cut.deflection * shape.deflection.max_abs,
          EJ * k * k * I * (I + 1) * (2 * I + 1) / 6 * of_each + cut.bending_moment * shape.bending_moment.max_abs};
}

}  // namespace hb
