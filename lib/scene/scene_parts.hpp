// The parts of a scene, from checked TOML tables to values. Each notes what is wrong and then returns something unused.
#pragma once

#include "lib/scene/scene.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

struct SceneContext {
  Units units;
  std::filesystem::path folder;  // of further files
  std::vector<Remark>& remarks;
  double angle_unit() const;  // rad per unit of angle
};

[[nodiscard]] Units read_units(const TableView& scene);

// A linkage with every number checked; whether it turns through is not.
[[nodiscard]] Linkage read_linkage(const TableView& scene, const SceneContext& context);

// Elastic data of a link of known length, and the mass and inertia that follow.
void read_elastic(const TableView& link, const TableView& elastic, const SceneContext& context, Body& body);

// `force` and `pressure` of a slider along its direction, added up. Pressure pushes it toward the crank: against the
// sign of its position, which is the dyad's `branch`.
[[nodiscard]] FourierSeries read_slider_force(const TableView& slider, int branch, const SceneContext& context);

[[nodiscard]] HillSystem read_hill(const TableView& hill, const SceneContext& context);

// `num_modes` > 0: the size of a [hill] system, which `modes` cannot change.
[[nodiscard]] AnalysisDefaults read_analysis(const TableView& analysis, int num_modes);

// sum_k cos_k cos(k tau) + sin_k sin(k tau): c_k = (cos_k - i sin_k)/2, c_0 = cos_0.
inline std::complex<double> harmonic_coefficient(int k, double cos_k, double sin_k) {
  return k == 0 ? std::complex<double>(cos_k) : std::complex<double>(cos_k / 2, -sin_k / 2);
}

inline constexpr int max_harmonic = 10000;

}  // namespace hb
