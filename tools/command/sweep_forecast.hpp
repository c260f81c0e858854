// What a sweep will take, said on standard error before it begins.
#pragma once

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sweep/sweep_scene.hpp"
#include "tools/command/output_flags.hpp"

namespace hb::tools {

// Time where points are long, memory where more is needed than is left.
void say_forecast_of(const SweepScene& swept, const Output& out);

// Branches of the motion without linearisation; where the one from the first value takes above ten seconds, that is
// said while it is followed.
[[nodiscard]] NonlinearSweep announced_branches(const SweepScene& swept, NonlinearSweepOptions options);

}  // namespace hb::tools
