// Which exponents may meet on the way from one place to another. Nothing is unfolded and nothing is remembered from
// farther away. See hb/engine/README.md, "Boundaries".
#pragma once

#include <vector>

#include "hb/engine/boundaries/strand_coupling.hpp"

namespace hb {

// Two strands of the first of two places.
struct Meeting {
  std::size_t a = 0, b = 0;
  double x = 0;  // where they meet, roughly
};

// Refers to its argument.
class Encounters {
 public:
  explicit Encounters(const StrandCoupling& coupling) : coupling_(coupling) {}

  // No two mean exponents that may excite each other (while unstable: quench) move by more than `most` against each
  // other.
  bool resolved(const Place& p, const Place& q, double most) const;

  // Pairs of p's strands that may come together on the way to q and make each other grow by more than `least`.
  std::vector<Meeting> meetings(const Place& p, const Place& q, double least) const;

  // The strands of each meeting with all others of p that come near one of its two on the way to q and may bend it,
  // whether they excite it or not; where there are such.
  std::vector<std::vector<std::size_t>> crowds(const Place& p, const Place& q,
                                               const std::vector<Meeting>& meetings) const;

  // Other strands of p that may excite strand k, which grows, or quench it, and come near it on the way to q.
  std::vector<std::size_t> neighbours(const Place& p, const Place& q, std::size_t k) const;

 private:
  const StrandCoupling& coupling_;
};

}  // namespace hb
