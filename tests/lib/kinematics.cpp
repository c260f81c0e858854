#include "lib/linkage/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/constants.hpp"
#include "tests/support/random_linkage.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;
using Complex = std::complex<double>;
Body body(const std::string& name, double length) {
  Body b;
  b.name = name;
  b.length = length;
  return b;
}

Rocker rocker(const std::string& name, double length, Complex pivot) {
  Rocker r;
  r.body = body(name, length);
  r.pivot = pivot;
  return r;
}

Dyad dyad(const Attachment& on, const Body& coupler, const std::variant<Rocker, Slider>& closing, int branch) {
  Dyad d;
  d.on = on;
  d.coupler = coupler;
  d.closing = closing;
  d.branch = branch;
  return d;
}

Linkage four_bar(double crank, double coupler, double rocker_length, Complex pivot, int branch) {
  Linkage linkage;
  linkage.crank.body = body("crank", crank);
  linkage.dyads = {dyad({0, crank, "crank"}, body("AB", coupler), rocker("CB", rocker_length, pivot), branch)};
  return linkage;
}

Linkage slider_crank(double crank, double coupler, double offset, double direction, int branch) {
  Linkage linkage;
  linkage.crank.body = body("crank", crank);
  Slider piston;
  piston.name = "piston";
  piston.guide = std::polar(offset, direction + pi / 2);
  piston.direction = direction;
  linkage.dyads = {dyad({0, crank, "crank"}, body("rod", coupler), piston, branch)};
  return linkage;
}

TEST(Kinematics, ParallelogramCouplerStaysParallelToTheGround) {
  const Linkage parallelogram = four_bar(1.5, 4, 1.5, 4, -1);
  for (double tau = 0.1; tau < 3.05; tau += 0.1) {
    const std::vector<BodyMotion> m = motion_at(parallelogram, tau);
    const double tolerance = 100 * eps / std::pow(std::sin(tau), 3);
    EXPECT_LE(std::abs(m[1].e - 1.0), tolerance);
    EXPECT_LE(std::abs(m[2].e - std::polar(1.0, tau)), tolerance);
    EXPECT_LE(std::abs(m[1].phi1) + std::abs(m[1].phi2), tolerance);
    EXPECT_LE(std::abs(m[2].phi1 - 1) + std::abs(m[2].phi2), tolerance);
  }
}

// s = r cos a + branch sqrt(l^2 - h^2), h = r sin a - offset, a = tau - direction.
TEST(Kinematics, SliderCrankFollowsItsClosedForm) {
  const double r = 0.7, l = 2.1, offset = 0.3;
  for (const int branch : {1, -1})
    for (const double direction : {0.0, 0.6, -2.5})
      for (double tau = 0; tau < 2 * pi; tau += 0.37) {
        const BodyMotion piston = motion_at(slider_crank(r, l, offset, direction, branch), tau)[2];
        const double a = tau - direction, h = r * std::sin(a) - offset, root = std::sqrt(l * l - h * h);
        const double h1 = r * std::cos(a), h2 = -r * std::sin(a);
        const double s = r * std::cos(a) + branch * root;
        const double s1 = -r * std::sin(a) - branch * h * h1 / root;
        const double s2 = -r * std::cos(a) - branch * ((h1 * h1 + h * h2) / root + h * h * h1 * h1 / std::pow(root, 3));
        const Complex u = std::polar(1.0, direction);
        EXPECT_LE(std::abs(piston.z - std::polar(offset, direction + pi / 2) - s * u), 20 * eps * l);
        EXPECT_LE(std::abs(piston.z1 - s1 * u), 20 * eps * l);
        EXPECT_LE(std::abs(piston.z2 - s2 * u), 50 * eps * l);
        EXPECT_EQ(piston.phi1, 0);
      }
}

