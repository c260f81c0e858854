#include "lib/rod/rod_terms.hpp"

#include <algorithm>
#include <complex>
#include <deque>
#include <utility>

#include "lib/fourier/transpose.hpp"
#include "lib/parts.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"

namespace hb::rod_terms {

namespace {

using Complex = std::complex<double>;

// f_3 q_k, then f_2 q_k, of which the first H harmonics are true: at N angles the highest is folded back to N less it.
Eigen::Map<const Eigen::MatrixXcd> products_with(const FourierSeries& f, const FourierSeries& q, Eigen::Index H) {
  const Eigen::Index I = q.num_components(), F = f.num_harmonics(), Q = q.num_harmonics();
  const Eigen::Index N = angles_from(std::max({F + Q + H, 2 * F, 2 * Q}) + 2);
  fourier::RealTransform& factors = fourier::thread_transform(N, I + 2);
  auto spectrum = factors.spectrum();
  spectrum.setZero();
  spectrum.topLeftCorner(f.c.cols(), 2) = f.c.middleRows(2, 2).transpose();
  spectrum.topRightCorner(q.c.cols(), I) = q.c.transpose();
  factors.backward();
  end_if_wished();
  fourier::RealTransform& products = fourier::thread_transform(N, 2 * I);
  const Eigen::MatrixXd samples = factors.samples();  // with two modes both transforms are the same
  for (Eigen::Index k = 0; k < I; ++k) {
    products.samples().col(k) = samples.col(1).cwiseProduct(samples.col(2 + k));
    products.samples().col(I + k) = samples.col(0).cwiseProduct(samples.col(2 + k));
  }
  products.forward();
  end_if_wished();
  return {products.spectrum().data(), N / 2 + 1, 2 * I};
}

// Without harmonics that are rounding in every component.
void drop_rounding(FourierSeries& T) {
  constexpr double rounding = 1e-16;
  const Eigen::Index n = T.num_components();
  const Eigen::Map<const Eigen::ArrayXXd> numbers = parts(std::as_const(T.c));
  Eigen::ArrayXd floor = Eigen::ArrayXd::Zero(2 * n);
  for (Eigen::Index k = 0; k < numbers.cols(); ++k) floor = floor.max(numbers.col(k).abs());
  for (Eigen::Index i = 0; i < n; ++i) floor.segment<2>(2 * i) = rounding * floor.segment<2>(2 * i).maxCoeff();
  Eigen::Index H = T.num_harmonics();
  while (H > 0 && (numbers.col(H).abs() <= floor).all()) --H;
  T.c.conservativeResize(Eigen::NoChange, H + 1);
}

}  // namespace

Eigen::Index angles_from(Eigen::Index N) {
  constexpr Eigen::Index fewest = 64;
  return fourier::fast_length(std::max(N, fewest));
}

FourierSeries coefficients_at(const RodCoefficients& rod, double speed) {
  Eigen::Index H = 0;
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  FourierSeries sum(5, H);
  double factor = 1;
  for (const FourierSeries& f : rod.f) {
    if (f.c.size() > 0) parts(sum.c).leftCols(f.c.cols()) += factor * parts(f.c);
    factor *= speed;
  }
  return sum;
}

FourierSeries time_functions(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                             Eigen::Index highest) {
  const Eigen::Index I = q.num_components();
  const FourierSeries f = coefficients_at(rod, speed);
  const Eigen::Index H = std::min(q.num_harmonics() + f.num_harmonics(), highest);
  const auto columns = [H](const FourierSeries& series) { return std::min(series.c.cols(), H + 1); };
  FourierSeries T;
  T.c.resize(3 * I + 2, H + 1);
  T.c.topRows(I + 2).setZero();
  T.c.topLeftCorner(I, columns(q)) = q.c.leftCols(columns(q));
  T.c.block(I, 0, 2, columns(f)) = f.c.topLeftCorner(2, columns(f));
  fourier::transpose_singly(products_with(f, q, H).topRows(H + 1), T.c.bottomRows(2 * I));
  for (Eigen::Index n = 1; n <= H; ++n)
    T.c.col(n).tail(2 * I + 2) *= 1.0 / Complex(1, static_cast<double>(n) * speed * link.elastic->internal_damping);
  drop_rounding(T);
  return T;
}

FourierSeries moment_functions(const Body& link, double speed, const FourierSeries& q, FourierSeries T) {
  T.c.topRows(q.num_components()) = fourier::resized(rotation_coordinates(link, speed, q), T.num_harmonics()).c;
  return T;
}

Eigen::MatrixXd over_turn(const FourierSeries& functions, Eigen::Index N) {
  const Eigen::Index n = functions.num_components(), H = functions.num_harmonics();
  fourier::RealTransform& transform = fourier::thread_transform(N, n);
  auto spectrum = transform.spectrum();
  const Eigen::Index resolved = std::min(H, (N - 1) / 2);
  fourier::transpose_singly(functions.c.leftCols(resolved + 1), spectrum.topRows(resolved + 1));
  spectrum.bottomRows(spectrum.rows() - resolved - 1).setZero();
  for (Eigen::Index k = resolved + 1; k <= H; ++k) {
    const Eigen::Index m = k % N;
    const auto c = functions.c.col(k).transpose();
    if (m == 0 || 2 * m == N)
      spectrum.row(m) += 2 * c.real();
    else if (2 * m < N)
      spectrum.row(m) += c;
    else
      spectrum.row(N - m) += c.conjugate();
  }
  transform.backward();
  return transform.samples();
}

Eigen::MatrixXd shape_matrix(const RodShapes& shapes, const Eigen::Ref<const Eigen::VectorXd>& x, int order) {
  Eigen::MatrixXd rows(x.size(), shapes.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) rows.row(j) = shapes.values(x(j), order);
  return rows;
}

ShapeTable::ShapeTable(double l, Eigen::Index I, double shear, const Eigen::Ref<const Eigen::VectorXd>& places)
    : length(l),
      num_modes(I),
      flexibility(shear),
      x(places),
      shapes(l, I, shear),
      deflection(x.size(), shapes.size()),
      curvature(x.size(), shapes.size()) {
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Eigen::MatrixXd orders = shapes.values(x(j), 0, 3);
    deflection.row(j) = orders.row(0);
    curvature.row(j) = orders.row(2);
  }
  largest_deflection = deflection.cwiseAbs().colwise().maxCoeff();
  largest_curvature = curvature.cwiseAbs().colwise().maxCoeff();
}

const ShapeTable& shape_table(double length, Eigen::Index num_modes, double flexibility,
                              const Eigen::Ref<const Eigen::VectorXd>& x) {
  constexpr std::size_t most = 16;
  thread_local std::deque<ShapeTable> tables;
  for (const ShapeTable& table : tables)
    if (table.length == length && table.num_modes == num_modes && table.flexibility == flexibility &&
        table.x.size() == x.size() && table.x == x)
      return table;
  if (tables.size() == most) tables.pop_front();
  return tables.emplace_back(length, num_modes, flexibility, x);
}

}  // namespace hb::rod_terms
