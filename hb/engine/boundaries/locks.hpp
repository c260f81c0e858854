// Which exponents stay locked to each other on the way from one place to another: hb/engine/README.md, "Gaps between
// two unstable places".
#pragma once

#include <vector>

#include "hb/engine/boundaries/strand_coupling.hpp"

namespace hb {

// Refers to its argument.
class Locks {
 public:
  explicit Locks(const StrandCoupling& coupling) : coupling_(coupling) {}

  // Two exponents that give the growth at p are locked to each other and stay so to q, or those of q to p; or two
  // others that grow at both places.
  bool hold(const Place& p, const Place& q) const;

  // No third strand comes near strand k of p on the way to q that may end its growth.
  bool undisturbed(const Place& p, std::size_t k, const Place& q) const;

 private:
  bool same(const Place& p, std::size_t k, const Place& q, std::size_t l) const;
  bool throughout(const Place& p, std::size_t k, const Place& q) const;
  bool leading_holds(const Place& p, const Place& q) const;
  std::vector<std::size_t> growing(const Place& p) const;

  const StrandCoupling& coupling_;
};

// The exponents that give the growth are locked, to multipliers of one kind.
[[nodiscard]] bool locked_alike(const Place& p, const Place& q);

}  // namespace hb
