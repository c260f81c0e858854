// The slider-crank of the IVP test set (m, kg, s), in line, no gravity: B. Simeon, Mathematical Modelling of Systems 2
// (1996) 1-18. Without the rotary inertia of the rod's section, as there.
#pragma once

#include <cmath>

#include "tests/support/six_link.hpp"

namespace hb::slider_crank {

inline Linkage linkage() {
  Linkage linkage;
  linkage.gravity = 0;
  linkage.crank.body = six_link::rigid_body("crank", 0.15, 0, 0, 0);
  Dyad dyad;
  dyad.on = {0, 0.15, "crank"};
  const Elastic elastic{.youngs_modulus = 2e11,
                        .area = 64e-6,
                        .second_moment = std::pow(0.008, 4) / 12,
                        .density = 1e-6,
                        .internal_damping = 4.0602759e-5};
  dyad.coupler = six_link::elastic_body("rod", 0.30, 0.151104, elastic);
  Slider slider;
  slider.name = "slider";
  slider.mass = 0.075552;
  dyad.closing = slider;
  linkage.dyads = {dyad};
  return linkage;
}

}  // namespace hb::slider_crank
