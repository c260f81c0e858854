#include "lib/rod/time_domain_rod.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lib/rod/rod.hpp"
#include "tests/support/random_linkage.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

constexpr double turn = 2 * std::numbers::pi;

struct Difference {
  double stiffness = 0, load = 0;  // largest over the turn, relative to the largest
};

Difference difference(const HillSystem& hill, const TimeDomainSystem& direct) {
  const TimeDomainSystem series = time_domain_system(hill, direct.speed);
  const Eigen::Index I = hill.num_modes();
  Eigen::MatrixXd C(I, I), C0(I, I);
  Eigen::VectorXd h(I), h0(I);
  double C_size = 0, h_size = 0;
  Difference largest;
  for (int j = 0; j < 37; ++j) {
    series.evaluate(turn * j / 37, C, h);
    direct.evaluate(turn * j / 37, C0, h0);
    C_size = std::max(C_size, C0.cwiseAbs().maxCoeff());
    h_size = std::max(h_size, h0.cwiseAbs().maxCoeff());
    largest.stiffness = std::max(largest.stiffness, (C - C0).cwiseAbs().maxCoeff());
    largest.load = std::max(largest.load, (h - h0).cwiseAbs().maxCoeff());
  }
  largest.stiffness /= C_size;
  if (h_size > 0) largest.load /= h_size;
  return largest;
}

TEST(TimeDomainRod, AgreesWithTheFourierPathOnRandomLinkages) {
  for (const RandomLinkage& random : random_linkages(40, 11)) {
    SCOPED_TRACE(random.kind);
    const LinkageCoefficients coefficients = linkage_coefficients(random.linkage);
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const Body& link = *body_at(random.linkage, coefficients.links[r]);
      const HillSystem hill = ritz_system(link, coefficients.rods[r], 4);
      const TimeDomainSystem direct = time_domain_rod(random.linkage, coefficients.links[r], 4, random.speed);
      EXPECT_LE((hill.mass - direct.mass).norm(), 1e-13 * hill.mass.norm());
      EXPECT_LE((hill.damping - direct.damping).norm(), 1e-13 * hill.damping.norm());
      const Difference d = difference(hill, direct);
      EXPECT_LE(d.stiffness, 1e-11);
      EXPECT_LE(d.load, 1e-11);
    }
  }
}

TEST(TimeDomainRod, SixtyModesKeepTheirDigits) {
  const Linkage linkage = six_link::linkage();
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const HillSystem hill = ritz_system(*body_at(linkage, 1), coefficients.rods[0], 60);
  const TimeDomainSystem direct = time_domain_rod(linkage, 1, 60, 157.0);
  const TimeDomainSystem series = time_domain_system(hill, 157.0);
  Eigen::MatrixXd C(60, 60), C0(60, 60);
  Eigen::VectorXd h(60), h0(60);
  for (const double tau : {0.3, 2.0, 5.1}) {
    series.evaluate(tau, C, h);
    direct.evaluate(tau, C0, h0);
    for (Eigen::Index i = 0; i < 60; ++i)
      for (Eigen::Index k = 0; k < 60; ++k)
        EXPECT_LE(std::abs(C(i, k) - C0(i, k)), 1e-12 * std::sqrt(std::abs(C0(i, i) * C0(k, k)))) << i << " " << k;
    EXPECT_LE((h - h0).norm(), 1e-12 * h0.norm());
  }
}

// Every component of f_k in every power of Omega that is there, changed by one part in 1e6.
TEST(TimeDomainRod, AnErrorInAnyTermOfTheFourierPathShows) {
  six_link::Options options;
  options.external_damping = 1e-3;  // large enough for the terms linear in Omega to be seen
  const Linkage linkage = six_link::linkage(options);
  const double speed = 2 * std::numbers::pi * 1500 / 60;
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  for (std::size_t r = 0; r < 2; ++r) {
    const int link = coefficients.links[r];
    const Body& body = *body_at(linkage, link);
    const TimeDomainSystem direct = time_domain_rod(linkage, link, 3, speed);
    const Difference correct = difference(ritz_system(body, coefficients.rods[r], 3), direct);
    EXPECT_LE(std::max(correct.stiffness, correct.load), 1e-12);
    int injected = 0;
    for (std::size_t power = 0; power < 3; ++power)
      for (Eigen::Index k = 0; k < coefficients.rods[r].f[power].c.rows(); ++k) {
        RodCoefficients wrong = coefficients.rods[r];
        if (wrong.f[power].c.row(k).isZero(0)) continue;
        wrong.f[power].c.row(k) *= 1 + 1e-6;
        const Difference d = difference(ritz_system(body, wrong, 3), direct);
        EXPECT_GT(std::max(d.stiffness, d.load), 100 * std::max(correct.stiffness, correct.load))
            << "f" << k << " in power " << power;
        ++injected;
      }
    EXPECT_GE(injected, 10);
  }
}

TEST(TimeDomainRod, JointForcesAgreeWithTheDyadPathOnRandomLinkages) {
  Random random_numbers(5);
  for (const RandomLinkage& random : random_linkages(25, 12)) {
    SCOPED_TRACE(random.kind);
    std::vector<LinkResponse> responses;
    for (const int link : elastic_links(random.linkage))
      responses.push_back({link, random_deflection(*body_at(random.linkage, link), 3, random_numbers)});
    const JointForces series = joint_forces(random.linkage, random.speed, responses);
    const std::vector<ForceLabel> labels = force_labels(random.linkage);
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(labels.size()));
    Eigen::VectorXd difference = largest;
    for (int j = 0; j < 11; ++j) {
      const double tau = turn * j / 11;
      std::vector<LinkDeflection> deflections;
      for (const LinkResponse& response : responses)
        deflections.push_back({response.link, fourier::evaluate(response.q, tau),
                               fourier::evaluate(fourier::derivative(response.q), tau),
                               fourier::evaluate(fourier::derivative(response.q, 2), tau)});
      const Eigen::VectorXd direct = joint_forces_at(random.linkage, random.speed, tau, deflections);
      ASSERT_EQ(direct.size(), largest.size());
      for (std::size_t k = 0; k < labels.size(); ++k) {
        double other = NAN;
        if (labels[k].joint == "torque") {
          other = fourier::evaluate(series.torque, tau)(0);
        } else {
          for (const JointForce& joint : series.joints)
            if (joint.name == labels[k].joint)
              other = fourier::evaluate(joint.elastic, tau)(labels[k].component == "y" ? 1 : 0);
        }
        const auto i = static_cast<Eigen::Index>(k);
        ASSERT_TRUE(std::isfinite(other)) << labels[k].joint;
        largest(i) = std::max(largest(i), std::abs(direct(i)));
        difference(i) = std::max(difference(i), std::abs(direct(i) - other));
      }
    }
    const double size = largest.head(largest.size() - 1).maxCoeff();
    for (std::size_t k = 0; k < labels.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double scale =
          labels[k].joint == "torque" ? std::max(largest(i), size * random.linkage.crank.body.length) : size;
      EXPECT_LE(difference(i), 1e-10 * scale) << labels[k].joint << " " << labels[k].component;
    }
  }
}

}  // namespace
}  // namespace hb
