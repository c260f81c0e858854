// Results of long work as Python holds them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "hb/analysis/sensitivity_band.hpp"
#include "hb/analysis/tune/tune_problem.hpp"

namespace hb::python {

// The linear theory, and where it was asked for the motion without linearisation beside it.
struct SweepCore {
  Sweep linear;
  std::optional<NonlinearSweep> branches;
  std::vector<SweepBand> bands = {};
};

struct TuneCore {
  SceneSource source;
  TuneTask task;
  Scene before;
  TuneResult result;
  std::vector<std::string> remarks;
};

}  // namespace hb::python
