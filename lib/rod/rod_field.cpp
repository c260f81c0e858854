// Deflection and bending moment at places along the rod over the turn: sums of the terms of lib/rod/rod_terms.hpp.
#include <algorithm>
#include <limits>
#include <utility>

#include "lib/constants.hpp"
#include "lib/rod/field_change.hpp"
#include "lib/rod/rod.hpp"
#include "lib/rod/rod_terms.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

using rod_terms::Angles;
using rod_terms::over_turn;
using rod_terms::shape_table;

namespace {

// Time functions, without harmonics above the highest, at N angles.
class FunctionsOverTurn {
 public:
  FunctionsOverTurn(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q, Eigen::Index N,
                    Eigen::Index highest = std::numeric_limits<Eigen::Index>::max()) {
    FourierSeries T = rod_terms::time_functions(link, rod, speed, q, highest);
    beside_deflection_ = over_turn(T, N);
    if (link.elastic->shear)
      beside_curvature_ = over_turn(rod_terms::moment_functions(link, speed, q, std::move(T)), N);
  }

  const Eigen::MatrixXd& beside_deflection() const { return beside_deflection_; }
  const Eigen::MatrixXd& beside_curvature() const {
    return beside_curvature_.size() > 0 ? beside_curvature_ : beside_deflection_;
  }

 private:
  Eigen::MatrixXd beside_deflection_, beside_curvature_;  // the second where it is another than the first
};

// The fewest harmonics without which less than 0.003 of the accelerations is missing: what modes left out change
// is inertia.
Eigen::Index telling_harmonics(const FourierSeries& q) {
  constexpr double share = 0.003;
  const Eigen::Index H = q.num_harmonics();
  Eigen::VectorXd size(H + 1);
  for (Eigen::Index n = 0; n <= H; ++n)
    size(n) = static_cast<double>(n * n) * (q.c.col(n).real().cwiseAbs() + q.c.col(n).imag().cwiseAbs()).sum();
  const double small = share * size.sum();
  double left = 0;
  Eigen::Index n = H;
  while (n > 0 && (left += size(n)) <= small) --n;
  return n;
}

// The largest |A B - C D| relative to the largest |C D|, shapes at places times functions at angles.
double largest_change(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C,
                      const Eigen::MatrixXd& D) {
  double largest = 0, change = 0;
  for (Eigen::Index first = 0; first < B.rows(); first += Angles::SizeAtCompileTime)
    for (Eigen::Index place = 0; place < A.rows(); ++place) {
      const Angles fine = rod_terms::sum_at(C, place, D, first);
      largest = std::max(largest, fine.abs().maxCoeff());
      change = std::max(change, (rod_terms::sum_at(A, place, B, first) - fine).abs().maxCoeff());
    }
  return largest > 0 ? change / largest : 0;
}

}  // namespace

RodField rod_field(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                   const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Index num_samples) {
  const Eigen::Index I = q.num_components();
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  const FunctionsOverTurn time(link, rod, speed, q, num_samples);
  RodField field;
  field.w = shape_table(link.length, I, shear_flexibility(link), x).deflection * time.beside_deflection().transpose();
  field.bending_moment = shape_table(link.length, I, 0, x).curvature * (EJ * time.beside_curvature()).transpose();
  return field;
}

FieldChange field_change(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                         const FourierSeries& finer) {
  if (!q.c.allFinite() || !finer.c.allFinite()) return {nan, nan};
  const Eigen::Index I = q.num_components(), J = finer.num_components(), parts = std::max<Eigen::Index>(32, 4 * J);
  FourierSeries change = fourier::resized(finer, std::max(q.num_harmonics(), finer.num_harmonics()));
  change.c.topLeftCorner(I, q.c.cols()) -= q.c;
  const Eigen::Index H = std::max({telling_harmonics(q), telling_harmonics(finer), telling_harmonics(change)});
  const Eigen::Index N = rod_terms::angles_from(4 * H);
  const double l = link.length, step = l / static_cast<double>(parts);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(parts - 1, step, l - step);  // both are zero at the joints
  const FunctionsOverTurn some(link, rod, speed, q, N, H);
  end_if_wished();
  const FunctionsOverTurn all(link, rod, speed, finer, N, H);
  end_if_wished();
  const double shear = shear_flexibility(link);
  const auto deflection = [&](Eigen::Index modes) -> Eigen::MatrixXd {
    return shape_table(l, modes, shear, x).deflection;
  };
  const auto curvature = [&](Eigen::Index modes) -> Eigen::MatrixXd { return shape_table(l, modes, 0, x).curvature; };
  return {largest_change(deflection(I), some.beside_deflection(), deflection(J), all.beside_deflection()),
          largest_change(curvature(I), some.beside_curvature(), curvature(J), all.beside_curvature())};
}

MomentAlong bending_moment_along(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                                 Eigen::Index num_samples) {
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  return
      [shapes = RodShapes(link.length, q.num_components()),
       time = Eigen::MatrixXd(EJ * FunctionsOverTurn(link, rod, speed, q, num_samples).beside_curvature().transpose())](
          const Eigen::Ref<const Eigen::VectorXd>& x) -> Eigen::MatrixXd {
        return rod_terms::shape_matrix(shapes, x, 2) * time;
      };
}

}  // namespace hb
