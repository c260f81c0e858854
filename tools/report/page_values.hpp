// What several parts of the page's data are written with.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb::tools {

// One letter for a verdict: the first of its name, ? for undecided, - for no answer.
[[nodiscard]] char letter(const nlohmann::ordered_json& verdict);
[[nodiscard]] std::string letters(const nlohmann::ordered_json& verdicts);
// An array of numbers; NaN where there is none.
[[nodiscard]] std::vector<double> numbers(const nlohmann::ordered_json& array);
// Kind (rpm, omega, parameter), path, label, unit and symbol of a scene's number or of the speed.
[[nodiscard]] nlohmann::ordered_json axis_json(const std::string& path, const Units& units);

}  // namespace hb::tools
