// The growth rate of a periodic system to a few digits, without an error bound: one propagation over the turn.
#pragma once

#include "lib/fourier/fourier.hpp"

namespace hb {

// x'' + beta(tau) x' + alpha(tau) x = 0, ' = d/dtau.
struct PeriodicCoefficients {
  FourierSeries alpha, beta;  // n*n components, column-major
  Eigen::Index num_modes = 0;  // n
};

// Largest real part of the exponents by Radau IIA over so many cells, one of radau_cells: what they do not resolve they
// damp.
[[nodiscard]] double rough_growth(const PeriodicCoefficients& of, Eigen::Index num_cells);

}  // namespace hb
