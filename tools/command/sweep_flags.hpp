// Flags of hb sweep, and what they ask for.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sensitivity_band.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/theory_flags.hpp"

namespace hb::tools {

struct SweepFlags : CommonFlags {
  std::string x;
  TheoryFlags theory;
  std::vector<std::string> start, bands;
  std::string measured;
  bool no_search = false, resume = false, restart = false;
};

void add_sweep_flags(CLI::App& command, SweepFlags& flags);
// Of --band; with the linear theory.
[[nodiscard]] std::vector<BandRequest> bands_of(const std::vector<std::string>& texts, const TheoryFlags& theory);
// Empty with the linear theory.
[[nodiscard]] std::optional<NonlinearSweepOptions> branches_of(const SweepFlags& flags);

}  // namespace hb::tools
