// How the sliders of a linkage move along their guides.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/linkage/linkage.hpp"

namespace hb {

struct SliderMotion {
  std::string name;
  FourierSeries position;  // over the crank angle: from the guide's point along its direction
  double speed = 0;  // rad per unit time, of the angle: the crank's; over T turns 1/T of it
  std::array<double, 3> errors = {};  // estimates, of position, velocity and acceleration at any angle

  [[nodiscard]] FourierSeries velocity() const;  // per unit time
  [[nodiscard]] FourierSeries acceleration() const;
};

// Of the rigid mechanism, as the theory moves it.
[[nodiscard]] std::vector<SliderMotion> slider_motions(const Linkage& linkage, double speed);

}  // namespace hb
