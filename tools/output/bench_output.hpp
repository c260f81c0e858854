// Error against run time as a table, JSON and CSV.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/bench.hpp"

namespace hb::tools {

[[nodiscard]] std::string bench_text(const Bench& bench);
[[nodiscard]] nlohmann::ordered_json bench_json(const Bench& bench);
// A row for each case: those of one rod and method stand together.
[[nodiscard]] std::string bench_csv(const Bench& bench);

}  // namespace hb::tools
