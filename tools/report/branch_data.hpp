// Branches of the motion without linearisation for a page: columns along the arc, and what lies on them with its place
// in the charts.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "tools/report/byte_block.hpp"

namespace hb::tools {

// `sweep` as add_branches makes it, of `branches`; what is taken over is moved out of it.
[[nodiscard]] nlohmann::ordered_json branch_data(nlohmann::ordered_json& sweep, const NonlinearSweep& branches,
                                                 ByteBlock& block);

}  // namespace hb::tools
