// How far two responses of one rod with different numbers of modes are apart.
#pragma once

#include "lib/rod/rod.hpp"

namespace hb {

// max |w - finer w| / max |finer w| and of EJ w'' likewise, over rod and turn, tail included: at four places per
// half-wave of the finest mode and as many angles at least per period of the highest harmonic that both and what is
// between them are made of but for 0.003 of the accelerations. 0 where `finer` is; NaN where one is not finite.
struct FieldChange {
  double deflection = 0, bending_moment = 0;
};
[[nodiscard]] FieldChange field_change(const Body& link, const RodCoefficients& rod, double speed,
                                       const FourierSeries& q, const FourierSeries& finer);

}  // namespace hb
