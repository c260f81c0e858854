#include "hb/analysis/plane_numbers.hpp"

#include <cmath>

#include "lib/constants.hpp"

namespace hb::scene_plane {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd packed(const HillSystem& system, const Layout& layout) {
  VectorXd v = VectorXd::Zero(layout.size());
  const Index n = layout.matrix();
  v.head(n) = system.mass.reshaped();
  v.segment(n, n) = system.damping.reshaped();
  Index start = 2 * n;
  for (std::size_t p = 0; p < num_powers; ++p) {
    const Eigen::MatrixXcd& c = system.stiffness[p].c;
    v.segment(start, c.size()) = c.real().reshaped();
    v.segment(start + n * layout.columns[p], c.size()) = c.imag().reshaped();
    start += 2 * n * layout.columns[p];
  }
  return v;
}

HillSystem unpacked(const VectorXd& v, const Layout& layout) {
  const Index I = layout.num_modes, n = layout.matrix();
  HillSystem system;
  system.mass = v.head(n).reshaped(I, I);
  system.damping = v.segment(n, n).reshaped(I, I);
  Index start = 2 * n;
  for (std::size_t p = 0; p < num_powers; ++p) {
    const Index columns = layout.columns[p];
    if (columns == 0) continue;
    Eigen::MatrixXcd c(n, columns);
    c.real() = v.segment(start, n * columns).reshaped(n, columns);
    c.imag() = v.segment(start + n * columns, n * columns).reshaped(n, columns);
    system.stiffness[p] = FourierSeries(std::move(c));
    start += 2 * n * columns;
  }
  return system;
}

VectorXd scales(const VectorXd& v, const Layout& layout) {
  const Index I = layout.num_modes, n = layout.matrix();
  VectorXd scale(v.size());
  const auto block = [&](Index start, Index columns) {
    if (columns == 0) return;
    VectorXd own = v.segment(start, n * columns).reshaped(n, columns).cwiseAbs().rowwise().maxCoeff();
    for (Index k = 0; k < I; ++k) {
      for (Index i = 0; i < I; ++i) {
        const double geometric = std::sqrt(own(i + I * i) * own(k + I * k));
        scale.segment(start, n * columns)
            .reshaped(n, columns)
            .row(i + I * k)
            .setConstant(std::max(geometric, own(i + I * k)));
      }
    }
  };
  block(0, 1);
  block(n, 1);
  Index start = 2 * n;
  for (const Index columns : layout.columns) {
    block(start, 2 * columns);
    start += 2 * n * columns;
  }
  return scale;
}

// Rounding counts where the sums, of products of at most 1 each, cancel. None where all coefficients but the first are
// zero.
NumberErrors errors_of(const VectorXd& differences, const MatrixXd& coefficients, const Layout& layout) {
  constexpr double margin = 4;
  const VectorXd others = coefficients.rightCols(coefficients.cols() - 1).cwiseAbs().rowwise().sum();
  const VectorXd sums = others + coefficients.col(0).cwiseAbs();
  const VectorXd errors = (others.array() > 0).select(margin * differences.cwiseMax(eps * sums), 0.0);
  const Index I = layout.num_modes, n = layout.matrix();
  NumberErrors found{errors.head(n).reshaped(I, I), errors.segment(n, n).reshaped(I, I), {}, {}};
  Index start = 2 * n;
  for (std::size_t p = 0; p < num_powers; ++p) {
    const Index columns = layout.columns[p];
    found.stiffness[p] = found.stiffness_sizes[p] = MatrixXd::Zero(I, I);
    for (Index k = 0; k < 2 * columns; ++k, start += n) {  // real parts, then imaginary ones
      const double both_signs = k % columns == 0 ? 1 : 2;
      found.stiffness[p] += both_signs * errors.segment(start, n).reshaped(I, I);
      found.stiffness_sizes[p] += both_signs * sums.segment(start, n).reshaped(I, I);
    }
  }
  return found;
}

GivenErrors given_errors(const HillSystem& system, const NumberErrors& errors, double speed) {
  const Index I = system.num_modes();
  double relative = 0;
  for (Index k = 0; k < I; ++k)
    for (Index i = 0; i < I; ++i)
      if (errors.mass(i, k) > 0)
        relative = std::max(relative, errors.mass(i, k) / std::sqrt(std::abs(system.mass(i, i) * system.mass(k, k))));
  GivenErrors given{errors.damping + relative * system.damping.cwiseAbs(), MatrixXd::Zero(I, I)};
  double power = 1;
  for (std::size_t p = 0; p < num_powers; ++p, power *= speed)
    given.stiffness += power * (errors.stiffness[p] + relative * errors.stiffness_sizes[p]);
  return given;
}

}  // namespace hb::scene_plane
