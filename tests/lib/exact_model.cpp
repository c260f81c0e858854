#include "lib/exact/exact_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "tests/support/bent_positions.hpp"
#include "tests/support/random_linkage.hpp"
#include "tests/support/six_link.hpp"
#include "tests/support/slider_crank.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
// All elastic links of a linkage with random bending of one to three modes: slopes of about 0.1.
struct Bent {
  ExactModel model;
  std::vector<LinkResponse> motion;

  std::vector<FourierSeries> q(double scale = 1) const {
    std::vector<FourierSeries> all;
    for (const LinkResponse& response : motion) all.emplace_back(scale * response.q.c);
    return all;
  }
};

Bent bent(const Linkage& linkage, Random& random, double scale = 0.3) {
  std::vector<ExactModel::Rod> rods;
  std::vector<LinkResponse> motion;
  for (const int link : elastic_links(linkage)) {
    const Index I = 1 + random.below(3);
    rods.push_back({link, I});
    FourierSeries q = random_deflection(*body_at(linkage, link), I, random);
    motion.push_back({link, FourierSeries(scale * q.c)});
  }
  return {ExactModel(linkage, rods), motion};
}

// Of every kind; sliders pushed by a periodic force.
std::vector<RandomLinkage> linkages(int count, std::uint64_t seed) {
  std::vector<RandomLinkage> all = random_linkages(count, seed);
  for (RandomLinkage& random : all)
    for (std::size_t d = 0; d < random.linkage.dyads.size(); ++d)
      if (auto* slider = std::get_if<Slider>(&random.linkage.dyads[d].closing)) {
        const Body& coupler = random.linkage.dyads[d].coupler;
        const double force = (coupler.mass + slider->mass) * coupler.length * random.speed * random.speed;
        slider->force = FourierSeries(1, 2);
        slider->force.c << 0.3 * force, std::complex(0.2 * force, -0.4 * force), 0.1 * force;
      }
  return all;
}

std::string label(const RandomLinkage& random, std::size_t number) {
  return "linkage " + std::to_string(number) + " (" + random.kind + ")";
}

// M q'' + B q' + C q - h of the linear model by its second route.
MatrixXd linear_residual(const ExactModel& model, double speed, const CrankAngles& angles, const RitzSamples& motion) {
  MatrixXd r(model.num_modes(), angles.size());
  for (std::size_t k = 0; k < model.rods().size(); ++k) {
    const auto [link, I] = model.rods()[k];
    const TimeDomainSystem system = time_domain_rod(model.linkage(), link, I, speed);
    MatrixXd C(I, I);
    Eigen::VectorXd h(I);
    const Index first = model.first_mode(k);
    for (Index j = 0; j < angles.size(); ++j) {
      system.evaluate(angles.tau(j), C, h);
      r.col(j).segment(first, I) = system.mass * motion.q2.col(j).segment(first, I) +
                                   system.damping * motion.q1.col(j).segment(first, I) +
                                   C * motion.q.col(j).segment(first, I) - h;
    }
  }
  return r;
}

TEST(ExactModel, IsTheLinearModelToSecondOrder) {
  Random random(31);
  const std::vector<RandomLinkage> all = linkages(30, 5);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const Bent rods = bent(all[k].linkage, random);
    const CrankAngles angles(all[k].linkage, 32);
    const auto difference = [&](double scale) -> MatrixXd {
      const RitzSamples motion = ritz_samples(rods.q(scale), all[k].speed, angles.size());
      return rods.model.residual(all[k].speed, angles, motion).r -
             linear_residual(rods.model, all[k].speed, angles, motion);
    };
    const RitzSamples none = ritz_samples(rods.q(0), all[k].speed, angles.size());
    const MatrixXd load = linear_residual(rods.model, all[k].speed, angles, none);
    EXPECT_LE(difference(0).norm(), 1e-12 * load.norm());
    // What is of even and of odd order in q, at a hundredth and at half of that.
    const MatrixXd plus = difference(1e-2), minus = difference(-1e-2);
    const MatrixXd half_plus = difference(5e-3), half_minus = difference(-5e-3);
    const double rounding =
        1e-12 *
        (load.norm() +
         linear_residual(rods.model, all[k].speed, angles, ritz_samples(rods.q(1e-2), all[k].speed, 32)).norm());
    EXPECT_LE((plus + minus - 4 * (half_plus + half_minus)).norm(), 1e-3 * (plus + minus).norm() + rounding);
    EXPECT_LE((plus - minus - 8 * (half_plus - half_minus)).norm(), 1e-3 * (plus - minus).norm() + rounding);
  }
}

