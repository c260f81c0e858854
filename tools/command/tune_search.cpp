#include "tools/command/tune_search.hpp"

#include <fmt/core.h>

#include <limits>

#include "hb/analysis/tune/tune_request.hpp"
#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"

namespace hb::tools {

DesignOptions design_options(const TuneFlags& flags) {
  DesignOptions options;
  options.max_evaluations = usual_analyses(flags.vary.size());
  if (!flags.analyses.empty())
    options.max_evaluations = integer_flag("--analyses", flags.analyses, 2, 1000000, "an integer 2 to 1000000");
  if (!flags.seed.empty())
    options.seed = static_cast<std::uint64_t>(
        integer_flag("--seed", flags.seed, 0, std::numeric_limits<int>::max(), "an integer >= 0"));
  if (!flags.algorithm.empty()) {
    std::string names;
    bool known = false;
    for (const DesignAlgorithm algorithm :
         {DesignAlgorithm::automatic, DesignAlgorithm::direct, DesignAlgorithm::mlsl, DesignAlgorithm::cobyla,
          DesignAlgorithm::bobyqa, DesignAlgorithm::slsqp, DesignAlgorithm::mma}) {
      names += (names.empty() ? "" : ", ") + std::string(to_string(algorithm));
      if (flags.algorithm != to_string(algorithm)) continue;
      options.algorithm = algorithm;
      known = true;
    }
    if (!known) throw UsageError(fmt::format("--algorithm: found \"{}\", allowed: {}", flags.algorithm, names));
  }
  return options;
}

void require_algorithm(const TuneTask& task) {
  if (task.options.algorithm != DesignAlgorithm::bobyqa) return;
  constexpr const char* allowed = "allowed: automatic, direct, mlsl, cobyla, slsqp, mma";
  if (!task.keeps.empty())
    throw UsageError(fmt::format("--algorithm: found bobyqa, which takes no conditions, with --keep; {}", allowed));
  if (task.variables.size() < 2)
    throw UsageError(fmt::format("--algorithm: found bobyqa, which needs two variables, with one --vary; {}", allowed));
}

}  // namespace hb::tools
