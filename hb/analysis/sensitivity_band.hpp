// How an answer moves with what is not known well: damping, Young's modulus, mass of the elastic links.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/steady.hpp"

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

// d ln |value| / d ln factor at factor 1, from the derivatives that hb::tune uses (tune/tune_gradient.hpp).
struct BandSlope {
  std::string of, quantity;  // "AB" with "deflection" or "growth rate", a joint's name with "bearing"
  double value = 0;
};

struct SensitivityBand {
  BandRequest asked;
  SteadyResult low, high;  // computed anew at both ends
  std::vector<BandSlope> slopes;  // those that exist
};

// Throws RequestError.
[[nodiscard]] std::vector<SensitivityBand> sensitivity_bands(const Scene& scene, const Request& request,
                                                             const std::vector<BandRequest>& bands);

// The same at every point of a sweep, without slopes and without what lies between the points.
struct SweepBand {
  BandRequest asked;
  Sweep low, high;
};
// The factor is applied to the scene at each value of what is swept: along AB.E with the band E=0.9:1.1 each value is
// multiplied. Throws RequestError.
[[nodiscard]] std::vector<SweepBand> sweep_bands(const SceneFamily& family, SweepRequest request,
                                                 const std::vector<BandRequest>& bands, Work& work);

}  // namespace hb
