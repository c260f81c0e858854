#include "hb/engine/exponents/shifted_resonances.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using Eigen::Index;
using cplx = std::complex<double>;

// min |s - t - ik| over |k| <= most, squared.
double detuning2(cplx s, cplx t, double most) {
  const double turned = s.imag() - t.imag(), k = std::clamp(std::round(turned), -most, most);
  return std::pow(s.real() - t.real(), 2) + std::pow(turned - k, 2);
}

// With the whole frequency: an exponent is known modulo i.
std::array<cplx, 2> conjugates(const Exponents& list, std::size_t i) {
  return {cplx(list.s[i].real(), list.frequency[i]), cplx(list.s[i].real(), -list.frequency[i])};
}

}  // namespace

Slaved::Slaved(const ReducedSystem& reduced, Index num_pairs)
    : iteration_share(reduced.iteration_share),
      amplification(reduced.solved.amplification),
      harmonics(reduced.solved.solution.size() / (4 * num_pairs) - 1) {}

ShiftedResonances::ShiftedResonances(const Eigen::VectorXd& w2, const Eigen::VectorXd& b) {
  for (Index i = 0; i < w2.size(); ++i) {
    const cplx root = std::sqrt(cplx(b(i) * b(i) / 4 - w2(i), 0));
    means_.push_back({-b(i) / 2 + root, -b(i) / 2 - root});
  }
}

void ShiftedResonances::widen(const Slaved& slaved, std::span<const Exponents* const> others, Exponents& found) const {
  const auto is_kept = [&](Index mode) { return std::ranges::find(found.mode, mode) != found.mode.end(); };
  for (std::size_t i = 0; i < found.s.size(); ++i) {
    const double told = slaved.iteration_share * found.error[i];
    double largest = told;
    for (const Exponents* list : others)
      for (std::size_t k = 0; k < list->s.size(); ++k) {
        if (list == &found || is_kept(list->mode[k])) continue;
        double of_means2 = HUGE_VAL, of_exponents2 = HUGE_VAL;
        for (const cplx s : means_[std::size_t(found.mode[i])])
          for (const cplx t : means_[std::size_t(list->mode[k])])
            of_means2 = std::min(of_means2, detuning2(s, t, double(slaved.harmonics)));
        for (const cplx s : conjugates(found, i))
          for (const cplx t : conjugates(*list, k))
            of_exponents2 = std::min(of_exponents2, detuning2(s, t, double(slaved.harmonics)));
        const double p = told / slaved.amplification * std::sqrt(of_means2);
        largest = std::max(largest, std::min(p / std::sqrt(of_exponents2), std::sqrt(p)));
      }
    found.error[i] += largest - told;
    found.imaginary_error[i] += largest - told;
  }
}

}  // namespace hb
