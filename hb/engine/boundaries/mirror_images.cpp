#include "hb/engine/boundaries/mirror_images.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hb {

namespace {

// sum_j s_j = -tr G may be zero. Most systems are damped: then none is computed to be told so.
bool may_add_up_to_zero(const StabilitySample& sample) {
  double sum = 0, error = 0;
  for (const std::vector<Exponent>* list : {&sample.stability.exponents, &sample.stability.uncertain})
    for (const Exponent& e : *list) {
      sum += e.value.real();
      error += e.error;
    }
  return std::abs(sum) <= error;
}

}  // namespace

bool lacks_an_image(const StabilitySample& sample) {
  std::vector<const Exponent*> all;
  for (const std::vector<Exponent>* list : {&sample.stability.exponents, &sample.stability.uncertain})
    for (const Exponent& e : *list) all.push_back(&e);
  if (all.empty() || all.size() != sample.mean.size()) return false;
  return std::ranges::any_of(all, [&](const Exponent* s) {
    return std::ranges::all_of(all, [&](const Exponent* t) {
      const double turn = std::remainder(s->value.imag() - t->value.imag(), sample.speed);
      return std::hypot(s->value.real() + t->value.real(), turn) > s->error + t->error;
    });
  });
}

bool excludes_gaps(const SystemAt& at, const StabilitySample& p, const StabilitySample& q) {
  for (const StabilitySample* sample : {&p, &q})
    if (!may_add_up_to_zero(*sample) || !lacks_an_image(*sample)) return false;
  return std::ranges::all_of(std::vector{p.x, 0.5 * (p.x + q.x), q.x}, [&](double x) {
    const std::optional<ScaledSystem> system = at(x);
    return system && system->G.trace() == 0 && system->G_error.trace() == 0;
  });
}

}  // namespace hb
