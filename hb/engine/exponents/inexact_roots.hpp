// Roots of a polynomial that is known up to a change of given size.
#pragma once

#include <Eigen/Core>

namespace hb {

struct InexactRoots {
  Eigen::VectorXcd value;
  // Every polynomial within the change has just as many roots inside the circle of this radius about `value` as this
  // one. Infinite if no such radius below half of the modulus was found: those are known to lie within `rest` of zero.
  Eigen::VectorXd radius;
  double rest = 0;  // infinite if no such circle was found
};

// Of sum_r a_r z^r, r = 0..n, real with a_n not zero; the change is at most `change` at every point of the unit circle,
// and so max(1, |z|)^n times that anywhere. By Rouche's theorem, with the distances of the computed roots as bounds
// from below on the polynomial; hb/engine/README.md (E21).
[[nodiscard]] InexactRoots inexact_roots(const Eigen::VectorXd& a, double change);

}  // namespace hb
