#include "lib/exact/rod_tension.hpp"

#include <algorithm>

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
    const Body& rod = *body_at(model.linkage(), link);
    const Index first = model.first_mode(r), I = model.rods()[r].num_modes, N = angles.size();
    const RodQuadrature rule(rod.length, I);
    const exact::RodConstants constants = exact::constants_of(rod);
    exact::BentRod bent(rule, constants);
    RodTension tension{Eigen::VectorXd(rule.num_points() + 2), Eigen::MatrixXd(rule.num_points() + 2, N)};
    tension.x << rule.x, 0, rod.length;
    for (Index j = 0; j < N; j += Lanes::width) {
      bent.bend(motion.q.middleRows(first, I), motion.q1.middleRows(first, I), motion.q2.middleRows(first, I), j);
      const auto lanes = [&](const auto& value) {
        return Lanes::of([&](Index lane) { return value(static_cast<std::size_t>(std::min(j + lane, N - 1))); });
      };
      const auto in_chord = [&](const auto& of) {
        const auto turned = [&](std::size_t angle) { return std::conj(all.motion[angle][body].e) * of(angle); };
        return Plane<Lanes>{lanes([&](std::size_t angle) { return turned(angle).real(); }),
                            lanes([&](std::size_t angle) { return turned(angle).imag(); })};
      };
      const auto v = in_chord([&](std::size_t angle) { return all.motion[angle][body].z1; });
      const auto a = in_chord([&](std::size_t angle) { return all.motion[angle][body].z2 + gravity; });
      const auto end = in_chord([&](std::size_t angle) { return sign * all.forces[angle].dyads[dyad].joint1; });
      bent.surround({v.x, v.y, a.x, a.y, lanes([&](std::size_t angle) { return all.motion[angle][body].phi1; }),
                     lanes([&](std::size_t angle) { return all.motion[angle][body].phi2; })},
                    end.x);
      const std::vector<Lanes> at_points = bent.tension(end.y);
      for (std::size_t k = 0; k < at_points.size(); ++k)
        for (Index lane = 0; lane < std::min(Lanes::width, N - j); ++lane)
          tension.N(static_cast<Index>(k), j + lane) = at_points[k].values()[static_cast<std::size_t>(lane)];
    }
    result.push_back(std::move(tension));
  }
  return result;
}

}  // namespace hb
