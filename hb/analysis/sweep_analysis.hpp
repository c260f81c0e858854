// A scene along one parameter: everything at the points asked for, and what lies between them: resonance peaks and
// unstable bands, both located.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/work.hpp"
#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/boundaries/sweep.hpp"
#include "hb/engine/steady/response_peak.hpp"

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

// Smallest and largest over the turn.
struct TurnRange {
  double min = 0, max = 0;
};

struct RodPoint {
  std::optional<SteadyStatus> steady;  // empty: not asked for
  int num_harmonics = 0;
  double error_bound = 0, resonance_distance = 0;
  std::vector<double> max_abs;  // of each q_i over the turn; empty if singular
  std::optional<double> deflection, bending_moment;  // largest over rod and turn
  std::optional<double> buckling_share, strain;  // RodStress, beside them
  std::optional<double> theory_error;  // TheoryErrors::Rod::q; empty: beyond the linear theory, or q not asked for
  std::optional<StabilitySample> stability;
};

struct SweepPoint {
  double x = 0, speed = 0;
  std::string problem;  // no linkage at this x: why; everything below is empty then
  std::vector<RodPoint> rods;
  std::vector<TurnRange> joints, joints_rigid;  // per component, in the order of SweepResult::joint_components
  std::optional<TurnRange> torque, torque_rigid;
};

// A local maximum of a rod's largest |q_i|.
struct CriticalPoint {
  std::size_t rod = 0;
  int component = 0;  // i - 1: the q_i that peaks
  int mode = -1;  // whose frequency is met; -1 if not known (stability not asked for)
  int order = 0;  // n = omega/Omega, rounded; 0 if not known
  double frequency = 0;  // of that mode there, rad per unit time
  double damping = 0;  // its decay rate, 1/time
  double speed = 0;
  double prominence = 0;  // height above the higher of the two valleys beside it, relative to the peak
  ResponsePeak peak;
};

struct SweepRod {
  std::string name;
  bool reported = true;  // false: solved only because joint forces need it
  int num_modes = 0;
  std::vector<StabilityBoundary> boundaries;
  std::vector<UnstableBand> bands;
  std::vector<std::array<double, 2>> not_excluded;  // where a band or a gap may have been missed, ascending
};

struct SweepResult {
  Only computed;
  std::vector<SweepRod> rods;
  std::vector<SweepPoint> points;  // as asked for
  std::vector<SweepPoint> refined;  // between them: at peaks with their flanks, and at boundaries; ascending
  std::vector<CriticalPoint> critical;  // by rod, then ascending x
  std::vector<std::string> joint_components;  // "AB.0 x"
  std::vector<std::string> shortfalls;  // tolerances asked for that were not reached
  std::vector<std::string> notes;  // what is known less well than usual, though no tolerance was asked for it
  std::vector<Stage> stages;
  bool searched_bands = true, searched_peaks = true;  // between the points
};

[[nodiscard]] SweepResult run_sweep(const SweepScene& scene, Work& work);

// Points and refined points together, ascending.
[[nodiscard]] std::vector<const SweepPoint*> all_points(const SweepResult& result);
// Tracked modes of one rod at these points.
[[nodiscard]] std::vector<std::vector<ModeState>> tracks(const SweepResult& result, std::size_t rod,
                                                         const std::vector<const SweepPoint*>& points);

}  // namespace hb
