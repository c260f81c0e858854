// Sweep, map and cross-check of a scene, or of scenes that a function builds, by a request. Work: serial where none is
// given. All throw RequestError for what cannot be asked, and SceneError for what cannot be anywhere.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hb/analysis/along.hpp"
#include "hb/analysis/cross_check.hpp"
#include "hb/analysis/map_task.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "hb/analysis/work.hpp"

namespace hb {

struct SweepRequest : Request {
  Along x;
};

// The points, what lies between them, and the scene that they belong to.
struct Sweep : SweepResult {
  std::shared_ptr<const SweepScene> scene;
};
// The request checked and made ready: run_sweep computes it.
[[nodiscard]] std::shared_ptr<const SweepScene> sweep_scene(const SceneFamily& family, const SweepRequest& request);
[[nodiscard]] Sweep sweep(const SceneFamily& family, const SweepRequest& request, Work& work);
[[nodiscard]] Sweep sweep(const SceneFamily& family, const SweepRequest& request);

// MapTask ready and computed.
[[nodiscard]] Map map(const SceneFamily& family, const MapRequest& request, Work& work);
[[nodiscard]] Map map(const SceneFamily& family, const MapRequest& request);

struct CheckRequest : Request {
  std::vector<double> rpms, omegas;  // several speeds instead of one
  Integrator integrator = Integrator::automatic;
  double case_limit = 60;  // seconds for each rod and speed
  bool march = false;  // also march from rest where the motion is stable
  // Told from any thread: an integration that begins, with the seconds it will take, and a speed (rad per unit time)
  // that is done.
  std::function<void(const std::string& rod, double speed, Integrator, double seconds)> begin = {};
  std::function<void(double speed)> done = {};
  // Told before the first: bytes that one speed will take, about.
  std::function<void(double bytes)> expected = {};
};

// Rad per unit time, those of `rpms` or the one speed. Throws RequestError.
[[nodiscard]] std::vector<double> speeds_of(const CheckRequest& request, const Scene& scene);

// Work that ends early leaves speeds out, which a shortfall says; perhaps all.
struct Check {
  Settings settings;
  std::shared_ptr<const SceneModel> model;
  std::vector<SpeedCheck> speeds;
  bool over_range = false;  // several were asked for

  [[nodiscard]] bool agrees() const;  // in everything that could be compared
  [[nodiscard]] bool reached() const;  // nothing missed its tolerance, all was compared
};
[[nodiscard]] Check check(const Scene& scene, const CheckRequest& request, const Work& work);
[[nodiscard]] Check check(const Scene& scene, const CheckRequest& request = {});

}  // namespace hb
