// One place of a sweep: its exponents, what is known of them, and how they move on their way to another place.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/leading_pair.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"
#include "hb/engine/boundaries/strands.hpp"

namespace hb {

// A sample and its exponents.
struct Place {
  StabilitySample sample;
  mutable std::shared_ptr<const ParametricCoupling> coupling;  // computed when it is asked for
  std::optional<LeadingPair> pair;
  bool unstable = false;
  // Which strands of other places, by x, these go on as; filled by `onward`.
  mutable std::map<double, std::vector<std::size_t>> continued_at;

  // Computed when they are asked for.
  const Strands& strands() const {
    if (!known_strands) known_strands = strands_of(sample, mean());
    return *known_strands;
  }
  mutable std::optional<Strands> known_strands;
  const std::optional<LeadingPair>& alone() const {
    if (!known_alone) known_alone.emplace(leading_alone(sample));
    return *known_alone;
  }
  mutable std::optional<std::optional<LeadingPair>> known_alone;

  double x() const { return sample.x; }
  const std::vector<MeanExponent>& mean() const { return sample.mean; }  // of all modes
  double growth() const { return sample.stability.growth_rate / sample.speed; }
  double growth_error() const { return sample.stability.growth_error / sample.speed; }
};

// So far from zero growth need not be known as well as near it.
[[nodiscard]] inline bool is_far_from_zero(double growth) { return std::abs(growth) > 1e-3; }

[[nodiscard]] Place place_of(const StabilitySample& sample, const SystemAt& at);

// Which strand of q each one of p goes on as; computed once.
[[nodiscard]] const std::vector<std::size_t>& onward(const Place& p, const Place& q);

// Imaginary parts of two strands of one place apart, modulo 1: 0 .. 1/2.
[[nodiscard]] double apart(const Strands& strands, std::size_t a, std::size_t b);

// Twice what the mean exponents of each strand of p move on the way to q, twice what the strand moves otherwise, and
// what it seems to have moved.
[[nodiscard]] std::vector<double> motions(const Place& p, const Place& q);

// How far each strand of p moves on its way to q otherwise than its mean exponents tell, modulo 1.
[[nodiscard]] std::vector<double> unpredicted_motions(const Place& p, const Place& q);

}  // namespace hb
