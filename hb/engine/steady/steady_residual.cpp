#include "hb/engine/steady/steady_residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "hb/engine/steady/split_products.hpp"
#include "lib/constants.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;
using Real = long double;

constexpr Real real_eps = std::numeric_limits<Real>::epsilon();

Index longest(const std::array<FourierSeries, 3>& powers) {
  Index H = 0;
  for (const FourierSeries& part : powers) H = std::max(H, part.num_harmonics());
  return H;
}

// S0 + Omega S1 + Omega^2 S2 of one component.
void combine(const std::array<FourierSeries, 3>& powers, Index component, Real Omega, std::vector<Real>& re,
             std::vector<Real>& im) {
  std::fill(re.begin(), re.end(), Real(0));
  std::fill(im.begin(), im.end(), Real(0));
  Real factor = 1;
  for (const FourierSeries& part : powers) {
    for (Index k = 0; k < part.c.cols(); ++k) {
      re[static_cast<std::size_t>(k)] += factor * part.c(component, k).real();
      im[static_cast<std::size_t>(k)] += factor * part.c(component, k).imag();
    }
    factor *= Omega;
  }
}

// q over `unit`, split, and the sum of its coefficients' moduli.
struct Response {
  std::vector<Split> parts;
  std::vector<double> sizes;
};

Response split_response(const FourierSeries& q, Real unit, int bits) {
  const Index H = q.num_harmonics();
  Response response;
  std::vector<Real> re(static_cast<std::size_t>(H + 1)), im(re.size());
  for (Index j = 0; j < q.c.rows(); ++j) {
    Real sum = 0;
    for (Index k = 0; k <= H; ++k) {
      const auto at = static_cast<std::size_t>(k);
      re[at] = static_cast<Real>(q.c(j, k).real()) / unit;
      im[at] = k == 0 ? 0 : static_cast<Real>(q.c(j, k).imag()) / unit;
      sum += 2 * (std::abs(re[at]) + std::abs(im[at]));
    }
    response.sizes.push_back(static_cast<double>(sum));
    response.parts.push_back(split(re, im, bits));
  }
  return response;
}

// Sums over one row of the system, harmonics 0.., and of the moduli of what was added.
struct RowSums {
  explicit RowSums(Index rows) : re(static_cast<std::size_t>(rows + 1)), im(re.size()), size(re.size()) {}
  std::vector<Real> re, im, size;

  void start(const std::vector<Real>& h_re, const std::vector<Real>& h_im, Real unit) {
    for (std::size_t k = 0; k < re.size(); ++k) {
      re[k] = k < h_re.size() ? h_re[k] / unit : 0;
      im[k] = k < h_im.size() && k > 0 ? h_im[k] / unit : 0;
      size[k] = std::abs(re[k]) + std::abs(im[k]);
    }
  }
  // -M q'' - B q' of one component x = q/unit.
  void add_motion(const FourierSeries& q, Index j, Real unit, Real Omega, double mass, double damping) {
    for (Index k = 0; k < q.c.cols(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Real n = static_cast<Real>(k) * Omega, m = n * n * mass, b = n * damping;
      const Real x = static_cast<Real>(q.c(j, k).real()) / unit, y = static_cast<Real>(q.c(j, k).imag()) / unit;
      re[at] += m * x + b * y;
      im[at] += m * y - b * x;
      size[at] += (std::abs(m) + std::abs(b)) * (std::abs(x) + std::abs(y));
    }
  }
  void subtract(const Products& products) {
    for (Index k = 0; k < products.exact_re.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      size[at] += std::abs(products.exact_re(k)) + std::abs(products.exact_im(k));
      re[at] -= static_cast<Real>(products.exact_re(k)) + products.rest_re(k);
      if (k > 0) im[at] -= static_cast<Real>(products.exact_im(k)) + products.rest_im(k);
    }
  }
};

// Harmonics up to the last that is not zero.
Index last_harmonic(const std::vector<Real>& re, const std::vector<Real>& im) {
  std::size_t top = re.size() - 1;
  while (top > 0 && re[top] == 0 && im[top] == 0) --top;
  return static_cast<Index>(top);
}

}  // namespace

