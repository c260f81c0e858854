#include "hb/engine/exponents/imaginary_axis.hpp"

#include <cmath>

namespace hb {

bool images_apart(std::span<const std::complex<double>> s, std::span<const double> error, double period) {
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < s.size(); ++j) {
      if (i == j) continue;
      const double turn = std::remainder(s[i].imag() - s[j].imag(), period);
      const double sum = error[i] + error[j];
      // Nor may two be one exponent found twice, whose image is not among them.
      if (!(std::hypot(s[i].real() + s[j].real(), turn) > sum && std::hypot(s[i].real() - s[j].real(), turn) > sum))
        return false;
    }
  return true;
}

void put_on_axis(Stability& stability) {
  for (auto* list : {&stability.exponents, &stability.uncertain})
    for (Exponent& e : *list) e.value.real(0);
  stability.growth_rate = stability.growth_low = stability.growth_high = stability.growth_error = 0;
  stability.verdict = Verdict::bounded;
  stability.converged = true;
  stability.evidence += "; without damping, all exponents simple: on the imaginary axis";
}

}  // namespace hb
