// What a rod carries, in a document and in words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hb/analysis/rod_stress.hpp"
#include "tools/output/output_units.hpp"

namespace hb::tools {

void add_stress(nlohmann::ordered_json& rod, const RodStress& stress);
// Two lines of a table.
[[nodiscard]] std::string stress_lines(const RodStress& stress, const Body& link, const OutputUnits& units);

}  // namespace hb::tools
