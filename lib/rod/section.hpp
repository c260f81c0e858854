// Area and second moment of common cross-sections, bent in the plane of the linkage.
#pragma once

namespace hb {

struct SectionValues {
  double area = 0;  // F
  double second_moment = 0;  // J, about the axis across the plane of motion
};

// `height` lies in the plane of motion.
[[nodiscard]] SectionValues rectangular_section(double width, double height);
[[nodiscard]] SectionValues round_section(double diameter);
// Outer diameter, wall <= diameter/2.
[[nodiscard]] SectionValues tubular_section(double diameter, double wall);

}  // namespace hb
