#include "hb/analysis/cut_error.hpp"

#include <cmath>
#include <numbers>

#include "lib/rod/field_change.hpp"

namespace hb {
namespace {

// The error of I modes falls at least like I^-3, and I grows by half: the difference is at least 1 - 1.5^-3 = 0.7 of
// the error. The factor 2 covers that and neighbouring modes of unequal weight (chosen by experiment).
constexpr double cut_safety = 2;

}  // namespace

CutError cut_error(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                   const FourierSeries& finer) {
  const FieldChange change = field_change(link, rod, speed, q, finer);
  return {cut_safety * change.deflection, cut_safety * change.bending_moment};
}

PeakErrors peak_errors(const Body& link, const RodShape& shape, Eigen::Index num_modes, double largest_q,
                       double error_bound, const CutError& cut) {
  // w = sum q_i sin(i pi x/l): at most I times the error of a q_i; w'': sum (i pi/l)^2 times.
  const auto I = static_cast<double>(num_modes);
  const double k = std::numbers::pi / link.length, of_each = error_bound * largest_q;
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  return {I * of_each + cut.deflection * shape.deflection.max_abs,
          EJ * k * k * I * (I + 1) * (2 * I + 1) / 6 * of_each + cut.bending_moment * shape.bending_moment.max_abs};
}

}  // namespace hb
