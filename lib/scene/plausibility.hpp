// Numbers that are possible but hardly meant: a wrong unit, a slip of a power of ten. Each is told with the likely
// slip.
#pragma once

#include "lib/scene/scene_parts.hpp"

namespace hb {

// Young's modulus outside 1 GPa to 1.5 TPa, a strength outside 1 MPa to 10 GPa or without a section, a density no solid
// has, J/area^2 outside 1/240 to 4, a section as large as the rod is long, shear left out that matters, a shear modulus
// or coefficient no section has, damping near the critical one.
void remark_on_elastic(const TableView& link, const TableView& elastic, const Body& body, const SceneContext& context);

// A cylinder's bore outside 1 mm to 2 m.
void remark_on_bore(const TableView& pressure, double bore, const SceneContext& context);

// Gravity a thousand times off or upward, a body a hundred times as heavy as all others, links of less than half a
// millimetre or more than 50 m.
void remark_on_linkage(const TableView& scene, const Linkage& linkage, const SceneContext& context);

// A crank whose tip is faster than 300 m/s.
void remark_on_speed(const TableView& analysis, const AnalysisDefaults& defaults, const Linkage& linkage,
                     const SceneContext& context);

}  // namespace hb
