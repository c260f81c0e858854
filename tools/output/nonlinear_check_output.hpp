// The nonlinear cross-check as JSON and text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_check.hpp"

namespace hb::tools {

// One speed: a document as of the linear check, with "system" for what belongs to all rods together. Several: arrays.
[[nodiscard]] nlohmann::ordered_json nonlinear_check_json(const SceneModel& model,
                                                          const std::vector<NonlinearCheck>& checks,
                                                          const Settings& settings);
[[nodiscard]] std::string nonlinear_check_report(const SceneModel& model, const std::vector<NonlinearCheck>& checks,
                                                 const Settings& settings);

}  // namespace hb::tools
