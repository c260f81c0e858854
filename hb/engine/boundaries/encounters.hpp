// Which exponents may meet on the way from one place to another, and which stay locked to each other. Nothing is
// unfolded and nothing is remembered from farther away. See hb/engine/README.md, "Boundaries".
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/leading_pair.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"
#include "hb/engine/boundaries/strands.hpp"

namespace hb {

// A sample and its exponents.
struct Place {
  StabilitySample sample;
  Strands strands;
  std::vector<MeanExponent> mean;
  std::shared_ptr<const ParametricCoupling> coupling;  // computed when it is asked for
  std::optional<LeadingPair> pair, alone;
  bool unstable = false;
  // Which strands of other places, by x, these go on as; filled by `onward`.
  mutable std::map<double, std::vector<std::size_t>> continued_at;

  double x() const { return sample.x; }
  double growth() const { return sample.stability.growth_rate / sample.speed; }
  double growth_error() const { return sample.stability.growth_error / sample.speed; }
};

// Two strands of the first of two places.
struct Meeting {
  std::size_t a = 0, b = 0;
  double x = 0;  // where they meet, roughly
};

// Which strand of q each one of p goes on as; computed once.
[[nodiscard]] const std::vector<std::size_t>& onward(const Place& p, const Place& q);

// Imaginary parts of two strands of one place apart, modulo 1: 0 .. 1/2.
[[nodiscard]] double apart(const Strands& strands, std::size_t a, std::size_t b);

// Twice what the mean exponents of each strand of p move on the way to q, twice what the strand moves otherwise, and
// what it seems to have moved.
[[nodiscard]] std::vector<double> motions(const Place& p, const Place& q);

// How far each strand of p moves on its way to q otherwise than its mean exponents tell, modulo 1.
[[nodiscard]] std::vector<double> unpredicted_motions(const Place& p, const Place& q);

// Refers to its arguments.
class Encounters {
 public:
  Encounters(const SystemAt& at, const SweepOptions& options) : at_(at), options_(options) {}

  Place place(const StabilitySample& sample) const;

  // No two mean exponents that may excite each other (while unstable: quench) move by more than `most` against each
  // other.
  bool resolved(Place& p, Place& q, double most) const;

  // Pairs of p's strands that may come together on the way to q and make each other grow by more than `least`.
  std::vector<Meeting> meetings(Place& p, Place& q, double least) const;

  // The strands of each meeting with all others of p that come near one of its two on the way to q and may bend it,
  // whether they excite it or not; where there are such.
  std::vector<std::vector<std::size_t>> crowds(Place& p, const Place& q, const std::vector<Meeting>& meetings) const;

  // Two exponents that give the growth at p are locked to each other and stay so to q, or those of q to p; or two
  // others that grow at both places.
  bool lock_holds(Place& p, Place& q) const;

  // The exponents that give the growth are locked, to multipliers of one kind.
  static bool locked_alike(const Place& p, const Place& q);

  // Other strands of p that may excite strand k, which grows, or quench it, and come near it on the way to q.
  std::vector<std::size_t> neighbours(Place& p, Place& q, std::size_t k) const;

 private:
  const ParametricCoupling* coupling(Place& p) const;
  double needed_coupling(double growth, double other) const;
  enum class Effect { excites, quenches };
  double motion_towards(Place& p, Place& q, std::size_t a, std::size_t b, double needed, Effect effect) const;
  double exciting_motion(Place& p, Place& q, std::size_t a, std::size_t b, double needed) const {
    return motion_towards(p, q, a, b, needed, Effect::excites);
  }
  bool quenched(Place& p, Place& q, std::size_t a, std::size_t b) const;
  double largest_coupling(Place& p, std::size_t a, std::size_t b, Effect effect) const;
  bool same_lock(Place& p, std::size_t k, Place& q, std::size_t l) const;
  bool locked_throughout(Place& p, std::size_t k, Place& q) const;
  bool leading_lock_holds(Place& p, Place& q) const;
  std::vector<std::size_t> growing_locks(const Place& p) const;

  const SystemAt& at_;
  const SweepOptions& options_;
};

}  // namespace hb
