#include "hb/engine/exponents/shifted_resonances.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hb {

namespace {

using Eigen::Index;
using cplx = std::complex<double>;

// min_k |s - t - ik|: an exponent is known modulo i.
double detuning(cplx s, cplx t) { return std::hypot(s.real() - t.real(), std::remainder(s.imag() - t.imag(), 1)); }

// ln x of  x prod_j max(d_j, x) = p,  all by logarithms.
double log_moved(double log_p, std::vector<double> log_d) {
  std::ranges::sort(log_d);
  // The first so many are below x.
  for (std::size_t below = 0;; ++below) {
    double rest = log_p;
    for (std::size_t j = below; j < log_d.size(); ++j) rest -= log_d[j];
    const double log_x = rest / double(below + 1);
    if (below == log_d.size() || log_x <= log_d[below]) return log_x;
  }
}

}  // namespace

ShiftedResonances::ShiftedResonances(const Eigen::VectorXd& w2, const Eigen::VectorXd& b) {
  for (Index i = 0; i < w2.size(); ++i) {
    const cplx root = std::sqrt(cplx(b(i) * b(i) / 4 - w2(i), 0));
    means_.push_back({-b(i) / 2 + root, -b(i) / 2 - root});
  }
}

void ShiftedResonances::widen(const Slaved& slaved, std::span<const Exponents* const> others, Exponents& found) const {
  const auto is_kept = [&](Index mode) { return std::ranges::find(found.mode, mode) != found.mode.end(); };
  struct Detunings {
    double of_means = HUGE_VAL, of_exponents = HUGE_VAL;
  };
  std::vector<Detunings> by_mode(means_.size());
  std::vector<double> log_nearer;
  for (std::size_t i = 0; i < found.s.size(); ++i) {
    const double told = slaved.iteration_share * found.error[i];
    if (!(told > 0 && std::isfinite(told))) continue;
    std::ranges::fill(by_mode, Detunings());
    for (const Exponents* list : others)
      for (std::size_t k = 0; k < list->s.size(); ++k) {
        if (list == &found || is_kept(list->mode[k])) continue;
        Detunings& mode = by_mode[std::size_t(list->mode[k])];
        for (const cplx s : means_[std::size_t(found.mode[i])])
          for (const cplx t : means_[std::size_t(list->mode[k])])
            mode.of_means = std::min(mode.of_means, detuning(s, t));
        for (const cplx t : {list->s[k], std::conj(list->s[k])})
          mode.of_exponents = std::min(mode.of_exponents, detuning(found.s[i], t));
      }
    double log_p = std::log(told / slaved.amplification);
    log_nearer.clear();
    for (const Detunings& mode : by_mode)
      if (mode.of_exponents < mode.of_means) {
        log_p += std::log(mode.of_means);
        log_nearer.push_back(std::log(mode.of_exponents));
      }
    const double largest = std::max(told, std::exp(log_moved(log_p, log_nearer)));
    found.error[i] += largest - told;
    found.imaginary_error[i] += largest - told;
  }
}

}  // namespace hb
