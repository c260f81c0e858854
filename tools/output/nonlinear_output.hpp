// A motion without linearisation as JSON and as a table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "tools/output/machine_output.hpp"

namespace hb::tools {

[[nodiscard]] nlohmann::ordered_json nonlinear_json(const SceneModel& model, const NonlinearResult& result,
                                                    const Settings& settings, bool stats);
[[nodiscard]] std::string nonlinear_table(const SceneModel& model, const NonlinearResult& result);

// The motion of one turn in the form of a linear answer, for the tables and pictures of a turn.
[[nodiscard]] SpeedResult as_speed_result(const NonlinearResult& result);
[[nodiscard]] MachineFiles machine_files(const NonlinearResult& result);

}  // namespace hb::tools