TEST(ExactModel, IsTheVariationOfAnActionThatKnowsPositionsOnly) {
  Random random(7);
  const std::vector<RandomLinkage> all = linkages(17, 99);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const Linkage& linkage = all[k].linkage;
    const Bent rods = bent(linkage, random);
    const CrankAngles angles(linkage, 256);
    const MatrixXd r = rods.model.residual(all[k].speed, angles, ritz_samples(rods.q(), all[k].speed, angles.size())).r;
    for (std::size_t rod = 0; rod < rods.motion.size(); ++rod) {
      const auto [link, I] = rods.model.rods()[rod];
      const LinkResponse variation{link, random_deflection(*body_at(linkage, link), I, random)};
      const double work = bent_positions::residual_work(linkage, all[k].speed, rods.motion, variation);
      const MatrixXd products =
          rods.model.force_per_residual(rod) *
          r.middleRows(rods.model.first_mode(rod), I).cwiseProduct(fourier::synthesise(variation.q, angles.size()));
      EXPECT_NEAR(products.sum() / 256, work, 1e-8 * products.cwiseAbs().sum() / 256);
    }
  }
}

TEST(ExactModel, PowerOfTheCrankGoesToDampersAndToWhatHoldsTheMotion) {
  Random random(11);
  const std::vector<RandomLinkage> all = linkages(17, 4);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const Linkage& linkage = all[k].linkage;
    const double speed = all[k].speed;
    const Bent rods = bent(linkage, random);
    const CrankAngles angles(linkage, 256);
    const RitzSamples motion = ritz_samples(rods.q(), speed, angles.size());
    const MatrixXd r = rods.model.residual(speed, angles, motion).r;
    double holding = 0, sizes = 0;
    for (std::size_t rod = 0; rod < rods.motion.size(); ++rod) {
      const Index first = rods.model.first_mode(rod), I = rods.model.rods()[rod].num_modes;
      const MatrixXd power =
          rods.model.force_per_residual(rod) * r.middleRows(first, I).cwiseProduct(motion.q1.middleRows(first, I));
      holding += power.sum() / 256;
      sizes += power.cwiseAbs().sum() / 256;
    }
    double driving = 0;
    for (const MechanismForces& forces : rods.model.forces(speed, angles, motion).forces) {
      driving += speed * forces.torque / 256;
      sizes += std::abs(speed * forces.torque) / 256;
    }
    const double taken = bent_positions::lost_power(linkage, speed, rods.motion) -
                         bent_positions::slider_power(linkage, speed, rods.motion);
    EXPECT_NEAR(driving + holding, taken, 1e-9 * sizes);
  }
}

TEST(ExactModel, DerivativesAreThoseOfTheResidual) {
  Random random(3);
  const std::vector<RandomLinkage> all = linkages(30, 12);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const double speed = all[k].speed;
    const Bent rods = bent(all[k].linkage, random);
    const Index n = rods.model.num_modes(), N = 9;
    const CrankAngles angles(all[k].linkage, N);
    const RitzSamples motion = ritz_samples(rods.q(), speed, 15, 1);
    const RitzSamples here{motion.q.leftCols(N), motion.q1.leftCols(N), motion.q2.leftCols(N)};
    const ExactResidual exact = rods.model.residual(speed, angles, here, true);
    EXPECT_FALSE(exact.breakdown);
    const std::array<const MatrixXd*, 3> by = {&exact.by_q, &exact.by_q1, &exact.by_q2};
    const std::array<MatrixXd RitzSamples::*, 3> of = {&RitzSamples::q, &RitzSamples::q1, &RitzSamples::q2};
    for (std::size_t z = 0; z < 3; ++z)
      for (Index i = 0; i < n; ++i) {
        // Sixth-order central differences.
        const double h = 4e-3 * (here.*of[z]).row(i).cwiseAbs().maxCoeff();
        MatrixXd difference = MatrixXd::Zero(n, N);
        const std::array<double, 3> a = {0.75, -0.15, 1.0 / 60};
        for (int step = 1; step <= 3; ++step)
          for (const int sign : {-1, 1}) {
            RitzSamples moved = here;
            (moved.*of[z]).row(i).array() += sign * step * h;
            difference +=
                sign * a[static_cast<std::size_t>(step - 1)] / h * rods.model.residual(speed, angles, moved).r;
          }
        for (Index j = 0; j < n; ++j) {
          const Eigen::RowVectorXd derivative = by[z]->row(j + n * i);
          const double noise = 20 * eps * exact.r.row(j).norm() / h;
          EXPECT_LE((derivative - difference.row(j)).norm(), 1e-8 * difference.norm() + noise)
              << "residual " << j << " by derivative " << z << " of coordinate " << i;
        }
      }
  }
}

