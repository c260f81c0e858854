// Stability over two numbers of a scene: a request checked and made ready, and what it leads to.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/along.hpp"
#include "hb/analysis/map_result.hpp"
#include "hb/analysis/scene_band.hpp"
#include "hb/analysis/work.hpp"

namespace hb {

struct MapRequest : Request {
  Along x, y;  // one of them may be the speed
  // Boundaries also with the damping (SceneFamily::damping_paths) times both factors, 0 <= low < high.
  std::optional<std::array<double, 2>> damping_range;
  // Or with damping, Young's modulus or mass of all elastic links times both factors.
  std::optional<BandRequest> band;
  bool stress = false;  // also stress, safety and deflection at every point, of links that all have a section
};

struct Map : MapResult {
  Scene scene;  // at some place of the map
  Settings settings;
  int num_modes = 0;
  double boundary_tolerance = 0;  // of boundary points, relative
  std::string evidence;  // one sentence: what was computed
  std::vector<std::string> warnings;  // of the scenes at its corners: range_warnings()
  bool complete = true;  // false: whoever did the work ended early
};

class MapTask {
 public:
  // Throws RequestError for what cannot be asked, SceneError for what cannot be anywhere. modes = "auto" stands for as
  // many as the growth rate needs: of the systems of a map all have the same size. `geometry` makes the plane ready and
  // outlives this.
  MapTask(const SceneFamily& family, const MapRequest& request, const Work& geometry);

  [[nodiscard]] Map compute(Work& work) const;

  // All that the map depends on.
  const ScenePlane& plane() const { return *plane_; }
  const Along& x() const { return request_.x; }
  const Along& y() const { return request_.y; }
  const Settings& settings() const { return settings_; }
  const std::optional<std::array<double, 2>>& damping_range() const { return request_.damping_range; }
  const std::optional<BandRequest>& band() const { return request_.band; }
  bool stress() const { return request_.stress; }

 private:
  MapRequest request_;
  Settings settings_;
  PlaneAxis x_axis_, y_axis_;
  PlaneOptions options_;
  SceneFamily family_;
  std::optional<ScenePlane> plane_;
  std::array<double, 2> factors_{};
  std::vector<SceneFamily> ends_;  // with those
};

}  // namespace hb
