// How an answer moves with what is not known well: damping, Young's modulus, mass of the elastic links.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/scene_band.hpp"
#include "hb/analysis/steady.hpp"

namespace hb {

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