// sum_m C_m q_{k-m} with C = C^ + c, q = q^ + p split at grids so coarse that sums of products C^ q^ have no
// rounding in double, or rounding that is known to be less than half of their grid; C^ p + c q is smaller by 2^-bits
// and needs double only.
AccurateResidual accurate_residual(const HillSystem& system, double speed, const FourierSeries& q, double scale) {
  const Index I = system.num_modes(), H = q.num_harmonics();
  const Index P = longest(system.stiffness), F = longest(system.load);
  const Index rows = std::max(H + P, F);
  // A power of two, so that q / unit is exact; the rest of the scale is applied to the residual.
  const Real Omega = speed, unit = std::ldexp(Real(1), std::ilogb(scale)), remaining = unit / static_cast<Real>(scale);
  // A sum holds 2 (2P+1) products at most: 2 bits + log2 of that must fit into 53.
  const bool by_transforms = SampledProducts::suits(P, H);
  const int bits = by_transforms ? SampledProducts::bits
                                 : (52 - static_cast<int>(std::ceil(std::log2(4.0 * static_cast<double>(P) + 2)))) / 2;
  const Response response = split_response(q, unit, bits);
  std::optional<SampledProducts> sampled;
  if (by_transforms) sampled.emplace(response.parts, H + P);

  AccurateResidual result{Eigen::MatrixXcd(rows + 1, I), Eigen::MatrixXd(rows + 1, I)};
  std::vector<Real> c_re(static_cast<std::size_t>(P + 1)), c_im(c_re.size());
  std::vector<Real> h_re(static_cast<std::size_t>(F + 1)), h_im(h_re.size());
  RowSums sums(rows);
  Products products(H + P);
  for (Index i = 0; i < I; ++i) {
    combine(system.load, i, Omega, h_re, h_im);
    sums.start(h_re, h_im, unit);
    // Sum over all harmonics of the rounding of C and of the low parts: charged to harmonic 0, where |D| is least.
    Real total = 0, of_each = 0;
    for (Index j = 0; j < I; ++j) {
      end_if_wished();
      sums.add_motion(q, j, unit, Omega, system.mass(i, j), system.damping(i, j));
      combine(system.stiffness, i + I * j, Omega, c_re, c_im);
      c_im[0] = 0;
      const Index top = last_harmonic(c_re, c_im);
      Real c_size = 0;
      for (std::size_t m = 0; m <= static_cast<std::size_t>(top); ++m)
        c_size += 2 * (std::abs(c_re[m]) + std::abs(c_im[m]));
      if (!(c_size > 0)) continue;
      const auto component = static_cast<std::size_t>(j);
      const Split entry = split(c_re, c_im, bits);
      const Real size = c_size * static_cast<Real>(response.sizes[component]);
      if (const std::optional<double> error = sampled ? sampled->multiply(entry, component, products) : std::nullopt) {
        of_each += static_cast<Real>(*error);
      } else {
        products.multiply(entry, top, P, response.parts[component], H);
        total += size * static_cast<Real>(2 * top + 16) * static_cast<Real>(eps) * std::ldexp(Real(1), -bits);
      }
      sums.subtract(products);
      total += 2 * real_eps * size;
    }
    for (Index k = 0; k <= rows; ++k) {
      const auto at = static_cast<std::size_t>(k);
      result.r(k, i) = {static_cast<double>(sums.re[at] * remaining), static_cast<double>(sums.im[at] * remaining)};
      result.rounding(k, i) =
          static_cast<double>((4 * real_eps * sums.size[at] + of_each + (k == 0 ? total : 0)) * remaining);
    }
  }
  return result;
}

}  // namespace hb::steady
