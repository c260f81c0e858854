// Table 1 of the 1997 paper in three readings: the derived model with J = 4500 mm^4 (as printed) and J = 45 mm^4, and
// J = 45 mm^4 with the sign of f1 reversed in the load h and in the axial force, which is what the paper's numbers
// show. Usage: table_1 SCENE, with SCENE the six-link mechanism.
#include <fmt/core.h>

#include <array>
#include <complex>
#include <exception>
#include <numbers>
#include <string>
#include <vector>

#include "hb/engine/steady/steady_state.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/linkage/linkage.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"

namespace {

using RodSamples = std::array<Eigen::MatrixXd, 3>;  // f^(p), 5 x N

// f0..f4 with f1 -> -f1. The forces on a rod that come from f1, EJ f1 l^2/2 across it and EJ f1 l^3/3 about its joint
// 0, change sign before the joint forces are balanced: that reverses f1 in the axial forces of this rod and of the rods
// before it.
std::vector<hb::RodCoefficients> reversed_coefficients(const hb::Linkage& linkage) {
  constexpr int N = 128;
  const std::vector<int> links = hb::elastic_links(linkage);
  std::vector<RodSamples> samples(links.size(), {Eigen::MatrixXd(5, N), Eigen::MatrixXd(5, N), Eigen::MatrixXd(5, N)});
  for (int j = 0; j < N; ++j) {
    const double tau = 2 * std::numbers::pi * j / N;
    const std::vector<hb::BodyMotion> motion = hb::motion_at(linkage, tau);
    std::array<std::vector<hb::BodyLoad>, 3> loads = hb::rigid_loads(linkage, motion, tau);
    const std::array<hb::MechanismForces, 3> forces = {hb::balance(linkage, motion, loads[0]),
                                                       hb::balance(linkage, motion, loads[1]),
                                                       hb::balance(linkage, motion, loads[2])};
    for (const int link : links) {
      const hb::Body& body = *hb::body_at(linkage, link);
      const double EJ = body.elastic->youngs_modulus * body.elastic->second_moment;
      const double l = body.length;
      const Eigen::Matrix<double, 5, 3> f = hb::rod_coefficients_at(linkage, motion, forces, link);
      for (int p = 0; p < 3; ++p) {
        const double f1 = f(1, p);
        loads[p][link].force -= 2 * EJ * f1 * l * l / 2 * std::complex<double>(0, 1) * motion[link].e;
        loads[p][link].moment -= 2 * EJ * f1 * l * l * l / 3;
      }
    }
    const std::array<hb::MechanismForces, 3> reversed = {hb::balance(linkage, motion, loads[0]),
                                                         hb::balance(linkage, motion, loads[1]),
                                                         hb::balance(linkage, motion, loads[2])};
    for (std::size_t r = 0; r < links.size(); ++r) {
      Eigen::Matrix<double, 5, 3> f = hb::rod_coefficients_at(linkage, motion, reversed, links[r]);
      f.row(1) = -f.row(1);
      for (int p = 0; p < 3; ++p) samples[r][p].col(j) = f.col(p);
    }
  }
  std::vector<hb::RodCoefficients> rods(links.size());
  for (std::size_t r = 0; r < links.size(); ++r)
    for (int p = 0; p < 3; ++p) rods[r].f[p] = hb::fourier::analyse(samples[r][p]);
  return rods;
}

void print_row(const hb::Linkage& linkage, int link, const hb::RodCoefficients& rod, double speed, int num_modes,
               const std::string& reading) {
  const hb::Body& body = *hb::body_at(linkage, link);
  const hb::SteadyState steady = hb::solve_steady_state(hb::ritz_system(body, rod, num_modes), speed);
  if (steady.status != hb::SteadyStatus::converged) throw std::runtime_error("no steady state: " + reading);
  fmt::print("{},{},{}", reading, body.name, num_modes);
  for (int i = 0; i < 5; ++i) {
    fmt::print(",");
    if (i < num_modes) fmt::print("{:.9g}", hb::fourier::max_abs(steady.q, i).value);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    fmt::print(stderr, "usage: table_1 SCENE\n");
    return 2;
  }
  fmt::print("reading,rod,I,max_abs_q1 (mm),max_abs_q2 (mm),max_abs_q3 (mm),max_abs_q4 (mm),max_abs_q5 (mm)\n");
  for (const char* J : {"4500", "45"}) {
    const hb::Scene scene = hb::read_scene(argv[1], {{"*.J", J}});
    const auto& linkage = std::get<hb::Linkage>(scene.model);
    const double speed = hb::speed_from_rpm(300, scene.units);
    const hb::LinkageCoefficients derived = hb::linkage_coefficients(linkage);
    for (std::size_t r = 0; r < derived.links.size(); ++r)
      for (const int I : {1, 5})
        print_row(linkage, derived.links[r], derived.rods[r], speed, I, fmt::format("J = {}", J));

    if (std::string(J) == "45") {
      const std::vector<hb::RodCoefficients> reversed = reversed_coefficients(linkage);
      for (std::size_t r = 0; r < reversed.size(); ++r)
        for (const int I : {1, 5})
          print_row(linkage, derived.links[r], reversed[r], speed, I, fmt::format("J = {}; f1 reversed", J));
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "table_1: {}\n", error.what());
  return 1;
}
