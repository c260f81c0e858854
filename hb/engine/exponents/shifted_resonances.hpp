// Modes meet at the exponents that they have with what modulates them, not at those of their means, by which slaving
// judges its errors: what that adds to the errors of exponents; hb/engine/README.md (E28).
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "hb/engine/exponents/reduced_exponents.hpp"

namespace hb {

// Of a reduction to some modes.
struct Slaved {
  // Of the errors, what is left of the iteration; by how much repeated corrections showed that to grow.
  double iteration_share = 0, amplification = 1;
};

class ShiftedResonances {
 public:
  // Of all modes the squared frequency and the damping of their means.
  ShiftedResonances(const Eigen::VectorXd& w2, const Eigen::VectorXd& b);

  // What is left of the iteration in the errors of `found`, exponents of the modes that were kept, counts for more
  // where those of the others, of any modes and `found` itself among them, lie nearer than those of the means.
  void widen(const Slaved& slaved, std::span<const Exponents* const> others, Exponents& found) const;

 private:
  using Roots = std::array<std::complex<double>, 2>;
  std::vector<Roots> means_;
};

}  // namespace hb
