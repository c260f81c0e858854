// The exact model of a linkage as a system that the nonlinear solvers work on; the parameter is the speed.
#pragma once

#include <memory>

#include "hb/engine/nonlinear/nonlinear_system.hpp"
#include "lib/exact/exact_model.hpp"

namespace hb {

// Unknowns: Ritz coordinates of all rods, as RitzSamples. Each call gives a system with scratch of its own. Throws
// RequestError where a rod has shear, which the exact model leaves out.
[[nodiscard]] NonlinearSystem exact_system(std::shared_ptr<const ExactModel> model);

}  // namespace hb
