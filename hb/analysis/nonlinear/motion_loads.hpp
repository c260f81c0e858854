// What a machine's designer reads beside joint forces, of a motion without linearisation.
#pragma once

#include <optional>

#include "hb/analysis/machine_loads.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"

namespace hb {

// Crank angles over the motion's turns. Empty where joint forces were not computed.
[[nodiscard]] std::optional<MachineLoads> machine_loads(const Linkage& linkage, const NonlinearResult& result,
                                                        LoadDetail detail = LoadDetail::all);

}  // namespace hb
