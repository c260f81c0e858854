// Results of long work as Python holds them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/output/map_output.hpp"

namespace hb::python {

// The linear theory, and where it was asked for the motion without linearisation beside it.
struct SweepCore {
  Sweep linear;
  std::optional<NonlinearSweep> branches;
};

[[nodiscard]] inline tools::MapDocument document_of(const Map& map) {
  return {map, map.scene, map.num_modes, map.boundary_tolerance, map.settings.boundaries};
}

struct TuneCore {
  TuneTask task;
  Scene before;
  TuneResult result;
  std::vector<std::string> remarks;
};

}  // namespace hb::python
