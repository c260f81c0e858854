// What a system falls apart into: groups of modes that do not feel each other, or only one way, and a shorter period
// where only every g-th harmonic of K is there. Exponents of the parts are those of the whole.
#pragma once

#include <vector>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// Groups of modes without any coupling in K or G between them, each ascending, in the order of their first modes.
[[nodiscard]] std::vector<std::vector<int>> independent_groups(const ScaledSystem& system);

// Groups of modes that feel each other both ways: strongly connected components of the graph of couplings in K and G,
// each ascending, in the order of their first modes. Ordered along the couplings the system is block triangular, so the
// exponents of the groups are those of the whole.
[[nodiscard]] std::vector<std::vector<int>> one_way_groups(const ScaledSystem& system);

// The modes of one group alone; no load.
[[nodiscard]] ScaledSystem group_of(const ScaledSystem& system, const std::vector<int>& modes);

// Greatest common divisor g of the harmonics that K has; 0 if it is constant.
[[nodiscard]] Eigen::Index common_divisor(const ScaledSystem& system);

// The same system in tau' = g tau, with period 2 pi in tau': speed g Omega. No load.
[[nodiscard]] ScaledSystem with_period_divided(const ScaledSystem& system, Eigen::Index g);

}  // namespace hb
