// Area and second moment of common cross-sections, bent in the plane of the linkage.
#pragma once

namespace hb {

struct SectionValues {
  double area = 0;  // F
  double second_moment = 0;  // J, about the axis across the plane of motion
  double height = 0;  // in the plane of motion
};

// `height` lies in the plane of motion.
[[nodiscard]] SectionValues rectangular_section(double width, double height);
[[nodiscard]] SectionValues round_section(double diameter);
// Outer diameter, wall <= diameter/2.
[[nodiscard]] SectionValues tubular_section(double diameter, double wall);
// Two flanges of `width` x `flange` and a web of thickness `web` between them, `height` over all, in the plane of
// motion: bent about its strong axis. web <= width, flange <= height/2.
[[nodiscard]] SectionValues i_section(double width, double height, double web, double flange);
// Rectangular tube, outer sizes; wall <= half of the smaller.
[[nodiscard]] SectionValues box_section(double width, double height, double wall);

}  // namespace hb