// Without what is not asked for the same numbers.
TEST(ExactModel, LinearisedHasTheDerivativesOfTheResidual) {
  Random random(5);
  const std::vector<RandomLinkage> all = linkages(30, 12);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const double speed = all[k].speed;
    const Bent rods = bent(all[k].linkage, random);
    const CrankAngles angles(all[k].linkage, 15);
    const RitzSamples motion = ritz_samples(rods.q(), speed, 15, 1);
    const ExactResidual whole = rods.model.residual(speed, angles, motion, true),
                        alone = rods.model.linearised(speed, angles, motion);
    ASSERT_FALSE(whole.breakdown || alone.breakdown);
    EXPECT_EQ(alone.r.size(), 0);
    EXPECT_EQ(alone.by_speed.size(), 0);
    for (MatrixXd ExactResidual::*by : {&ExactResidual::by_q, &ExactResidual::by_q1, &ExactResidual::by_q2})
      EXPECT_LE((alone.*by - whole.*by).norm(), 1e-14 * (whole.*by).norm());
  }
}

// The residual is a polynomial of degree two in the speed.
TEST(ExactModel, DerivativeBySpeedIsThatOfTheResidual) {
  Random random(3);
  const std::vector<RandomLinkage> all = linkages(17, 12);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const Bent rods = bent(all[k].linkage, random);
    const CrankAngles angles(all[k].linkage, 16);
    const double speed = all[k].speed, h = speed / 4;
    const RitzSamples motion = ritz_samples(rods.q(), speed, 16);
    const MatrixXd faster = rods.model.residual(speed + h, angles, motion).r;
    const MatrixXd slower = rods.model.residual(speed - h, angles, motion).r;
    const ExactResidual here = rods.model.residual(speed, angles, motion, true);
    EXPECT_LE((here.by_speed - (faster - slower) / (2 * h)).norm(),
              1e-11 * here.by_speed.norm() + 10 * eps * here.r.norm() / h);
  }
}

