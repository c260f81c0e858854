// The stiffness over the turn as its mean and few functions of the crank angle, of which linkages make all entries.
#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "lib/fourier/fourier.hpp"

namespace hb {

// K(tau) = mean K + sum_m S_m g_m(tau), hb/engine/README.md (S13), but for 4 epsilon of each entry's largest real or
// imaginary part of a harmonic above the mean.
struct Modulation {
  Eigen::MatrixXcd functions;  // harmonics 1..P of g_m, P x r
  Eigen::MatrixXd shares;  // S_m column-major, I*I x r
  Eigen::VectorXd left_out;  // bound on what that leaves out of each entry, I*I: sum over all harmonics

  // Whether there are so few functions.
  [[nodiscard]] bool found() const { return functions.cols() > 0; }
  // g_m at N angles, N x r, until the thread's next transform; N > 2 P.
  [[nodiscard]] Eigen::Map<Eigen::MatrixXd> samples(Eigen::Index N) const;
};

// Of K with num_modes^2 components. Empty where that takes more than eight functions, or half as many as a symmetric K
// has entries; where a function is not seen in the first four harmonics; where entries are small differences of large
// terms.
[[nodiscard]] Modulation modulation_of(const FourierSeries& K, Eigen::Index num_modes);

// Calls with(r) with the number of functions, known at compile time where it is small.
template <class With>
void with_functions(Eigen::Index r, const With& with) {
  if (r == 1)
    with(std::integral_constant<Eigen::Index, 1>());
  else if (r == 2)
    with(std::integral_constant<Eigen::Index, 2>());
  else if (r == 3)
    with(std::integral_constant<Eigen::Index, 3>());
  else
    with(r);
}

}  // namespace hb
