#include "lib/rod/rod.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/fourier/turn_sampling.hpp"
#include "lib/linkage/balance.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;
constexpr Eigen::Index often = 256;  // crank angles or harmonics between two looks at the wish to stop

// Axial force on a link at its joint 1, tension positive.
double axial_force(const std::vector<BodyMotion>& motion, const MechanismForces& forces, int link) {
  const Complex on_coupler = forces.dyads[at((link - 1) / 2)].joint1;
  const Complex on_link = link % 2 == 1 ? on_coupler : -on_coupler;
  return (std::conj(motion[at(link)].e) * on_link).real();
}

// lib/README.md (S4) to (S6): of both modes of every term, from the axial force's stiffness A and the load on q = a +
// b,
//     M = diag(m_a, m_b),  B = alpha_c diag(c_a, c_b) + c_y/EJ [1 1; 1 1],  C = diag(c_a, c_b) + [A A; A A],  h = (h,
//     h).
void add_shear(const Body& link, HillSystem& system) {
  const Eigen::Index I = system.num_modes(), n = num_unknowns(link, I);
  const Elastic& elastic = *link.elastic;
  const RestModes modes = rest_modes(link, I);
  Eigen::VectorXd stiffness(n), mass(n);
  for (Eigen::Index first = 0; first < n; first += I) {
    stiffness.segment(first, I) = modes.stiffness[first == 0 ? 0 : 1];
    mass.segment(first, I) = modes.mass[first == 0 ? 0 : 1];
  }
  system.mass = mass.asDiagonal();
  const Eigen::MatrixXd same_term = Eigen::MatrixXd::Identity(I, I).replicate(n / I, n / I);
  system.damping = Eigen::MatrixXd((elastic.internal_damping * stiffness).asDiagonal()) +
                   elastic.damping_y / (elastic.youngs_modulus * elastic.second_moment) * same_term;
  for (std::size_t p = 0; p < 3; ++p) {
    const Eigen::MatrixXcd A = system.stiffness[p].c;
    if (A.size() == 0) continue;
    Eigen::MatrixXcd c(n * n, A.cols());
    for (Eigen::Index k = 0; k < n; ++k)
      for (Eigen::Index row = 0; row < n; row += I) c.middleRows(row + n * k, I) = A.middleRows(I * (k % I), I);
    system.stiffness[p] = FourierSeries(std::move(c));
    system.load[p] = on_unknowns(system.load[p], n);
  }
  for (Eigen::Index k = 0; k < n; ++k) system.stiffness[0].c(k + n * k, 0) += stiffness(k);
}

}  // namespace

// lib/README.md (M4):
// f0 = mu/EJ (g cos phi + a0y) + c_y/EJ v0y       f1 = mu/EJ phi_tt + c_y/EJ phi_t       f2 = mu/EJ phi_t^2
// f3 = mu/EJ (g sin phi + a0x) + c_x/EJ v0x       f4 = X/EJ - f3 l + f2 l^2/2
Eigen::Matrix<double, 5, 3> rod_coefficients_at(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                                                const std::array<MechanismForces, 3>& forces, int link) {
  const Body& body = *body_at(linkage, link);
  const Elastic& elastic = *body.elastic;
  const BodyMotion& m = motion[at(link)];
  const double l = body.length, EJ = elastic.youngs_modulus * elastic.second_moment;
  const double mu_EJ = body.mass / l / EJ, g = linkage.gravity;
  const Complex v0 = std::conj(m.e) * m.z1, a0 = std::conj(m.e) * m.z2;

  Eigen::Matrix<double, 5, 3> f;
  f.row(0) << mu_EJ * g * m.e.real(), elastic.damping_y / EJ * v0.imag(), mu_EJ * a0.imag();
  f.row(1) << 0, elastic.damping_y / EJ * m.phi1, mu_EJ * m.phi2;
  f.row(2) << 0, 0, mu_EJ * m.phi1 * m.phi1;
  f.row(3) << mu_EJ * g * m.e.imag(), elastic.damping_x / EJ * v0.real(), mu_EJ * a0.real();
  for (int p = 0; p < 3; ++p)
    f(4, p) = axial_force(motion, forces[at(p)], link) / EJ - f(3, p) * l + f(2, p) * l * l / 2;
  return f;
}

