// Deflection and bending moment of an elastic link: kept modes plus the quasi-static tail,
//     w = sum_{i<=I} q_i sin(i pi x/l) + sum_{i>I} p^_i / (i pi/l)^4 sin(i pi x/l),   (1 + alpha_c d/dt) p^ = p,
// p_i the sine coefficients of the load that (3.3) puts on the rod with the kept modes' deflection w_I,
//     p = -f0 - f1 x + [ (f4 + f3 x - f2 x^2/2) w_I' ]' + f2 w_I.
// The tail is the static deflection of a pinned-pinned beam under p^, in closed form, minus its first I sine terms.
// The f4 term has none beyond I. So w is a sum of products of a shape (of x) and a time function:
//     sin(i pi x/l)  q_i,     y_0  f0^,     y_1  f1^,     y_3k  (f3 q_k)^,     y_2k  (f2 q_k)^.
// With shear (lib/README.md (S8)) 1/(i pi/l)^4 becomes 1/(i pi/l)^4 + 1/(S (i pi/l)^2) in w; the bending moment is that
// of the shapes without shear with p_i, the rotation of the sections, in place of q_i.
// Here those functions and, at places along the rod, those shapes. Used inside the library.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "lib/rod/rod.hpp"
#include "lib/rod/rod_shapes.hpp"

namespace hb::rod_terms {

// Angles that transforms are fast for, N at least: a multiple of as many as Angles holds.
[[nodiscard]] Eigen::Index angles_from(Eigen::Index N);

// f_0..f_4 at one speed.
[[nodiscard]] FourierSeries coefficients_at(const RodCoefficients& rod, double speed);

// Beside the shapes of the deflection, in their order; without harmonics above the highest.
[[nodiscard]] FourierSeries time_functions(const Body& link, const RodCoefficients& rod, double speed,
                                           const FourierSeries& q,
                                           Eigen::Index highest = std::numeric_limits<Eigen::Index>::max());
// Those beside the shapes of the bending moment: the sections' rotations for q.
[[nodiscard]] FourierSeries moment_functions(const Body& link, double speed, const FourierSeries& q, FourierSeries T);

// Their values at N angles over the turn, any number (a harmonic k looks like k - N and its conjugate like N - k): a
// column for each.
[[nodiscard]] Eigen::MatrixXd over_turn(const FourierSeries& functions, Eigen::Index N);

// A derivative of every shape at every place: places x shapes.
[[nodiscard]] Eigen::MatrixXd shape_matrix(const RodShapes& shapes, const Eigen::Ref<const Eigen::VectorXd>& x,
                                           int order);

// What depends on the shapes and the places along the rod alone.
struct ShapeTable {
  double length;
  Eigen::Index num_modes;
  double flexibility;  // in shear
  Eigen::VectorXd x;
  RodShapes shapes;
  Eigen::MatrixXd deflection, curvature;  // orders 0 and 2 at x
  Eigen::RowVectorXd largest_deflection, largest_curvature;  // of each shape over x

  ShapeTable(double l, Eigen::Index I, double shear, const Eigen::Ref<const Eigen::VectorXd>& places);
};

// Kept by each thread for the rods it met last. Valid until the next call.
[[nodiscard]] const ShapeTable& shape_table(double length, Eigen::Index num_modes, double flexibility,
                                            const Eigen::Ref<const Eigen::VectorXd>& x);

// What several angles have in registers at once.
using Angles = Eigen::Array<double, 32, 1>;

// The sum of the shapes at one place times the time functions, at angles from the first.
inline Angles sum_at(const Eigen::MatrixXd& shapes, Eigen::Index place, const Eigen::MatrixXd& functions,
                     Eigen::Index first) {
  Angles sum = Angles::Zero();
  for (Eigen::Index k = 0; k < functions.cols(); ++k) sum += shapes(place, k) * Angles::Map(&functions(first, k));
  return sum;
}

}  // namespace hb::rod_terms
