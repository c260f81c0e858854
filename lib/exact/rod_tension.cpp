#include "lib/exact/rod_tension.hpp"

#include "lib/exact/bent_rod.hpp"

namespace hb {

using Eigen::Index;

std::vector<TensionRange> rod_tensions(const ExactModel& model, double speed, const CrankAngles& angles,
                                       const RitzSamples& motion) {
  const ExactModel::Forces all = model.forces(speed, angles, motion);
  const std::complex<double> gravity(0, model.linkage().gravity);
  std::vector<TensionRange> result;
  for (std::size_t r = 0; r < model.rods().size(); ++r) {
    const int link = model.rods()[r].link;
    const auto body = static_cast<std::size_t>(link), dyad = (body - 1) / 2;
    // Joint 1 of a rocker is its coupler's: what acts on it there is the reaction.
    const double sign = link == coupler_index(static_cast<int>(dyad)) ? 1 : -1;
    exact::RodSurroundings at;
    at.base.resize(6, angles.size());
    at.axial_force.resize(angles.size());
    exact::Angles Y(angles.size());
    for (Index j = 0; j < angles.size(); ++j) {
      const auto angle = static_cast<std::size_t>(j);
      const BodyMotion& m = all.motion[angle][body];
      const std::complex<double> to_chord = std::conj(m.e), v = to_chord * m.z1, a = to_chord * (m.z2 + gravity),
                                 end = sign * to_chord * all.forces[angle].dyads[dyad].joint1;
      at.base.col(j) << v.real(), v.imag(), a.real(), a.imag(), m.phi1, m.phi2;
      at.axial_force(j) = end.real();
      Y(j) = end.imag();
    }
    const Body& rod = *body_at(model.linkage(), link);
    const Index first = model.first_mode(r), I = model.rods()[r].num_modes;
    const RodQuadrature rule(rod.length, I);
    const exact::RodConstants constants = exact::constants_of(rod);
    const exact::BentRod bent(rule, constants, motion.q.middleRows(first, I), motion.q1.middleRows(first, I),
                              motion.q2.middleRows(first, I));
    const exact::Field N = bent.tension(at, Y);
    result.push_back({N.minCoeff(), N.maxCoeff()});
  }
  return result;
}

}  // namespace hb
