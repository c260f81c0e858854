#include "lib/exact/rod_tension.hpp"

#include "lib/exact/bent_rod.hpp"

namespace hb {

using Eigen::Index;

// Barycentric interpolation, p(x) = sum w_k N_k/(x - x_k) / sum w_k/(x - x_k), w_k = 1/prod_{j != k} (x_k - x_j);
// distances in quarters of the length, for which the products neither over- nor underflow.
Eigen::MatrixXd RodTension::at(const Eigen::Ref<const Eigen::VectorXd>& places) const {
  const Index n = x.size();
  const double unit = x.maxCoeff() / 4;
  Eigen::VectorXd weight(n);
  for (Index k = 0; k < n; ++k) {
    double product = 1;
    for (Index j = 0; j < n; ++j)
      if (j != k) product *= (x(k) - x(j)) / unit;
    weight(k) = 1 / product;
  }
  Eigen::MatrixXd result(places.size(), N.cols());
  for (Index i = 0; i < places.size(); ++i) {
    const Eigen::VectorXd distance = (places(i) - x.array()).matrix() / unit;
    Index nearest = 0;
    if (distance.cwiseAbs().minCoeff(&nearest) == 0) {
      result.row(i) = N.row(nearest);
      continue;
    }
    const Eigen::VectorXd share = weight.cwiseQuotient(distance);
    result.row(i) = share.transpose() * N / share.sum();
  }
  return result;
}

std::vector<RodTension> rod_tensions(const ExactModel& model, double speed, const CrankAngles& angles,
                                     const RitzSamples& motion) {
  const ExactModel::Forces all = model.forces(speed, angles, motion);
  const std::complex<double> gravity(0, model.linkage().gravity);
  std::vector<RodTension> result;
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
    RodTension tension{Eigen::VectorXd(rule.num_points() + 2), bent.tension(at, Y).matrix()};
    tension.x << rule.x, 0, rod.length;
    result.push_back(std::move(tension));
  }
  return result;
}

}  // namespace hb
