// Ways to the exponents of one system whose modes all feel each other and whose K varies over the turn.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/system/scaled_system.hpp"

namespace hb {

struct ExponentSearch {
  Exponents exponents;
  StabilityMethod method = StabilityMethod::automatic;
  std::string evidence;
  std::vector<Eigen::Index> kept;  // modes propagated together
  bool complete = false;  // all 2I exponents are listed, or lie below `exponents.others_below`
  std::vector<SlavingStart> solved = {};  // of each mode alone, then of those kept together
};

// Gives every exponent its mode and its unfolded frequency: pairs go to the modes of the group whose mean equation
// z^2 + b z + w2 has the nearest root; each mode takes two.
void name_modes(Exponents& exponents, const Eigen::VectorXd& w2, const Eigen::VectorXd& b,
                const std::vector<Eigen::Index>& group);

// All modes propagated over the turn. With `leading_only` exponents far below the leading one are bounded only.
[[nodiscard]] ExponentSearch search_by_propagation(const ScaledSystem& system, double tolerance,
                                                   bool leading_only = false);

// Every mode on its own, the others slaved to it; modes for which that diverges together, with more modes until the
// reduction converges. Exponents `known` better from elsewhere take the place of those found. Slaving begins where
// `starts`, a neighbour's `solved`, say.
[[nodiscard]] ExponentSearch search_by_slaving(const ScaledSystem& system, double tolerance,
                                               const Exponents& known = {}, std::span<const SlavingStart> starts = {});

// Only the leading exponents: the slowest modes (or `keep`) with the others slaved to them, and a bound that puts all
// other exponents below; without such a bound all modes propagated. Empty if neither serves.
[[nodiscard]] std::optional<ExponentSearch> search_leading(const ScaledSystem& system, double tolerance,
                                                           const std::vector<int>& keep);

// Each exponent by Newton's method on the Hill equations.
[[nodiscard]] ExponentSearch search_by_hill(const ScaledSystem& system);

// Zeros of Hill's determinant near the leading exponent.
[[nodiscard]] ExponentSearch search_by_determinant(const ScaledSystem& system);

// Roots of the characteristic equation of constant coefficients.
[[nodiscard]] ExponentSearch search_constant(const ScaledSystem& system);

}  // namespace hb
