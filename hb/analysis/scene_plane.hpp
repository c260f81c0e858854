// A scene over two of its numbers: the systems of its elastic links at any place (x, y), cheap enough to be asked for
// at every step of a search. The speed may be one of the two. Other numbers enter through interpolation: the Ritz
// matrices, multiplied by EJ, are polynomials in stiffnesses, masses and dampings and analytic in lengths, so that few
// Chebyshev nodes give them to rounding; where they do not, each place is computed from the scene.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/work.hpp"
#include "hb/engine/boundaries/stability_map.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "lib/scene/scene.hpp"

namespace hb {

struct PlaneAxis {
  enum class Role { rpm, omega, scene_number };
  Role role = Role::scene_number;
  std::string path;
  double from = 0, to = 0;
};

struct PlaneOptions {
  Eigen::Index num_modes = 5;
  double speed = 0;  // rad per unit time, where no axis is the speed
  std::vector<std::string> rods;  // names asked for; empty: all
  const Work* work = nullptr;  // has to be given; outlives the plane
};

// Ritz terms for a map: those asked for; "auto": as many as the growth rate needs at the corners and in the middle.
// `speed` in rad per unit time, where no axis is the speed.
[[nodiscard]] int plane_modes(const SceneFamily& family, const PlaneAxis& x, const PlaneAxis& y, double speed,
                              const Settings& settings);

class ScenePlane {
 public:
  // Throws SceneError where the scene is wrong at a corner of the plane, RequestError for a name in options.rods that
  // is not an elastic link.
  ScenePlane(SceneFamily family, PlaneAxis x, PlaneAxis y, PlaneOptions options);
  ScenePlane(SceneSource source, std::vector<Override> overrides, PlaneAxis x, PlaneAxis y, PlaneOptions options)
      : ScenePlane(SceneFamily(std::move(source), std::move(overrides)), std::move(x), std::move(y),
                   std::move(options)) {}
  ~ScenePlane();
  ScenePlane(ScenePlane&&) noexcept;

  [[nodiscard]] const Scene& scene() const;  // at a corner
  [[nodiscard]] const std::vector<std::string>& rods() const;
  [[nodiscard]] double speed(double x, double y) const;  // rad per unit time
  // Whether the system of a rod depends on x and on y: a link's number may leave the system of another what it is.
  [[nodiscard]] std::array<bool, 2> varies(std::size_t rod) const;
  // Empty where the scene has no system. From any thread.
  [[nodiscard]] std::optional<ScaledSystem> system(std::size_t rod, double x, double y) const;
  // Why there is none: the message of the scene at that place; a linkage that does not turn through has its dyad.
  struct Absence {
    std::string message;
    int dyad = -1;
  };
  [[nodiscard]] std::optional<Absence> absence(double x, double y) const;
  // One sentence, for --stats.
  [[nodiscard]] std::string evidence() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace hb
