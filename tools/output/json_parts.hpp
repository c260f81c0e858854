// Pieces that several JSON documents have.
#pragma once

#include <complex>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/cut_error.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "lib/linkage/joint_forces.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "tools/output/json.hpp"

namespace hb::tools {

// [re, im], no "-0.0".
[[nodiscard]] Json pair(std::complex<double> value);
// {"min":, "max":} over the turn.
[[nodiscard]] Json range_json(const FourierSeries& series, Eigen::Index component);
// Per component [[re, im], ...].
[[nodiscard]] Json fourier_json(const FourierSeries& series);
[[nodiscard]] Json peak_json(const RodPeak& peak, const Units& units);
// "deflection" and "bending_moment" of a rod.
void add_shape(Json& rod, const RodShape& shape, const std::optional<PeakErrors>& errors, const Units& units);
// [[re, im], ...].
[[nodiscard]] Json exponents_json(const std::vector<Exponent>& exponents);
// Exponents with their errors, growth rate, verdict; of `num_exponents` that there are.
[[nodiscard]] Json stability_json(const Stability& stability, Eigen::Index num_exponents);
// Frequencies, damping ratios and multipliers of each; `speed` that of the period: the crank's, over T turns 1/T of it.
void add_modes(Json& json, const std::vector<Exponent>& exponents, double speed, const Units& units);
// By joint and component, elastic beside rigid.
[[nodiscard]] Json joints_json(const JointForces& forces);

}  // namespace hb::tools
