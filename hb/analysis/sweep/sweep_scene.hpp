// A scene with one number free: its model at any value of an axis.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/scene_family.hpp"

namespace hb {

struct Axis {
  enum class Kind { rpm, omega, parameter };
  Kind kind = Kind::rpm;
  std::string path = "rpm";  // "rpm", "omega", or a scene number's path
  std::vector<double> values;  // ascending
};

// The scene with the axis at one value.
struct ScenePlace {
  std::shared_ptr<const SceneModel> model;  // null: no linkage there
  double speed = 0;  // rad per unit time
  std::string problem;  // why there is none
};

// The linkage alone, without what is computed from it.
struct LinkagePlace {
  std::optional<Linkage> linkage;
  std::string problem;  // why there is none
};

// Immutable; free to share by threads.
class SweepScene {
 public:
  // `fixed_speed` (rad per unit time; `fixed_rpm` as given) is used where the axis is not the speed. Throws SceneError
  // or RequestError for what cannot be at any value; a linkage that does not close is a place's problem instead.
  SweepScene(SceneFamily family, Settings settings, Axis axis, double fixed_speed, double fixed_rpm);
  SweepScene(SceneSource source, std::vector<Override> overrides, Settings settings, Axis axis, double fixed_speed,
             double fixed_rpm)
      : SweepScene(SceneFamily(std::move(source), std::move(overrides)), std::move(settings), std::move(axis),
                   fixed_speed, fixed_rpm) {}

  [[nodiscard]] ScenePlace at(double x) const;
  [[nodiscard]] double speed_at(double x) const;  // rad per unit time
  // For a linkage scene; also beyond the axis' values.
  [[nodiscard]] LinkagePlace linkage_at(double x) const;
  const Axis& axis() const { return axis_; }
  double fixed_rpm() const { return fixed_rpm_; }
  const Settings& settings() const { return settings_; }
  const Scene& scene() const { return first_->scene; }  // at the first value that closes
  // Of the scene, of the axis' both ends where it is a number of the scene: range_warnings().
  [[nodiscard]] std::vector<std::string> warnings() const;
  const SceneModel& first() const { return *first_; }

 private:
  SceneFamily family_;
  Settings settings_;
  Axis axis_;
  double fixed_speed_, fixed_rpm_;
  Units units_;
  std::shared_ptr<const SceneModel> first_;
  std::size_t id_;  // of this object and its copies alone
};

}  // namespace hb