TEST(Kinematics, DerivativesAreTheSpectralDerivativesOfThePositions) {
  const Linkage six = six_link::linkage();
  constexpr Eigen::Index N = 256, bodies = 5;
  Eigen::MatrixXd z(2 * bodies, N), z1(2 * bodies, N), z2(2 * bodies, N);
  for (Eigen::Index j = 0; j < N; ++j) {
    const std::vector<BodyMotion> motion = motion_at(six, 2 * pi * static_cast<double>(j) / N);
    for (Eigen::Index b = 0; b < bodies; ++b) {
      const BodyMotion& m = motion[static_cast<std::size_t>(b)];
      const Complex p(100, 30);
      z.col(j).segment<2>(2 * b) << m.position(p).real(), m.position(p).imag();
      z1.col(j).segment<2>(2 * b) << m.velocity(p).real(), m.velocity(p).imag();
      z2.col(j).segment<2>(2 * b) << m.acceleration(p).real(), m.acceleration(p).imag();
    }
  }
  // Beyond harmonic 40 the positions hold rounding only; differentiating multiplies what is left by 40 and 1600.
  const FourierSeries series = fourier::resized(fourier::analyse(z), 40);
  const double scale = z.cwiseAbs().maxCoeff();
  const auto spectral = [&](int order) -> Eigen::MatrixXd {
    return fourier::synthesise(fourier::derivative(series, order), N);
  };
  EXPECT_LE((spectral(1) - z1).cwiseAbs().maxCoeff(), 40 * 20 * eps * scale);
  EXPECT_LE((spectral(2) - z2).cwiseAbs().maxCoeff(), 1600 * 20 * eps * scale);
}

TEST(Kinematics, MirroredLinkageMovesAsTheMirrorImage) {
  const Linkage six = six_link::linkage();
  Linkage mirrored = six;
  for (Dyad& dyad : mirrored.dyads) {
    dyad.branch = -dyad.branch;
    dyad.on.point = std::conj(dyad.on.point);
  }
  for (double tau = 0; tau < 2 * pi; tau += 0.61) {
    const std::vector<BodyMotion> a = motion_at(six, tau), b = motion_at(mirrored, -tau);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_LE(std::abs(b[k].z - std::conj(a[k].z)), 1e-13 * 570);
      EXPECT_LE(std::abs(b[k].z2 - std::conj(a[k].z2)), 1e-12 * 570);
      EXPECT_LE(std::abs(b[k].phi1 - a[k].phi1), 1e-13);
      EXPECT_LE(std::abs(b[k].phi2 + a[k].phi2), 1e-12);
    }
  }
}

TEST(Kinematics, MotionIsNaNWhereTheLinkageDoesNotClose) {
  EXPECT_TRUE(std::isnan(motion_at(four_bar(1, 1, 1, 4, 1), pi)[1].e.real()));
  EXPECT_TRUE(std::isnan(motion_at(slider_crank(2, 1, 0, 0, 1), pi / 2)[2].z.real()));
}

TEST(Obstruction, FreelyTurningLinkagesHaveNone) {
  EXPECT_FALSE(find_obstruction(six_link::linkage()).has_value());
  EXPECT_FALSE(find_obstruction(slider_crank(1, 3, 0.5, 0.3, -1)).has_value());
  for (const RandomLinkage& random : random_linkages(40, 5))
    EXPECT_FALSE(find_obstruction(random.linkage).has_value()) << random.kind;
}

// r = |tip - pivot| is largest, g + c, where the crank points away from the pivot g e^{i a}: at a + pi. Near there
// r = g + c - (c g / 2(g + c)) (tau - a - pi)^2.
TEST(Obstruction, FindsAGapOfAnyWidthAnywhereInTheTurn) {
  const double c = 1, g = 3, reach = g + c;
  for (const double width : {1.0, 0.1, 1e-2, 1e-3, 1e-4})
    for (double a = 0.123; a < 2 * pi; a += 0.777) {
      const double length = reach - c * g / (2 * reach) * width * width / 4;
      const Linkage linkage = four_bar(c, 0.6 * length, 0.4 * length, std::polar(g, a), 1);
      const auto found = find_obstruction(linkage);
      ASSERT_TRUE(found.has_value()) << width << " at " << a;
      EXPECT_EQ(found->dyad, 0);
      EXPECT_FALSE(found->dead_centre);
      EXPECT_LE(std::abs(std::remainder(found->crank_angle - a - pi, 2 * pi)), width / 10 + 1e-6);
      EXPECT_NE(found->message.find("does not close"), std::string::npos) << found->message;
    }
}

