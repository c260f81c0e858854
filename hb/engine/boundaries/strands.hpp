// The exponents of one place modulo i, and which of them go on as which at a place nearby. Nothing is unfolded and
// nothing remembered: two exponents meet where they are equal modulo i, whatever their orders.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

constexpr std::size_t no_strand = static_cast<std::size_t>(-1);

struct Strand {
  std::complex<double> s;  // lambda/Omega, imaginary part in (-1/2, 1/2]
  double error = 0;
  std::vector<std::size_t> mean;  // mean exponents that it may have come from, the nearest first
  std::size_t partner = no_strand;  // at the same place of the axis, one growing faster than the other: locked
};

struct Strands {
  double x = 0;
  std::vector<Strand> all;  // growth descending; those that were found, and their conjugates
  std::vector<std::complex<double>> mean;
  double growth_error = 0;  // of the growth rate, per radian
};

// `mean`: of the sample's system.
[[nodiscard]] Strands strands_of(const StabilitySample& sample, const std::vector<MeanExponent>& mean);

// Growth of a strand, or of a locked one without what locks it: the mean of the two.
[[nodiscard]] double growth_by_itself(const Strands& strands, std::size_t k);

// Imaginary part to (-1/2, 1/2].
[[nodiscard]] std::complex<double> folded(std::complex<double> s);

// How far strand k of p moves on its way to q if the mean exponents tell, in either direction; modulo nothing.
[[nodiscard]] double mean_motion(const Strands& p, const Strands& q, std::size_t k);

// For each strand of p the one of q that it goes on as: nearest to where it is, or to where its mean exponent's motion
// takes it; of those that may have come from the same mean exponent, as far as they go. Each is taken once.
[[nodiscard]] std::vector<std::size_t> continued(const Strands& p, const Strands& q);

}  // namespace hb
