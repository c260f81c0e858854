// The independent model (tests/newton_euler.hpp) on the six-link mechanism's reference numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "lib/constants.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/linkage/linkage.hpp"
#include "tests/support/newton_euler.hpp"

namespace hb {
namespace {

using Complex = std::complex<double>;
Body rod(const std::string& name, double length, double mass, double area, double J) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = mass;
  body.com = length / 2;
  body.elastic = Elastic{21e7, area, J, mass / (length * area), 1e-4, 1e-6, 1e-6};
  body.inertia = mass * length * length / 12 + body.elastic->density * J * length;
  return body;
}

Body rocker(const std::string& name, double length, double mass, Complex com, double inertia_pivot) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = mass;
  body.com = com;
  body.inertia = inertia_pivot - mass * std::norm(com);
  return body;
}

// mm, kg, s; second moment J of both rods.
Linkage six_link(double J) {
  const Complex C = std::polar(200.0, -0.3);
  Linkage linkage;
  linkage.gravity = 9810;
  linkage.crank.body.name = "crank";
  linkage.crank.body.length = 55;
  Rocker O2BC{rocker("O2BC", 200, 1.84, std::polar(118.0, -0.15), 18300), {270, 0}};
  O2BC.body.points["C"] = C;
  const Rocker O3D{rocker("O3D", 220, 1.35, 113, 11500), {570, 0}};
  const auto hang = [&](int body, Complex point, Body coupler, Rocker closing) {
    Dyad& dyad = linkage.dyads.emplace_back();
    dyad.on.body = body;
    dyad.on.point = point;
    dyad.coupler = std::move(coupler);
    dyad.closing = std::move(closing);
    dyad.branch = -1;
  };
  hang(0, 55, rod("AB", 259, 0.165, 10, J), std::move(O2BC));
  hang(2, C, rod("CD", 258, 0.163, 9, J), O3D);
  return linkage;
}

// The reference's extrema are those on 8192 crank angles.
Eigen::RowVectorXd on_reference_angles(const FourierSeries& series, Eigen::Index component) {
  return fourier::synthesise(FourierSeries(series.c.row(component)), 8192);
}

class SixLink : public testing::TestWithParam<int> {};

TEST_P(SixLink, ReferenceNumbersAreThoseOfPositionsAlone) {
  std::ifstream file(HB_SOURCE_DIR "/tests/reference/six_link.json");
  const nlohmann::json reference = nlohmann::json::parse(file)["cases"][static_cast<std::size_t>(GetParam())];
  const Linkage linkage = six_link(reference["J"]);
  const double speed = reference["rpm"].get<double>() * 2 * pi / 60;
  const Eigen::Index I = reference["modes"];
  constexpr Eigen::Index H = 32;
  constexpr Eigen::Index N = 2 * H + 1;

  std::vector<LinkResponse> responses;
  for (const int link : {1, 3}) {
    const auto& expected = reference["rods"][body_name(linkage, link)];
    const FourierSeries q = newton_euler::steady_state(linkage, link, speed, I, H);
    for (Eigen::Index i = 0; i < I; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const double size = expected["max_abs_q"][row];
      EXPECT_NEAR(on_reference_angles(q, i).cwiseAbs().maxCoeff(), size, 1e-9 * size);
      for (Eigen::Index n = 0; n <= 10; ++n) {
        const auto& c = expected["fourier"][row][static_cast<std::size_t>(n)];
        EXPECT_LE(std::abs(q.c(i, n) - Complex(c[0], c[1])), 1e-9 * size) << i + 1 << ' ' << n;
      }
    }
    Eigen::MatrixXd C11(1, N);
    for (Eigen::Index j = 0; j < N; ++j)
      C11(0, j) = newton_euler::ritz(linkage, link, 2 * pi * static_cast<double>(j) / N, speed, 1).stiffness(0, 0);
    const FourierSeries series = fourier::analyse(C11);
    for (Eigen::Index n = 0; n <= 10; ++n) {
      const auto& c = expected["stiffness_11_fourier"][static_cast<std::size_t>(n)];
      EXPECT_LE(std::abs(series.c(0, n) - Complex(c[0], c[1])), 1e-10 * std::abs(series.c(0, 0))) << n;
    }
    responses.push_back({link, q});
  }

  std::map<std::string, Eigen::MatrixXd> samples, samples_rigid;
  Eigen::MatrixXd torque(2, N);
  for (Eigen::Index j = 0; j < N; ++j) {
    const double tau = 2 * pi * static_cast<double>(j) / N;
    const MechanismForces rigid = newton_euler::forces(linkage, tau, speed);
    const MechanismForces elastic = newton_euler::forces(linkage, tau, speed, responses);
    const auto put = [&](const MechanismForces& forces, std::map<std::string, Eigen::MatrixXd>& into) {
      for (const auto& [name, values] : newton_euler::joint_components(linkage, tau, forces)) {
        Eigen::MatrixXd& rows = into.try_emplace(name, 2, N).first->second;
        rows.col(j) << values[0], values[1];
      }
    };
    put(rigid, samples_rigid);
    put(elastic, samples);
    torque.col(j) << rigid.torque, elastic.torque;
  }
  const auto expect_range = [](const Eigen::MatrixXd& rows, Eigen::Index row, const nlohmann::json& expected) {
    const Eigen::RowVectorXd turn = on_reference_angles(fourier::analyse(rows), row);
    const double size = std::max(std::abs(expected[0].get<double>()), std::abs(expected[1].get<double>()));
    EXPECT_NEAR(turn.minCoeff(), expected[0].get<double>(), 1e-9 * size);
    EXPECT_NEAR(turn.maxCoeff(), expected[1].get<double>(), 1e-9 * size);
  };
  for (const auto& [name, expected] : reference["joints"].items()) {
    SCOPED_TRACE(name);
    expect_range(samples_rigid.at(name), 0, expected["x_rigid"]);
    expect_range(samples_rigid.at(name), 1, expected["y_rigid"]);
    expect_range(samples.at(name), 0, expected["x"]);
    expect_range(samples.at(name), 1, expected["y"]);
  }
  expect_range(torque, 0, reference["torque"]["rigid"]);
  expect_range(torque, 1, reference["torque"]["elastic"]);
}

INSTANTIATE_TEST_SUITE_P(AllCases, SixLink, testing::Range(0, 7));

}  // namespace
}  // namespace hb