// Sampled per crank angle: per link and power p the five f_k^(p), 15 rows per link. f0, l f1, l f2 and f3 are of one
// kind, f4 / l of its own (it carries the other links' loads).
LinkageCoefficients linkage_coefficients(const Linkage& linkage, double tolerance) {
  LinkageCoefficients result;
  result.links = elastic_links(linkage);
  if (result.links.empty()) return result;

  std::vector<TurnComponent> components;
  for (std::size_t i = 0; i < result.links.size(); ++i) {
    const double l = body_at(linkage, result.links[i])->length;
    for (int p = 0; p < 3; ++p) {
      const int group = 2 * (3 * static_cast<int>(i) + p);
      components.insert(components.end(), {{group, 1}, {group, l}, {group, l}, {group, 1}, {group + 1, 1 / l}});
    }
  }

  std::vector<BodyMotion> motion;
  std::array<std::vector<BodyLoad>, 3> loads;
  std::array<MechanismForces, 3> forces;
  const auto fill = [&](Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step) {
    const Eigen::Index N = samples.cols();
    const Eigen::MatrixXd slider_forces = slider_force_samples(linkage, N);
    for (Eigen::Index j = begin; j < N; j += step) {
      if (j % often == begin) end_if_wished();
      motion_at(linkage, 2 * pi * static_cast<double>(j) / static_cast<double>(N), motion);
      rigid_loads(linkage, motion, slider_forces.col(j), loads);
      for (std::size_t p = 0; p < 3; ++p) balance(linkage, motion, loads[p], forces[p]);
      for (std::size_t i = 0; i < result.links.size(); ++i) {
        const Eigen::Matrix<double, 5, 3> f = rod_coefficients_at(linkage, motion, forces, result.links[i]);
        samples.col(j).segment<15>(15 * static_cast<Eigen::Index>(i)) = f.reshaped();
      }
    }
  };
  TurnSamplingOptions options{.tolerance = tolerance};
  while (options.first < 2 * slider_force_harmonics(linkage) + 2) options.first *= 2;
  options.last = std::max(options.last, 2 * options.first);
  const TurnSeries turn = sample_turn(components, fill, options);

  result.num_samples = turn.num_samples;
  result.tail = turn.tail;
  result.resolved = turn.reached || turn.tail <= 1e-10;
  for (std::size_t i = 0; i < result.links.size(); ++i) {
    RodCoefficients& rod = result.rods.emplace_back();
    for (int p = 0; p < 3; ++p) rod.f[at(p)] = cut_rows(turn, 15 * static_cast<Eigen::Index>(i) + 5 * p, 5);
  }
  return result;
}

// lib/README.md (M5) to (M8):
// m_ii = (rho/E)(i pi/l)^2 + mu/EJ                b_ii = alpha_c (i pi/l)^4 + c_y/EJ
// c_ii = (i pi/l)^4 + (i pi/l)^2 f4 + i^2 pi^2/(2 l) f3 - (5/4 + i^2 pi^2/6) f2
// c_ik = -a_ik [ (2/l) f3 - f2 ]   i+k odd        c_ik = -a_ik f2   i+k even        a_ik = i k [1/(i-k)^2 + 1/(i+k)^2]
// h_i  = (2 l/(i pi)) f1           i even         h_i  = -(1/i)[ (4/pi) f0 + (2 l/pi) f1 ]     i odd
HillSystem ritz_system(const Body& link, const RodCoefficients& rod, Eigen::Index num_modes) {
  const Eigen::Index I = num_modes;
  const Elastic& elastic = *link.elastic;
  const double l = link.length, EJ = elastic.youngs_modulus * elastic.second_moment, mu = link.mass / l;
  const Eigen::ArrayXd i = Eigen::ArrayXd::LinSpaced(I, 1, static_cast<double>(I)), kappa = i * pi / l;

  HillSystem system;
  system.mass =
      Eigen::MatrixXd((elastic.density / elastic.youngs_modulus * kappa.square() + mu / EJ).matrix().asDiagonal());
  system.damping = Eigen::MatrixXd(
      (elastic.internal_damping * kappa.square().square() + elastic.damping_y / EJ).matrix().asDiagonal());

  for (std::size_t p = 0; p < 3; ++p) {
    const FourierSeries& f = rod.f[p];
    const bool zero = f.c.size() == 0 || (f.c.array() == Complex(0)).all();
    if (zero && p > 0) continue;
    const Eigen::Index H = zero ? 0 : f.num_harmonics();
    FourierSeries &C = system.stiffness[p], &h = system.load[p];
    C = FourierSeries(I * I, H);
    h = FourierSeries(I, H);
    for (Eigen::Index n = 0; n <= H && !zero; ++n) {
      if (n % often == 0) end_if_wished();
      const Complex f0 = f.c(0, n), f1 = f.c(1, n), f2 = f.c(2, n), f3 = f.c(3, n), f4 = f.c(4, n);
      const Complex odd_load = -(4 / pi * f0 + 2 * l / pi * f1), even_load = 2 * l / pi * f1;
      const Complex odd_coupling = 2 / l * f3 - f2;
      for (Eigen::Index k = 0; k < I; ++k) {
        for (Eigen::Index j = k + 1; j < I; ++j) {
          const double a = i(j) * i(k) * (1 / ((i(j) - i(k)) * (i(j) - i(k))) + 1 / ((i(j) + i(k)) * (i(j) + i(k))));
          C.c(j + I * k, n) = C.c(k + I * j, n) = -a * ((j + k) % 2 == 1 ? odd_coupling : f2);
        }
        const double square = i(k) * i(k) * pi * pi;
        C.c(k + I * k, n) = square / (l * l) * f4 + square / (2 * l) * f3 - (1.25 + square / 6) * f2;
        h.c(k, n) = (k % 2 == 0 ? odd_load : even_load) / i(k);
      }
    }
    if (p == 0 && !elastic.shear)
      for (Eigen::Index k = 0; k < I; ++k) C.c(k + I * k, 0) += std::pow(kappa(k), 4);
  }
  if (elastic.shear) add_shear(link, system);
  return system;
}

}  // namespace hb
