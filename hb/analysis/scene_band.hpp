// Scenes whose damping, Young's modulus or mass is not known well: a factor on that of all elastic links.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/along.hpp"

namespace hb {

enum class BandParameter { damping, youngs_modulus, mass };

// All elastic links' numbers times a factor between `from` and `to`; of a [hill] scene the damping matrix.
struct BandRequest {
  BandParameter parameter = BandParameter::damping;
  double from = 1, to = 1;
};

// "damping=0.5:2", "E=0.9:1.1", "mass=0.95:1.05". Throws RequestError for the field band.
[[nodiscard]] BandRequest parse_band(const std::string& text);
[[nodiscard]] const char* to_string(BandParameter parameter);  // "damping", "E", "mass"

// Damping: internal and external. Mass: with the density, so that inertia goes with it. Throws RequestError for what
// the scene does not have.
[[nodiscard]] Scene scaled_scene(Scene scene, BandParameter parameter, double factor);

// The same at all numbers of a family that vary; the factor applies to the scene at each. Throws RequestError.
[[nodiscard]] SceneFamily scaled_family(const SceneFamily& family, const std::vector<const Along*>& axes,
                                        BandParameter parameter, double factor);

}  // namespace hb
