// Stress of an elastic link over its length and the turn, short enough for a page that holds hundreds of speeds.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/report/byte_block.hpp"

namespace hb::tools {

// sigma(x, tau) = a_0 + a_1 s + a_2 s^2 +- sum_i b_i sin(i pi s), s = x/l: the stress N/F of the axial force, and of
// the bending moment at the right fibre (+) and the left one. A series whose components are a_0, a_1, a_2, b_1, b_2,
// ...; coefficients below 2e-4 of the largest stress are left out. Needs elastic.section_height.
[[nodiscard]] nlohmann::ordered_json stress_field(const Body& link, const RodCoefficients& rod, double speed,
                                                  const FourierSeries& q, ByteBlock& block);

}  // namespace hb::tools
