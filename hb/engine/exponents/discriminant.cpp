#include "hb/engine/exponents/discriminant.hpp"

#include <algorithm>
#include <array>
#include <complex>

#include "hb/engine/exponents/constant_coefficients.hpp"
#include "hb/engine/exponents/mathieu_determinant.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/exponents/scalar_hill.hpp"
#include "hb/engine/system/independent_parts.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using cplx = std::complex<double>;

// cosh z for z = 2 pi (s + b/2), and what an error of s does to it:
//     |cosh(z + d) - cosh z| <= |sinh z| sinh |d| + |cosh z| (cosh |d| - 1).
Discriminant from_exponent(cplx s, double s_error, const ScaledSystem& system) {
  const double b = system.G(0, 0);
  Discriminant result;
  result.damping = b;
  result.damping_error = 2 * eps * std::abs(b) + system.G_error(0, 0);
  result.speed = system.speed;
  const cplx z = two_pi * (s + b / 2);
  const double d = two_pi * (s_error + result.damping_error) + 4 * eps * std::abs(z);
  const cplx value = std::cosh(z);
  const double half = std::sinh(d / 2);
  result.value = value.real();
  result.error =
      std::abs(std::sinh(z)) * std::sinh(d) + std::abs(value) * (2 * half * half + 4 * eps) + std::abs(value.imag());
  return result;
}

std::optional<Discriminant> finite(const Discriminant& found) {
  if (!std::isfinite(found.value) || !std::isfinite(found.error)) return std::nullopt;
  return found;
}

std::optional<Discriminant> of_shortest_period(const ScaledSystem& system, double tolerance) {
  if (system.K.num_harmonics() == 0) {
    const TurnExponents roots = constant_exponents(system);
    return finite(from_exponent(roots.s[0], roots.error[0], system));
  }
  const std::array<Index, 1> mode{0};
  const ReducedSystem reduced = slave_to(system, mode);
  // Near |value| = 1 exponents have errors of the size of the root of the determinant's: they suffice all the same.
  if (reduced.alpha.num_harmonics() == 1) {
    const auto pair = mathieu_exponents({.w2 = reduced.alpha.c(0, 0).real(),
                                         .q = std::abs(reduced.alpha.c(0, 1)),
                                         .b = reduced.beta.c(0, 0).real(),
                                         .stiffness_error = reduced.alpha_error(0),
                                         .damping_error = reduced.beta_error(0)});
    if (pair) {
      const Discriminant found = from_exponent(pair->s[0], pair->error[0], system);
      if (found.error <= tolerance * std::max(1.0, std::abs(found.value))) return found;
    }
  }
  const Exponents exponents = reduced_exponents(reduced, tolerance, true);
  if (exponents.s.empty()) return std::nullopt;
  return finite(from_exponent(exponents.s[0], exponents.error[0], system));
}

}  // namespace

std::optional<Discriminant> discriminant(const ScaledSystem& system, Index divisor, double tolerance) {
  const Index own = common_divisor(system);
  if (own % divisor != 0) return std::nullopt;
  return of_shortest_period(divisor > 1 ? with_period_divided(system, divisor) : system, tolerance);
}

}  // namespace hb
