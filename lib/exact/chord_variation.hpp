// What the mechanism answers when the chord of one bent link is varied, and the speed. Used inside the library.
#pragma once

#include <vector>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/exact/dual.hpp"

namespace hb::exact {

// Directions: c, c_t, c_tt of the link, and the speed where asked for. Positions z(c, tau), the crank's speed constant,
// make
//     dz_t/dc_t = dz/dc,   dz_tt/dc_t = 2 dz_t/dc,   dz_tt/dc_tt = dz/dc,
// so that the closure is differentiated by c and the speed alone. Scratch is kept from one call to the next.
template <bool by_speed>
class ChordVariation {
  using Moved = Dual<by_speed ? 2 : 1>;

 public:
  using Varied = Dual<by_speed ? 4 : 3>;

  // Of all rods, those of `mechanism` with rod s varied: rods()[r].base and .axial_force are the answers.
  template <class SliderForces>
  void vary(const Linkage& linkage, const std::vector<int>& rod_of, const std::vector<RodConstants>& constants,
            const SliderForces& slider_forces, const Plane<Lanes>& crank, const Lanes& speed,
            const BentMechanism<Lanes>& mechanism, std::size_t s) {
    const std::size_t count = mechanism.rods.size();
    moved_.rods.resize(count);
    varied_.rods.resize(count);
    for (std::size_t r = 0; r < count; ++r) {
      const Chord<Lanes>& chord = mechanism.rods[r].chord;
      moved_.rods[r].chord = {chord.c, chord.c1, chord.c2};
      varied_.rods[r].chord = {chord.c, chord.c1, chord.c2};
      varied_.rods[r].shape = mechanism.rods[r].shape;
    }
    moved_.rods[s].chord.c.slope[0] = 1;
    Chord<Varied>& own = varied_.rods[s].chord;
    own.c.slope[0] = own.c1.slope[1] = own.c2.slope[2] = 1;
    Moved varied_speed(speed);
    if constexpr (by_speed) varied_speed.slope[1] = 1;
    move(linkage, rod_of, crank, varied_speed, moved_);
    varied_.motion.resize(moved_.motion.size());
    for (std::size_t body = 0; body < moved_.motion.size(); ++body)
      varied_.motion[body] = by_rates(moved_.motion[body]);
    load(linkage, rod_of, constants, slider_forces, varied_);
    balance(linkage, rod_of, varied_);
  }

  const std::vector<RodState<Varied>>& rods() const { return varied_.rods; }

 private:
  // value with its slopes by c, c_t, c_tt; the speed's as in `moved`.
  static Varied with(const Moved& moved, const Lanes& by_c1, const Lanes& by_c2) {
    Varied all(moved.value);
    all.slope[0] = moved.slope[0];
    all.slope[1] = by_c1;
    all.slope[2] = by_c2;
    if constexpr (by_speed) all.slope[3] = moved.slope[1];
    return all;
  }
  static Plane<Varied> position(const Plane<Moved>& z) { return {with(z.x, 0, 0), with(z.y, 0, 0)}; }
  static Plane<Varied> rate(const Plane<Moved>& z, const Plane<Moved>& z1) {
    return {with(z1.x, z.x.slope[0], 0), with(z1.y, z.y.slope[0], 0)};
  }
  static Varied acceleration(const Lanes& by_c, const Moved& first, const Moved& second) {
    return with(second, 2 * first.slope[0], by_c);
  }

  static BentMotion<Varied> by_rates(const BentMotion<Moved>& m) {
    const Lanes phi = m.e.x.value * m.e.y.slope[0] - m.e.y.value * m.e.x.slope[0];  // by c
    BentMotion<Varied> all;
    all.z = position(m.z);
    all.z1 = rate(m.z, m.z1);
    all.z2 = {acceleration(m.z.x.slope[0], m.z1.x, m.z2.x), acceleration(m.z.y.slope[0], m.z1.y, m.z2.y)};
    all.e = position(m.e);
    all.phi1 = with(m.phi1, phi, 0);
    all.phi2 = acceleration(phi, m.phi1, m.phi2);
    return all;
  }

  BentMechanism<Moved> moved_;
  BentMechanism<Varied> varied_;
};

}  // namespace hb::exact
