// Shear of a thick elastic link, linear: Timoshenko's rod, lib/README.md (S1) to (S8). Term i of the Ritz series has
// two unknowns, the deflections a_i and b_i of its two modes at rest (bending with some shear, and shear with some
// bending):
//     w = sum (a_i + b_i) sin(i pi x/l),     rotation of the section = sum p_i k_i cos(i pi x/l),   k_i = i pi/l.
// Unknowns stand as a_1..a_I, b_1..b_I; what is asked for outside is q_i = a_i + b_i. Without shear there are q_1..q_I.
#pragma once

#include "lib/hill_system.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb {

// I, or 2 I with shear; I also with a shear modulus so large (S7) that the second modes only follow: b = 0.
[[nodiscard]] Eigen::Index num_unknowns(const Body& link, Eigen::Index num_modes);

// EJ/(k G F), a length squared: 0 without shear.
[[nodiscard]] double shear_flexibility(const Body& link);

// The modes at rest of I terms, per EJ and times 2/l as (M5): with w of size 1 the generalised masses and stiffnesses,
// and p_i of each; [0] bending, [1] shear. Precondition: link.elastic->shear.
struct RestModes {
  std::array<Eigen::ArrayXd, 2> mass, stiffness, rotation;
};
[[nodiscard]] RestModes rest_modes(const Body& link, Eigen::Index num_modes);

// q_1..q_I of a series of the unknowns, which has I or 2 I components.
[[nodiscard]] FourierSeries ritz_coordinates(const FourierSeries& unknowns, Eigen::Index num_modes);

// Of a load (or of a functional) on q_1..q_I: that on the unknowns.
[[nodiscard]] FourierSeries on_unknowns(const FourierSeries& load, Eigen::Index num_unknowns);

// p_1..p_I that belong to a periodic q at this speed: q itself without shear.
[[nodiscard]] FourierSeries rotation_coordinates(const Body& link, double speed, const FourierSeries& q);

// The factors p_i/q_i of harmonic n at this speed. Precondition: link.elastic->shear.
[[nodiscard]] Eigen::ArrayXcd rotation_ratios(const Body& link, double speed, Eigen::Index num_modes, Eigen::Index n);

// The same rod rigid in shear, from ritz_system of the rod with shear.
[[nodiscard]] HillSystem rigid_in_shear(const Body& link, const HillSystem& system, Eigen::Index num_modes);

}  // namespace hb
