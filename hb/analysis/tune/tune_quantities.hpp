// Quantities of one design at one speed: what tune_design.hpp takes the worst of and tune_gradient.hpp differentiates.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/nearest_resonance.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/exponents/stability.hpp"

namespace hb {

struct MetricValue {
  double value = 0;  // in unit_of(kind); NaN where there is no periodic solution
  std::optional<double> speed;  // where it is worst, rad per unit time
  std::string where;  // rod or joint
  std::size_t index = 0;  // of that rod in SceneModel::rods, of that joint in JointForces::joints
  double factor = 1;  // from the scene's units
  // From `complete`:
  double error = 0;  // estimate: modes left out, harmonics, rounding
  std::optional<double> position = std::nullopt;  // from joint 0, over the rod's length
  std::optional<double> crank_angle = std::nullopt;  // rad
  std::string against = {};  // of a safety: yielding, fatigue
  // What the exact model would change of the value (theory_error.hpp), in its unit: of deflections, joint forces,
  // torque and margins of linkages; infinite beyond the linear theory.
  std::optional<double> theory_error = std::nullopt;
};

// Their values.
[[nodiscard]] std::vector<double> numbers_of(const std::vector<MetricValue>& values);

// Section height across the rod, by name; "*" for all that are not named.
using SectionHeights = std::map<std::string, double>;

// Periodic solution of one rod, its unknowns and its q; empty where there is none.
[[nodiscard]] std::optional<FourierSeries> rod_unknowns(const RodModel& rod, double speed, const Settings& settings);
[[nodiscard]] std::optional<FourierSeries> rod_response(const RodModel& rod, double speed, const Settings& settings);
// Of a [hill] scene the deflection is the largest |q_i|.
[[nodiscard]] RodShape shape_of(const SceneModel& model, const RodModel& rod, double speed, const FourierSeries& q);

// The link with the height of its section, also where it is given beside the scene. Throws RequestError for a rod
// without one.
[[nodiscard]] Body with_height(const SceneModel& model, const RodModel& rod, const SectionHeights& heights,
                               const Metric& metric);
// MPa in a unit of stress of the scene.
[[nodiscard]] double in_megapascal(const Units& units);
// MPa per unit of bending moment: sigma = |E J w''| h/(2 J). Throws RequestError for a rod without height.
[[nodiscard]] double stress_factor(const SceneModel& model, const RodModel& rod, const SectionHeights& heights,
                                   const Metric& metric);

struct JointQuantities {
  std::vector<std::string> names;
  std::vector<double> force, at;  // largest length over the turn, and its crank angle
  Range torque;
};
[[nodiscard]] JointQuantities joint_quantities(const JointForces& forces);
// `q` by rod of the model; empty: rigid.
[[nodiscard]] JointForces forces_of(const SceneModel& model, double speed, const std::vector<FourierSeries>& q,
                                    double tolerance = 1e-10);

// Theory error of each rod of a linkage with responses q: where there is none, 1 + the largest slope.
[[nodiscard]] std::vector<double> theory_of(const SceneModel& model, double speed, const std::vector<FourierSeries>& q);

// The system of p in q = e^{-mt} p: stable where q decays faster than e^{-mt}.
[[nodiscard]] HillSystem shifted(const HillSystem& system, double m);
[[nodiscard]] Stability shifted(Stability stability, double m);
// Modes of the mean system; NaN where overdamped or not held up.
[[nodiscard]] std::vector<ModeState> mean_modes(const ScaledSystem& system);

// Leading exponents alone where that gives a bound, else all of them; and what the margin is judged by: rate and error.
[[nodiscard]] Stability leading_stability(const ScaledSystem& system, const Settings& settings);
[[nodiscard]] double growth_of(const Stability& stability);

// Of the elastic link of that name; empty: of all asked for.
[[nodiscard]] double mass_of(const SceneModel& model, const std::string& name);

// omega_1 of the mean system at rest, rad per unit time.
[[nodiscard]] double lowest_frequency(const HillSystem& system);

struct SpeedSpan {
  double from = 0, to = 0;  // rad per unit time; equal: one speed
  int num_nodes = 24;  // sampled before refinement
};

// Place, crank angle and error of a worst case found. The largest deflection and stress are sought once more over
// speed, place and crank angle together; errors are seen with more modes, and from the harmonics' bound.
void complete(MetricValue& value, const SceneModel& model, const SectionHeights& heights, const SpeedSpan& span,
              const Settings& settings, const Metric& metric);

}  // namespace hb