TEST(Obstruction, PassesALinkageThatOnlyComesClose) {
  const double c = 1, g = 3, length = (g + c) * (1 + 1e-9);  // sin of the transmission angle about 9e-5
  for (double a = 0.123; a < 2 * pi; a += 0.777)
    EXPECT_FALSE(find_obstruction(four_bar(c, 0.6 * length, 0.4 * length, std::polar(g, a), 1)).has_value());
}

TEST(Obstruction, ParallelogramStandsInADeadCentre) {
  const auto found = find_obstruction(four_bar(1.5, 4, 1.5, 4, 1));
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->dead_centre);
  EXPECT_LE(std::abs(std::sin(found->crank_angle)), 1e-6);
  EXPECT_NE(found->message.find("AB and CB stand in line"), std::string::npos) << found->message;
}

TEST(Obstruction, SliderCrankWithShortRodDoesNotClose) {
  const auto found = find_obstruction(slider_crank(2, 1.9, 0, 0.4, 1));
  ASSERT_TRUE(found.has_value());
  EXPECT_LE(std::abs(std::cos(found->crank_angle - 0.4)), 1e-6);
  EXPECT_NE(found->message.find("the dyad (rod, piston) does not close at crank angle"), std::string::npos)
      << found->message;
}

TEST(Obstruction, EqualCrankAndRodOnACentredGuideIsADeadCentre) {
  const auto found = find_obstruction(slider_crank(2, 2, 0, 0, 1));
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->dead_centre);
}

TEST(Obstruction, NamesTheEarliestDyadThatFails) {
  Linkage six = six_link::linkage();
  six.dyads[0].branch = 1;  // the second loop cannot close over the whole turn
  const auto second = find_obstruction(six);
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->dyad, 1);
  EXPECT_TRUE(std::isnan(motion_at(six, second->crank_angle)[3].e.real()));
  EXPECT_NE(second->message.find("the dyad (CD, O3D)"), std::string::npos) << second->message;

  six.dyads[0].coupler.length = 100;  // and now the first does not either
  const auto first = find_obstruction(six);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->dyad, 0);
}

TEST(Obstruction, SaysWhenALinkageNeverCloses) {
  const auto found = find_obstruction(four_bar(1, 2, 2, 40, 1));
  ASSERT_TRUE(found.has_value());
  EXPECT_NE(found->message.find("at any crank angle"), std::string::npos) << found->message;
}

// A dip in the second dyad's margin sharpened by the first dyad passing close to a dead centre.
TEST(Obstruction, FindsDipsThatAnEarlierNearDeadCentreSharpens) {
  for (const double slack : {1e-3, 1e-5, 1e-7}) {
    Linkage linkage = four_bar(1, 1.7, 2.3 + slack, 3, 1);
    const auto tip = [&](double tau) { return motion_at(linkage, tau)[2].position(1.5); };
    // The rocker's extreme position is passed within about sqrt(slack) of the crank angle pi; put the second pivot
    // where the second dyad just fails to reach that extreme.
    ASSERT_FALSE(find_obstruction(linkage).has_value());
    double farthest = 0;
    const Complex pivot(9, 1);
    for (int j = -20000; j <= 20000; ++j)
      farthest = std::max(farthest, std::abs(tip(pi + 5 * std::sqrt(slack) * j / 20000.0) - pivot));
    for (int j = 0; j < 20000; ++j) farthest = std::max(farthest, std::abs(tip(2 * pi * j / 20000.0) - pivot));
    const double length = farthest / 2 * (1 - 1e-7);
    linkage.dyads.push_back(dyad({2, 1.5, "CB.T"}, body("TE", length), rocker("FE", length, pivot), 1));
    const auto found = find_obstruction(linkage);
    ASSERT_TRUE(found.has_value()) << slack;
    EXPECT_EQ(found->dyad, 1);
  }
}

}  // namespace
