// Whether exponents lie in pairs about the imaginary axis, as they do wherever disturbances of a system whose exponents
// add up to zero stay bounded over an interval. hb/engine/README.md, (B16).
#pragma once

#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

// The image -conj(s) of an exponent is none of the others, by more than the errors of both. False where not all of
// them are known.
[[nodiscard]] bool lacks_an_image(const StabilitySample& sample);

// No stable gap that is wider than a point lies between p and q, both unstable: tr G = 0, and an exponent of each lacks
// its image.
[[nodiscard]] bool excludes_gaps(const SystemAt& at, const StabilitySample& p, const StabilitySample& q);

}  // namespace hb
