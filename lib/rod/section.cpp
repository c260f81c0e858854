#include "lib/rod/section.hpp"

#include "lib/constants.hpp"

namespace hb {

SectionValues rectangular_section(double width, double height) {
  return {width * height, width * height * height * height / 12, height};
}

SectionValues round_section(double diameter) {
  const double d2 = diameter * diameter;
  return {pi * d2 / 4, pi * d2 * d2 / 64, diameter};
}

SectionValues tubular_section(double diameter, double wall) {
  // With D = diameter, d = D - 2 wall:  F = pi (D^2 - d^2)/4,  J = pi (D^4 - d^4)/64 = F (D^2 + d^2)/16, and
  // D^2 - d^2 = 4 wall (D - wall) does not cancel.
  const double inner = diameter - 2 * wall;
  const double area = pi * wall * (diameter - wall);
  return {area, area * (diameter * diameter + inner * inner) / 16, diameter};
}

SectionValues i_section(double width, double height, double web, double flange) {
  // Web and flanges about the common axis (Steiner), a sum without cancellation.
  const double inner = height - 2 * flange, arm = (height - flange) / 2;
  const double flanges = 2 * width * flange;
  return {web * inner + flanges, web * inner * inner * inner / 12 + flanges * (flange * flange / 12 + arm * arm),
          height};
}

SectionValues box_section(double width, double height, double wall) { return i_section(width, height, 2 * wall, wall); }

}  // namespace hb
