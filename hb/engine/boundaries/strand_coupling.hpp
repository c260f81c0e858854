// Which strands of a place may make each other grow, or quench one another, as far as the mean exponents that they may
// have come from tell: hb/engine/README.md, (B4), (B9).
#pragma once

#include "hb/engine/boundaries/place.hpp"

namespace hb {

// Two of which one grows leave a gap only if they decay together: not if the sum of both, at two places, is larger than
// it changes.
[[nodiscard]] bool grow_together(double sum_p, double sum_q);

// Upper estimate of the growth of two strands that move by `most` against each other: the faster growth and half of
// that, since |sqrt(Q)| of (B2) changes by no more than delta does and m stays.
[[nodiscard]] double highest_together(const Strands& strands, std::size_t a, std::size_t b, double most);

// Refers to its arguments.
class StrandCoupling {
 public:
  StrandCoupling(const SystemAt& at, const SweepOptions& options) : at_(at), options_(options) {}

  enum class Effect { excites, quenches };

  double least_growth() const { return options_.least_growth; }
  int max_order() const { return options_.max_order; }

  // Of the mean exponents of a place; null if there is no system.
  const ParametricCoupling* of(const Place& p) const;
  // Two exponents that meet grow if their coupling exceeds this, the root of the product of their decays.
  double needed(double growth, double other) const;
  // Upper estimate of the coupling of two strands of p; infinite if they cannot be named.
  double largest(const Place& p, std::size_t a, std::size_t b, Effect effect) const;
  // How far two strands of p that may excite each other by `needed` or more move against each other on the way to q at
  // most, twice as far as their mean exponents, by the stronger coupling of both places; negative: they do not.
  double exciting_motion(const Place& p, const Place& q, std::size_t a, std::size_t b, double needed) const {
    return motion_towards(p, q, a, b, needed, Effect::excites);
  }
  // Strand a grows, b decays and may take its growth away on the way to q.
  bool quenched(const Place& p, const Place& q, std::size_t a, std::size_t b) const;
  // Strand a grows, alone or locked to another one, like g where a third one, c, comes next to it, which may end that:
  // as above, or where nothing decays by taking its partner.
  bool ended(const Place& p, const Place& q, std::size_t a, std::size_t c, double g) const;

 private:
  double motion_towards(const Place& p, const Place& q, std::size_t a, std::size_t b, double needed,
                        Effect effect) const;

  const SystemAt& at_;
  const SweepOptions& options_;
};

}  // namespace hb
