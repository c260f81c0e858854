#include "tools/report/stress_field.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hb/analysis/rod_stress.hpp"
#include "lib/rod/rod.hpp"

namespace hb::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Sine components b_i of values at s = 1/P .. (P - 1)/P, a row for each: b_i = 2/P sum_j f(j/P) sin(i pi j/P).
MatrixXd sine_components(const MatrixXd& values) {
  const Index inner = values.rows();
  const double P = static_cast<double>(inner + 1);
  MatrixXd sines(inner, inner);
  for (Index i = 0; i < inner; ++i)
    for (Index j = 0; j < inner; ++j)
      sines(i, j) = 2 / P * std::sin(std::numbers::pi * static_cast<double>((i + 1) * (j + 1)) / P);
  return sines * values;
}

}  // namespace

Json stress_field(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                  ByteBlock& block) {
  constexpr Index pieces = 28;
  constexpr double left_out = 2e-4;
  const Elastic& elastic = *link.elastic;
  const double l = link.length, E = elastic.youngs_modulus, J = elastic.second_moment;
  Index H = std::max<Index>(q.num_harmonics(), 24);
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  const Index N = fourier::fast_length(4 * H);

  // N = EJ (f_4 + x f_3 - x^2/2 f_2), lib/README.md (M4).
  const MatrixXd f = E * J / elastic.area * fourier::synthesise(axial_series(rod, speed), N);
  const Eigen::VectorXd inside = Eigen::VectorXd::LinSpaced(pieces - 1, l / pieces, l - l / pieces);
  MatrixXd samples(3 + inside.size(), N);
  samples.topRows(3) << f.row(2), l * f.row(1), -0.5 * l * l * f.row(0);
  samples.bottomRows(inside.size()) =
      elastic.section_height / 2 / J * sine_components(rod_field(link, rod, speed, q, inside, N).bending_moment);

  // At joint 0 and joint 1 pull and push are largest, or nearly.
  const double axial =
      std::max(samples.row(0).cwiseAbs().maxCoeff(), samples.topRows(3).colwise().sum().cwiseAbs().maxCoeff());
  const double largest = axial + samples.bottomRows(inside.size()).cwiseAbs().maxCoeff();
  FourierSeries series = fourier::analyse(samples);
  series.c = (series.c.cwiseAbs().array() > left_out * largest).select(series.c, 0);
  Index rows = series.num_components();
  while (rows > 3 && series.c.row(rows - 1).isZero(0)) --rows;
  return block.series(FourierSeries(Eigen::MatrixXcd(series.c.topRows(rows))));
}

}  // namespace hb::tools