TEST(ExactModel, ForcesAreTheLinearOnesToSecondOrder) {
  Random random(8);
  const std::vector<RandomLinkage> all = linkages(20, 21);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(label(all[k], k));
    const Linkage& linkage = all[k].linkage;
    const double speed = all[k].speed;
    const Bent rods = bent(linkage, random);
    const CrankAngles angles(linkage, 15);
    const auto difference = [&](double scale) {
      const RitzSamples motion = ritz_samples(rods.q(scale), speed, angles.size());
      const ExactModel::Forces exact = rods.model.forces(speed, angles, motion);
      Eigen::VectorXd sums(angles.size());
      for (Index j = 0; j < angles.size(); ++j) {
        std::vector<BodyLoad> loads(static_cast<std::size_t>(linkage.num_bodies()));
        const std::vector<BodyMotion> rigid = motion_at(linkage, angles.tau(j));
        const std::array<std::vector<BodyLoad>, 3> powers = rigid_loads(linkage, rigid, angles.tau(j));
        for (std::size_t b = 0; b < loads.size(); ++b)
          for (std::size_t p = 0; p < 3; ++p) {
            loads[b].force += std::pow(speed, p) * powers[p][b].force;
            loads[b].moment += std::pow(speed, p) * powers[p][b].moment;
          }
        for (std::size_t r = 0; r < rods.motion.size(); ++r) {
          const Index first = rods.model.first_mode(r), I = rods.model.rods()[r].num_modes;
          const BodyLoad added = elastic_load(
              linkage, rigid, rods.motion[r].link, speed, motion.q.col(j).segment(first, I),
              motion.q1.col(j).segment(first, I) / speed, motion.q2.col(j).segment(first, I) / (speed * speed));
          loads[static_cast<std::size_t>(rods.motion[r].link)].force += added.force;
          loads[static_cast<std::size_t>(rods.motion[r].link)].moment += added.moment;
        }
        sums(j) = exact.forces[static_cast<std::size_t>(j)].torque - balance(linkage, rigid, loads).torque;
      }
      return sums;
    };
    const ExactModel::Forces rigid = rods.model.forces(speed, angles, ritz_samples(rods.q(0), speed, angles.size()));
    double size = 0;
    for (const MechanismForces& forces : rigid.forces) size = std::max(size, std::abs(forces.torque));
    EXPECT_LE(difference(0).cwiseAbs().maxCoeff(), 1e-12 * size);
    const Eigen::VectorXd half = difference(5e-4), whole = difference(1e-3);
    EXPECT_LE((whole - 4 * half).norm(), 5e-3 * whole.norm() + 1e-12 * size);
  }
}

TEST(ExactModel, MorePointsAlongTheRodsChangeNothing) {
  Random random(5);
  for (const RandomLinkage& linkage : linkages(10, 77)) {
    SCOPED_TRACE(linkage.kind);
    const Bent rods = bent(linkage.linkage, random);
    const ExactModel fine(linkage.linkage, rods.model.rods(), 48);
    const CrankAngles angles(linkage.linkage, 16);
    const RitzSamples motion = ritz_samples(rods.q(), linkage.speed, 16);
    const MatrixXd r = rods.model.residual(linkage.speed, angles, motion).r;
    const MatrixXd r_fine = fine.residual(linkage.speed, angles, motion).r;
    for (Index i = 0; i < r.rows(); ++i) EXPECT_LE((r - r_fine).row(i).norm(), 1e-11 * r.row(i).norm());
  }
}

// Newton on the values at 2H+1 angles with dense Fourier differentiation.
MatrixXd periodic_motion(const ExactModel& model, double speed, Index H) {
  const Index N = 2 * H + 1, n = model.num_modes();
  const CrankAngles angles(model.linkage(), N);
  MatrixXd D(N, N), D2(N, N);
  for (Index j = 0; j < N; ++j) {
    FourierSeries unit = fourier::analyse(MatrixXd(Eigen::RowVectorXd::Unit(N, j)));
    D.col(j) = speed * fourier::synthesise(fourier::derivative(unit), N).transpose();
    D2.col(j) = speed * speed * fourier::synthesise(fourier::derivative(unit, 2), N).transpose();
  }
  MatrixXd q = MatrixXd::Zero(n, N);
  for (int iteration = 0; iteration < 12; ++iteration) {
    const RitzSamples motion{q, q * D.transpose(), q * D2.transpose()};
    const ExactResidual at = model.residual(speed, angles, motion, true);
    if (at.breakdown) return {};
    MatrixXd J = MatrixXd::Zero(n * N, n * N);
    for (Index a = 0; a < N; ++a)
      for (Index b = 0; b < N; ++b)
        for (Index k = 0; k < n; ++k)
          for (Index i = 0; i < n; ++i)
            J(i + n * a, k + n * b) = (a == b ? at.by_q(i + n * k, a) : 0.0) + at.by_q1(i + n * k, a) * D(a, b) +
                                      at.by_q2(i + n * k, a) * D2(a, b);
    const Eigen::VectorXd step = J.partialPivLu().solve(at.r.reshaped());
    q -= step.reshaped(n, N);
    if (step.norm() <= 1e-12 * q.norm()) break;
  }
  return q;
}

Eigen::VectorXd largest(const MatrixXd& samples) {
  const FourierSeries q = fourier::analyse(samples);
  Eigen::VectorXd max_abs(q.num_components());
  for (Index i = 0; i < max_abs.size(); ++i) max_abs(i) = fourier::max_abs(q, i).value;
  return max_abs;
}

