#include "hb/engine/exponents/exponent_summary.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

double folded(double s) {
  double f = s - std::floor(s + 0.5);  // [-1/2, 1/2)
  return f <= -0.5 ? f + 1 : f;
}

void sort(std::vector<Exponent>& exponents) {
  const auto before = [](const Exponent& a, const Exponent& b) {
    if (a.value.real() != b.value.real()) return a.value.real() > b.value.real();
    return a.value.imag() < b.value.imag();
  };
  if (!std::ranges::is_sorted(exponents, before)) std::ranges::stable_sort(exponents, before);
}

void set_growth(Stability& result, double growth, double low, double high) {
  result.growth_rate = growth;
  result.growth_low = low;
  result.growth_high = high;
  const double error = std::max(high - growth, growth - low);
  result.growth_error = std::isfinite(growth) && error < HUGE_VAL ? error : HUGE_VAL;
  result.verdict = verdict_of(low, high);
}

Stability summary(const ExponentSearch& search, double Omega, double tolerance) {
  const Exponents& found = search.exponents;
  Stability result;
  result.method = search.method;
  result.evidence = search.evidence;
  result.kept.assign(search.kept.begin(), search.kept.end());
  double high = found.others_below, low = -HUGE_VAL, growth = -HUGE_VAL;
  for (std::size_t i = 0; i < found.s.size(); ++i) {
    const std::complex<double> s = found.s[i];
    const double error = found.error[i];
    growth = std::max(growth, s.real());
    high = std::max(high, s.real() + error);
    low = std::max(low, s.real() - error);
    (error <= 1e-6 * std::max(std::abs(s), 1.0) ? result.exponents : result.uncertain)
        .push_back({{Omega * s.real(), Omega * folded(s.imag())},
                    Omega * error,
                    int(found.mode[i]),
                    Omega * found.frequency[i]});
  }
  sort(result.exponents);
  sort(result.uncertain);
  const bool known = search.complete && std::isfinite(growth);
  set_growth(result, Omega * growth, known ? Omega * low : -HUGE_VAL, known ? Omega * high : HUGE_VAL);
  if (known) result.others_below = Omega * found.others_below;
  const double bar = result.growth_error / Omega;
  result.converged = std::isfinite(bar) && bar <= std::max(tolerance, 1e-13) * std::max(std::abs(growth), 1.0);
  return result;
}

}  // namespace hb
