#include "tools/attack/lines.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "lib/rod/rod.hpp"
#include "tests/support/band_systems.hpp"
#include "tests/support/random_linkage.hpp"

namespace hb::attack {

namespace {

using stress::BandKind;
using stress::Random;

constexpr std::array kinds = {BandKind::nearly_conservative, BandKind::undamped, BandKind::one_way,
                              BandKind::gyroscopic, BandKind::partly_driven};
constexpr std::array families = {stress::Family::plain,       stress::Family::full_matrices, stress::Family::tongue,
                                 stress::Family::combination, stress::Family::unsymmetric,   stress::Family::strong,
                                 stress::Family::alike,       stress::Family::sparse};
constexpr std::array line_names = {"nearly-conservative",
                                   "undamped",
                                   "one-way",
                                   "gyroscopic",
                                   "partly-driven",
                                   "plain",
                                   "full-matrices",
                                   "tongue",
                                   "combination",
                                   "unsymmetric",
                                   "strong",
                                   "alike",
                                   "sparse",
                                   "modulation",
                                   "linkages",
                                   "circulatory"};
// The number of a family is part of its lines' random numbers.
constexpr std::size_t linkages = 14, circulatory = 15;
static_assert(line_names.size() == num_line_families);

Line along_the_speed(const HillSystem& system, double from, double to) {
  return {
      .name = {}, .family = scene_of(system), .path = "omega", .from = from, .to = to, .rods = {[system](double x) {
                                                                                         return SystemOnLine{system, x};
                                                                                       }}};
}

HillSystem with_modulation(HillSystem system, double factor) {
  FourierSeries& series = system.stiffness[0];
  series.c.rightCols(series.c.cols() - 1) *= factor;
  return system;
}

// At a fixed speed all harmonics of the stiffness times x.
Line along_the_modulation(const HillSystem& system, double speed, double most) {
  return {.name = {},
          .family = SceneFamily({{"x", 1}}, [system](const auto& v) { return with_modulation(system, v[0]); }),
          .path = "x",
          .speed = speed,
          .from = 0.01 * most,
          .to = most,
          .rods = {[system, speed](double x) {
            return SystemOnLine{with_modulation(system, x), speed};
          }}};
}

Line along_a_linkage(std::uint64_t number) {
  constexpr int modes = 3;
  const RandomLinkage linkage = random_linkages(1, 7919 * number + 3, {0.3, 1}).front();
  Line line{.name = {},
            .family = scene_of(linkage.linkage),
            .path = "omega",
            .num_modes = modes,
            .from = 0.7 * linkage.speed,
            .to = 2 * linkage.speed,
            .rods = {}};
  const LinkageCoefficients coefficients = linkage_coefficients(linkage.linkage);
  for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
    const HillSystem system =
        ritz_system(*body_at(linkage.linkage, coefficients.links[r]), coefficients.rods[r], modes);
    line.rods.push_back([system](double x) { return SystemOnLine{system, x}; });
  }
  return line;
}

}  // namespace

const char* line_family(int family) { return line_names.at(std::size_t(family)); }

Line random_line(int family, std::uint64_t number) {
  Random random(number * 1000003 + std::uint64_t(family) * 7919 + 2);
  const auto f = std::size_t(family);
  const auto line = [&]() -> Line {
    if (f < kinds.size()) {
      const HillSystem system = stress::band_system(kinds[f], random);
      const double from = random(0.4, 1.5);
      return along_the_speed(system, from, from * random(1.3, 4));
    }
    if (f < kinds.size() + families.size()) {
      const stress::Trial trial = stress::random_trial(families[f - kinds.size()], random, 3);
      const double from = trial.speed * random(0.4, 0.9);
      return along_the_speed(trial.system, from, from * random(1.3, 3));
    }
    if (f == linkages) return along_a_linkage(number);
    if (f == circulatory) {
      const HillSystem system = stress::band_system(BandKind::circulatory, random);
      const double from = random(0.4, 1.5);
      return along_the_speed(system, from, from * random(1.3, 4));
    }
    const HillSystem system = stress::band_system(kinds[std::size_t(random.integer(0, 4))], random);
    return along_the_modulation(system, random(0.4, 3), random.power(0, 1));
  };
  Line result = line();
  result.name = std::string(line_family(family)) + " " + std::to_string(number);
  return result;
}

}  // namespace hb::attack
