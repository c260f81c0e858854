#include "hb/engine/boundaries/leading_pair.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hb/engine/boundaries/strands.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using cplx = std::complex<double>;

struct Known {
  cplx s;  // folded
  double error = 0;
};

// Real part descending; empty if one of them has no error.
std::vector<Known> all_of(const StabilitySample& sample) {
  std::vector<Known> all;
  all.reserve(sample.stability.exponents.size() + sample.stability.uncertain.size());
  for (const std::vector<Exponent>* list : {&sample.stability.exponents, &sample.stability.uncertain})
    for (const Exponent& e : *list) {
      if (!std::isfinite(e.error)) return {};
      all.push_back({folded(e.value / sample.speed), e.error / sample.speed});
    }
  const auto faster = [](const Known& a, const Known& b) { return a.s.real() > b.s.real(); };
  if (!std::ranges::is_sorted(all, faster)) std::ranges::stable_sort(all, faster);
  return all;
}

// 1, -1: a real multiplier of that sign; 0: a complex one.
double sign_of(const Known& k) {
  constexpr double slack = 1e-12;
  const double turn = std::abs(k.s.imag());
  return turn <= slack ? 1 : turn >= 0.5 - slack ? -1 : 0;
}

}  // namespace

double lock_of(const StabilitySample& sample) {
  const std::vector<Known> all = all_of(sample);
  return all.empty() ? 0 : sign_of(all.front());
}

std::optional<LeadingPair> leading_alone(const StabilitySample& sample) {
  const std::vector<Known> all = all_of(sample);
  if (all.empty() || sign_of(all.front()) == 0) return std::nullopt;
  LeadingPair alone;
  alone.mean = alone.lower = all.front().s.real();
  alone.mean_error = all.front().error;
  alone.half_trace = sign_of(all.front());
  alone.others = sample.stability.others_below / sample.speed;
  for (std::size_t k = 1; k < all.size(); ++k) alone.others = std::max(alone.others, all[k].s.real() + all[k].error);
  return alone;
}

std::optional<LeadingPair> leading_pair(const StabilitySample& sample) {
  const std::vector<Known> all = all_of(sample);
  if (all.size() < 2) return std::nullopt;
  const Known& first = all.front();
  const double sign = sign_of(first);
  const auto fits = [&](const Known& k) {
    return sign != 0 ? sign_of(k) == sign : std::abs(folded(k.s - std::conj(first.s))) <= first.error + k.error;
  };
  std::size_t partner = 1;
  while (partner < all.size() && !fits(all[partner])) ++partner;
  if (partner == all.size()) return std::nullopt;
  const Known& second = all[partner];
  LeadingPair pair;
  pair.others = sample.stability.others_below / sample.speed;
  for (std::size_t k = 1; k < all.size(); ++k)
    if (k != partner) pair.others = std::max(pair.others, all[k].s.real() + all[k].error);
  pair.mean = 0.5 * (first.s.real() + second.s.real());
  pair.mean_error = 0.5 * (first.error + second.error);
  pair.lower = second.s.real();
  // z = pi (s_1 - s_2), |dz| <= d
  const double d = pi * (first.error + second.error);
  const double real = sign != 0 ? pi * (first.s.real() - second.s.real()) : 0;
  const double angle = sign != 0 ? 0 : 2 * pi * first.s.imag();
  pair.half_trace = sign != 0 ? sign * std::cosh(real) : std::cos(angle);
  const double slope = sign != 0 ? std::sinh(real) : std::abs(std::sin(angle));
  pair.half_trace_error = slope * std::sinh(d) + std::abs(pair.half_trace) * (std::cosh(d) - 1);
  if (!std::isfinite(pair.half_trace) || !std::isfinite(pair.half_trace_error)) return std::nullopt;
  return pair;
}

}  // namespace hb
