// Products of Fourier series of which the leading bits are exact, for residuals in extended precision.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace hb::steady {

// A series split at a grid: high parts are multiples of `grid`, a power of two, so that products of high parts and
// their sums are exact in double; low = rest. Real and imaginary parts stand apart, harmonics -H..H in a row.
struct Split {
  Eigen::VectorXd high_re, high_im, low_re, low_im;
  double grid = 0;  // 0: the series is zero
};

// Coefficients (re, im of harmonics 0..H) of one component, to `bits` bits of the largest.
[[nodiscard]] Split split(const std::vector<long double>& re, const std::vector<long double>& im, int bits);

// The products of one entry of C with one component of q: `exact` sums and the rest of them, harmonics 0..reach.
struct Products {
  explicit Products(Eigen::Index reach)
      : exact_re(reach + 1), exact_im(reach + 1), rest_re(reach + 1), rest_im(reach + 1) {}
  Eigen::ArrayXd exact_re, exact_im, rest_re, rest_im;

  // Sum by sum. C has harmonics up to `top` of the P that it is split for, q up to H.
  void multiply(const Split& c, Eigen::Index top, Eigen::Index P, const Split& x, Eigen::Index H);
};

// The same at nodes, for many harmonics: sums of products of high parts, known to better than an eighth of their grid,
// are rounded to it, and exact then.
class SampledProducts {
 public:
  static constexpr int bits = 18;
  // Where transforms take less time than sums (a guess from their overhead).
  [[nodiscard]] static bool suits(Eigen::Index P, Eigen::Index H);

  // All components of q; products have harmonics up to `reach`.
  SampledProducts(const std::vector<Split>& q, Eigen::Index reach);

  // Bound on the error of each harmonic of the rest; empty, without products, where rounding may not be exact.
  [[nodiscard]] std::optional<double> multiply(const Split& c, std::size_t component, Products& products);

 private:
  // High and low parts over the turn, and of each the root mean square, which is the norm of its coefficients, and the
  // largest.
  struct Sampled {
    Eigen::ArrayXXd values;  // N x 2
    double high_norm = 0, low_norm = 0, high_largest = 0, low_largest = 0, grid = 0;
  };
  [[nodiscard]] Sampled sampled(const Split& series) const;

  Eigen::Index reach_, N_;
  std::vector<Sampled> q_;
};

}  // namespace hb::steady
