// The points of a report with everything that `hb steady` knows of them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "hb/analysis/work.hpp"

namespace hb::tools {

struct ReportPlace {
  std::shared_ptr<const SceneModel> model;  // null: no system here
  SpeedResult result;
  std::string problem;  // why there is none
  std::optional<NonlinearResult> motion = {};  // without linearisation, where asked for and there
};

// One speed without linearisation, beside the linear answer; that alone, and why, where no motion was found.
[[nodiscard]] ReportPlace nonlinear_place(const std::shared_ptr<const SceneModel>& model, const NonlinearResult& motion,
                                          const Settings& settings);

// Of more points than this a report keeps the documents and curves of every so many; verdicts and growth of all.
inline constexpr std::size_t most_places = 400;
// Indices of the points that are kept: all, or every so many and the last.
[[nodiscard]] std::vector<std::size_t> kept_points(std::size_t count);

// At the points of the axis that are kept; with `branches` also the motion of the branch followed from the first value.
[[nodiscard]] std::vector<ReportPlace> places_along(const SweepScene& scene, const Work& work,
                                                    const NonlinearSweep* branches = nullptr);

}  // namespace hb::tools
