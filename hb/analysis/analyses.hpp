// Sweep, map and cross-check of a scene, or of scenes that a function builds, by a request. Work: serial where none is
// given. All throw RequestError for what cannot be asked, and SceneError for what cannot be anywhere.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/cross_check.hpp"
#include "hb/analysis/map_result.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "hb/analysis/work.hpp"

namespace hb {

// A number and its values in ascending order: "rpm", "omega" (rad per the scene's unit of time), or one of the family.
struct Along {
  std::string path;
  std::vector<double> values;
};
// The speed, also by its path in a scene ("analysis.rpm").
[[nodiscard]] bool is_speed(const std::string& path);
// Two paths that name one number: "AB.J" and "*.J" do where AB is elastic.
[[nodiscard]] bool same_number(const SceneFamily& family, const std::string& a, const std::string& b);
// N >= 2 equally spaced values, both ends included.
[[nodiscard]] Along along(std::string path, double from, double to, std::size_t count);

struct SweepRequest : Request {
  Along x;
};

// The points, what lies between them, and the scene that they belong to.
struct Sweep : SweepResult {
  std::shared_ptr<const SweepScene> scene;
};
[[nodiscard]] Sweep sweep(const SceneFamily& family, const SweepRequest& request, Work& work);
[[nodiscard]] Sweep sweep(const SceneFamily& family, const SweepRequest& request);

struct MapRequest : Request {
  Along x, y;  // one of them may be the speed
};

struct Map : MapResult {
  Scene scene;  // at some place of the map
  Settings settings;
  int num_modes = 0;
  double boundary_tolerance = 0;  // of boundary points, relative
  std::string evidence;  // one sentence: what was computed
};
// modes = "auto" stands for 5: of the systems of a map all have the same size.
[[nodiscard]] Map map(const SceneFamily& family, const MapRequest& request, Work& work);
[[nodiscard]] Map map(const SceneFamily& family, const MapRequest& request);

struct CheckRequest : Request {
  std::vector<double> rpms, omegas;  // several speeds instead of one
  Integrator integrator = Integrator::automatic;
  double case_limit = 60;  // seconds for each rod and speed
  bool march = false;  // also march from rest where the motion is stable
};

// Rad per unit time, those of `rpms` or the one speed. Throws RequestError.
[[nodiscard]] std::vector<double> speeds_of(const CheckRequest& request, const Scene& scene);

struct Check {
  Settings settings;
  std::shared_ptr<const SceneModel> model;
  std::vector<SpeedCheck> speeds;

  [[nodiscard]] bool agrees() const;  // in everything that could be compared
  [[nodiscard]] bool reached() const;  // nothing missed its tolerance, all was compared
};
[[nodiscard]] Check check(const Scene& scene, const CheckRequest& request, const Work& work);
[[nodiscard]] Check check(const Scene& scene, const CheckRequest& request = {});

}  // namespace hb
