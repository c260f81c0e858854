// Random valid linkages of every kind, same on every machine, for tests.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "lib/linkage/linkage.hpp"

namespace hb {

// Uniform numbers that do not depend on the standard library's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double from, double to) { return from + (to - from) * 0x1p-53 * static_cast<double>(engine_() >> 11); }
  double log_uniform(double from, double to);
  int sign() { return uniform(-1, 1) < 0 ? -1 : 1; }
  int below(int n) { return static_cast<int>(uniform(0, n)); }

 private:
  std::mt19937_64 engine_;
};

struct RandomLinkage {
  std::string kind;
  Linkage linkage;
  double speed = 0;  // rad per unit time, at which gravity, inertia, damping and stiffness all matter
};

// `count` linkages: four-bars with elastic coupler, rocker or both, slider-cranks, six- and eight-link mechanisms,
// dyads on rockers, rigid couplers and sliders, two dyads on one crank, and free chains of up to six dyads. Some bodies
// have no mass, some rods no damping, some linkages no gravity. All turn freely; the smallest closing_margin over the
// turn lies in `margins`.
struct Margins {
  double from = 0.25, to = 1;
};
[[nodiscard]] std::vector<RandomLinkage> random_linkages(int count, std::uint64_t seed, const Margins& margins = {});

// Smooth random periodic deflection of one elastic link, about a twentieth of its length.
[[nodiscard]] FourierSeries random_deflection(const Body& link, Eigen::Index num_modes, Random& random);

}  // namespace hb
