// A scene at one speed: steady state, stability, shape of its rods and joint forces, of which only what is asked for
// is computed. What depends on geometry alone is in SceneModel, computed once.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/cut_error.hpp"
#include "hb/analysis/force_error.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/rod_stress.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/linkage/influence.hpp"
#include "lib/linkage/joint_forces.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"

namespace hb {

// One stage of the work, for --stats.
struct Stage {
  std::string name;  // "steady state of AB"
  double seconds = 0;
  std::string note;  // what was done, or why it was skipped; may be empty
  bool skipped = false;
};

struct RodModel {
  std::string name;  // "system" for a [hill] scene
  int link = -1;  // body number; -1 for a [hill] scene
  int coefficients = -1;  // place in LinkageCoefficients::rods
  bool reported = true;  // false: solved only because joint forces and the theory error need it
  Eigen::Index num_modes = 0;  // Ritz terms of the deflection; unknowns of a [hill] scene
  HillSystem system;  // with the number of modes asked for (auto: the number to start from); with shear 2 num_modes
  HillSystem finer;  // with comparison_modes; empty if the error of the cut is not asked for
};

struct SceneModel {
  Scene scene;
  LinkageCoefficients coefficients;  // empty for a [hill] scene
  std::vector<RodModel> rods;
  // Of the same rods and modes, for the theory error; null where q is not asked for and for a [hill] scene.
  std::shared_ptr<const ExactModel> exact;
  std::shared_ptr<const InfluenceTable> influence;  // null for a [hill] scene
  std::vector<Stage> stages;

  const Linkage* linkage() const { return std::get_if<Linkage>(&scene.model); }
};

// What of `only` the model has: a [hill] system has no joints and no shape.
[[nodiscard]] Only available(const SceneModel& model, Only only);

struct RodResult {
  std::string name;
  int link = -1;
  bool reported = true;
  Eigen::Index num_modes = 0;  // of the deflection
  Eigen::Index growth_modes = 0;  // that the exponents were computed with; 0: they were not asked for
  Eigen::Index num_exponents = 0;  // of the system with these
  std::optional<SteadyState> steady;  // q_1..q_I
  std::vector<Extremum> max_abs;  // of each q_i over the turn
  std::optional<CutError> cut;
  // With modes = "auto": estimated error of the growth rate from cutting the Ritz series, relative to the larger of
  // itself and the speed.
  std::optional<double> growth_modes_error;
  std::optional<RodShape> shape;
  std::optional<PeakErrors> peak_errors;  // of the shape, where the error of the cut was asked for
  std::optional<RodStress> stress;  // beside the shape
  std::optional<Stability> stability;
  bool growth_alone = false;  // exponents other than the leading ones were not asked for
  FourierSeries more_modes;  // the steady state with more modes, where the error of the cut was looked at
};

struct SpeedResult {
  double speed = 0;  // rad per unit time
  Only computed;  // what was asked for and exists in this scene
  std::vector<RodResult> rods;
  std::optional<JointForces> forces;
  std::optional<ForceErrors> force_errors;
  // Of the rods in their order; empty: q was not computed ("not judged"), or the scene has no elastic links.
  std::optional<TheoryErrors> theory;
  std::vector<std::string> shortfalls;  // one sentence for each thing that missed its tolerance; empty: all reached
  std::vector<std::string> notes;  // what is known less well than usual, though no tolerance was asked for it
  std::vector<Stage> stages;
};

// A linkage that turns through, but so near a dead centre that no number of crank angles allowed shows its motion.
class UnresolvedLinkage : public ObstructedLinkage {
 public:
  using ObstructedLinkage::ObstructedLinkage;
};

// Throws UnresolvedLinkage where the turn is not resolved.
void require_resolved(const Scene& scene, const LinkageCoefficients& coefficients);

// Throws RequestError for a name in settings.rods that is not an elastic link, and UnresolvedLinkage. With
// `compares_modes` false RodModel::finer stays empty.
[[nodiscard]] SceneModel make_model(Scene scene, const Settings& settings, bool compares_modes = true);

// With modes = "auto" each rod has as many modes as its deflection needs, and for the exponents as many as its growth
// rate needs; with `one_number` the larger of both for both.
[[nodiscard]] SpeedResult analyse(const SceneModel& model, double speed, const Settings& settings,
                                  bool one_number = false);

// Of the rod with this number of modes; a [hill] system has its own.
[[nodiscard]] HillSystem system_with(const SceneModel& model, const RodModel& rod, Eigen::Index num_modes);

[[nodiscard]] const char* method_text(SteadyMethod method);

// The cut of the Ritz series leaves a visible part of the deflection out.
[[nodiscard]] inline bool needs_more_modes(const RodResult& rod) { return rod.cut && !(rod.cut->deflection <= 0.01); }

// Exponents that were looked for, not resolved and not listed, of num_exponents.
[[nodiscard]] inline Eigen::Index unresolved_exponents(const RodResult& rod) {
  if (rod.stability->method == StabilityMethod::bound || rod.growth_alone) return 0;
  return rod.num_exponents - static_cast<Eigen::Index>(rod.stability->exponents.size());
}

}  // namespace hb
