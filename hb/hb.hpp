// Periodic vibration and stability of linkages with elastic links: everything that `hb` answers about a scene.
#pragma once

#include "hb/analysis/analyses.hpp"  // IWYU pragma: export
#include "hb/analysis/bench.hpp"  // IWYU pragma: export
#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"  // IWYU pragma: export
#include "hb/analysis/request.hpp"  // IWYU pragma: export
#include "hb/analysis/steady.hpp"  // IWYU pragma: export
#include "hb/analysis/tune/tune_request.hpp"  // IWYU pragma: export
#include "hb/analysis/work.hpp"  // IWYU pragma: export
#include "lib/rod/section.hpp"  // IWYU pragma: export
#include "lib/scene/scene.hpp"  // IWYU pragma: export