// Independent values: action of the whole mechanism from positions, its gradient by automatic differentiation.
TEST(ExactModel, MotionOfTheSixLinkMechanismIsTheReferences) {
  const Linkage linkage = six_link::linkage();
  const struct {
    double rpm;
    Index modes, H;
    std::vector<double> max_abs;
  } cases[] = {
      {300, 2, 14, {0.1510894034, 0.0050581327, 0.1267065791, 0.0009852141}},
      {600, 2, 18, {0.5419715853, 0.0205708550, 0.4121555418, 0.0037625432}},
      {900, 2, 22, {1.3632967558, 0.0477219970, 0.9390832626, 0.0077317919}},
      {1200, 1, 24, {2.7971543378, 1.8347540197}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.rpm);
    const ExactModel model(linkage, {{1, c.modes}, {3, c.modes}});
    const MatrixXd q = periodic_motion(model, c.rpm * pi / 30, c.H);
    ASSERT_EQ(q.rows(), static_cast<Index>(c.max_abs.size()));
    const Eigen::VectorXd max_abs = largest(q);
    for (std::size_t i = 0; i < c.max_abs.size(); ++i) {
      const double rod = c.max_abs[i < c.max_abs.size() / 2 ? 0 : c.max_abs.size() / 2];
      EXPECT_NEAR(max_abs(static_cast<Index>(i)), c.max_abs[i], 3e-7 * rod);
    }
  }
}

TEST(ExactModel, MotionOfTheSliderCrankIsTheReferences) {
  const ExactModel model(slider_crank::linkage(), {{1, 2}});
  const struct {
    double speed, q1, q2;
  } cases[] = {
      {60, 2.489224424e-4, 7.64312403e-6}, {150, 1.552226356e-3, 4.88545926e-5}, {212.8, 3.40767475e-3, 1.01601433e-4}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.speed);
    const MatrixXd q = periodic_motion(model, c.speed, 24);
    ASSERT_EQ(q.rows(), 2);
    const Eigen::VectorXd max_abs = largest(q);
    EXPECT_NEAR(max_abs(0), c.q1, 3e-7 * c.q1);
    EXPECT_NEAR(max_abs(1), c.q2, 3e-7 * c.q1);
  }
}

TEST(ExactModel, SaysWhereARodFoldsAndWhereTheMechanismOpens) {
  const Linkage linkage = six_link::linkage();
  const ExactModel model(linkage, {{1, 1}, {3, 1}});
  const CrankAngles angles(linkage, 64);
  FourierSeries none(1, 1), wave(1, 1);
  wave.c(0, 1) = 45;  // q = 90 cos tau, slope 90 pi/258 > 1
  const ExactResidual folded = model.residual(10, angles, ritz_samples(std::vector<FourierSeries>{none, wave}, 10, 64));
  ASSERT_TRUE(folded.breakdown);
  EXPECT_EQ(folded.breakdown->kind, ExactBreakdown::Kind::slope);
  EXPECT_EQ(folded.breakdown->body, 3);
  EXPECT_EQ(folded.breakdown->crank_angle, 0);
  EXPECT_NEAR(folded.breakdown->slope, 90 * pi / 258, 1e-12);

  // Crank 180, ground 270: the rocker of 200 and AB of 259 reach the 450 at 180 degrees, bent AB does not.
  Linkage wide = linkage;
  wide.crank.body.length = 180;
  wide.dyads[0].on.point = 180;
  wide.dyads.pop_back();
  ASSERT_FALSE(find_obstruction(wide));
  FourierSeries arch(1, 0);
  arch.c(0, 0) = 75;
  const ExactResidual opened =
      ExactModel(wide, {{1, 1}})
          .residual(10, CrankAngles(wide, 64), ritz_samples(std::vector<FourierSeries>{arch}, 10, 64));
  ASSERT_TRUE(opened.breakdown);
  EXPECT_EQ(opened.breakdown->kind, ExactBreakdown::Kind::open);
  EXPECT_EQ(opened.breakdown->body, 1);
  EXPECT_NEAR(opened.breakdown->crank_angle, pi, 1);
}

}  // namespace
}  // namespace hb
