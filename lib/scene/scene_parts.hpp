// The parts of a scene, from checked TOML tables to values. Each notes what is wrong and then returns something unused.
#pragma once

#include "lib/scene/scene.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

struct SceneContext {
  Units units;
  std::filesystem::path folder;  // of further files
  double angle_unit() const;  // rad per unit of angle
};

[[nodiscard]] Units read_units(const TableView& scene);

// A linkage with every number checked; whether it turns through is not. `warnings` takes what is odd but usable.
[[nodiscard]] Linkage read_linkage(const TableView& scene, const SceneContext& context,
                                   std::vector<std::string>& warnings);

[[nodiscard]] HillSystem read_hill(const TableView& hill, const SceneContext& context);

// `num_modes` > 0: the size of a [hill] system, which `modes` cannot change.
[[nodiscard]] AnalysisDefaults read_analysis(const TableView& analysis, int num_modes);

// sum_k cos_k cos(k tau) + sin_k sin(k tau): c_k = (cos_k - i sin_k)/2, c_0 = cos_0.
inline std::complex<double> harmonic_coefficient(int k, double cos_k, double sin_k) {
  return k == 0 ? std::complex<double>(cos_k) : std::complex<double>(cos_k / 2, -sin_k / 2);
}

inline constexpr int max_harmonic = 10000;

}  // namespace hb
