// A design asked for in a few lines of C++: goal, variables, conditions and speeds of a family of scenes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/along.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/tune/tune_problem.hpp"
#include "hb/analysis/work.hpp"

namespace hb {

struct TuneRequest : Request {
  // One of them, as parse_goal and parse_largest_goal read it: "mass", "0.7*deflection+0.3*mass"; "stable".
  std::string minimise, maximise;
  // A number of the family, in its unit, between bounds; the search begins at the family's own value.
  struct Variable {
    std::string path;
    double lower = 0, upper = 0;
  };
  std::vector<Variable> vary;
  std::vector<std::string> keep;  // conditions as parse_keep reads them: "stable>=5", "deflection<=2"
  // "rpm" or "omega", over which goal and conditions are the worst: first looked at where its values are. None: at the
  // one speed of the request or the scene.
  std::optional<Along> over;
  SectionHeights heights;  // of elastic links whose scene gives none, for stress
  std::optional<int> analyses;  // at most
  DesignAlgorithm algorithm = DesignAlgorithm::automatic;
};

// How many analyses a search may take where that is not said.
[[nodiscard]] int usual_analyses(std::size_t num_variables);

// The request checked and made ready. Throws RequestError for what cannot be asked, SceneError for what cannot be.
[[nodiscard]] TuneTask tune_task(const SceneFamily& family, const TuneRequest& request);
[[nodiscard]] TuneResult tune(const SceneFamily& family, const TuneRequest& request, const Work& work = Work());

}  // namespace hb
