// The page of a design that was searched for: the design after along its speeds, beside the design before.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {

// `document` as tune_json has it; `before`: the scene that the search began from.
[[nodiscard]] std::string design_page(const TuneTask& task, const TuneResult& result, const Scene& before,
                                      const nlohmann::ordered_json& document, Work& work, PageText text);

}  // namespace hb::tools
