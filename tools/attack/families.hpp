// Random systems by families that are hard in different ways for an exponent's error.
#pragma once

#include <array>
#include <cstdint>

#include "lib/hill_system.hpp"

namespace hb::attack {

enum class Family {
  random,  // two to four modes, modal damping, decaying symmetric coupling
  twins,  // modes alike to 1e-14, coupled by as little
  tongue,  // one or two modes next to a boundary of instability: two exponents meet
  defective,  // Jordan blocks in the mean, closed by couplings down to nothing
  one_way,  // block triangular, couplings of any size
  non_normal,  // couplings a million times larger one way than back
  gyroscopic,  // antisymmetric damping, with and without a damped part
  circulatory,  // unsymmetric stiffness
  stiff,  // internal damping: decay up to hundreds of the crank's speed
  undamped,  // on the imaginary axis, or off it in tongues
  strong,  // modulation beyond the mean
  crowded,  // four to six modes within a few frequencies
  shifted,  // two resonant with what modulates them, not by their means; couplings down to a trace one way
};
constexpr std::array names = {"random",      "twins", "tongue",   "defective", "one-way", "non-normal", "gyroscopic",
                              "circulatory", "stiff", "undamped", "strong",    "crowded", "shifted"};
constexpr int num_families = int(names.size());

struct Case {
  HillSystem system;
  double speed = 1;
};

// The same case for the same family and number, on every machine.
[[nodiscard]] Case random_case(Family family, std::uint64_t number);

// How many times its error a bar may be at the median.
[[nodiscard]] constexpr double allowed_median(Family family) {
  const bool ill_conditioned = family == Family::defective || family == Family::non_normal ||
                               family == Family::tongue || family == Family::shifted;
  return ill_conditioned ? 1000 : 30;
}

}  // namespace hb::attack
