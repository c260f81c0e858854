// The library against an independent model (tests/newton_euler.hpp), on random linkages of every kind.
#include "tests/support/newton_euler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "lib/constants.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/hill_system.hpp"
#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/random_linkage.hpp"

namespace hb {
namespace {

using Complex = std::complex<double>;
constexpr double tolerance = 1e-10;  // relative, of everything compared

// Of every kind, and a few that pass close to dead centres.
const std::vector<RandomLinkage>& linkages() {
  static const std::vector<RandomLinkage> list = [] {
    std::vector<RandomLinkage> all = random_linkages(80, 20240607);
    for (RandomLinkage& close : random_linkages(20, 3, {0.04, 0.1})) all.push_back(std::move(close));
    return all;
  }();
  return list;
}

const std::vector<double>& crank_angles() {
  static const std::vector<double> list = {0.0, 0.7, 1.9, 3.3, 4.6, 5.9};
  return list;
}

// Largest difference and largest value of quantities of one kind.
struct Comparison {
  double difference = 0, size = 0;
  void add(Complex a, Complex b) {
    keep_larger(difference, std::abs(a - b));
    keep_larger(size, std::abs(b));
  }
  bool agrees(double floor = 0) const { return difference <= tolerance * size + floor; }
  static void keep_larger(double& largest, double value) {
    if (!(value <= largest)) largest = value;  // keeps NaN
  }
};

std::ostream& operator<<(std::ostream& out, const Comparison& c) {
  return out << "differs by " << c.difference << " of " << c.size;
}

std::string label(const RandomLinkage& random, std::size_t number) {
  return "linkage " + std::to_string(number) + " (" + random.kind + ")";
}

TEST(RandomLinkages, HaveEveryKindOfLink) {
  int elastic_couplers = 0, elastic_rockers = 0, sliders = 0, on_couplers = 0, on_sliders = 0, long_chains = 0;
  int positive = 0, negative = 0;
  for (const auto& [kind, linkage, speed] : linkages()) {
    EXPECT_FALSE(elastic_links(linkage).empty() && linkage.dyads.size() < 3) << kind;
    if (linkage.dyads.size() >= 4) ++long_chains;
    for (const Dyad& dyad : linkage.dyads) {
      ++(dyad.branch > 0 ? positive : negative);
      if (dyad.coupler.elastic) ++elastic_couplers;
      const auto* rocker = std::get_if<Rocker>(&dyad.closing);
      if (!rocker) ++sliders;
      if (rocker && rocker->body.elastic) ++elastic_rockers;
      if (dyad.on.body % 2 == 1) ++on_couplers;
      if (dyad.on.body > 0 && !body_at(linkage, dyad.on.body)) ++on_sliders;
    }
  }
  for (const int count :
       {elastic_couplers, elastic_rockers, sliders, on_couplers, on_sliders, long_chains, positive, negative})
    EXPECT_GE(count, 10);
}

TEST(RandomLinkages, CloseTheirLoopsAtEveryCrankAngle) {
  for (const auto& [kind, linkage, speed] : linkages())
    for (const double tau : crank_angles()) {
      const std::vector<BodyMotion> motion = motion_at(linkage, tau);
      for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
        const Dyad& dyad = linkage.dyads[static_cast<std::size_t>(d)];
        const BodyMotion& coupler = motion[static_cast<std::size_t>(coupler_index(d))];
        const BodyMotion& closing = motion[static_cast<std::size_t>(closing_index(d))];
        const auto* rocker = std::get_if<Rocker>(&dyad.closing);
        const Complex end = rocker ? closing.position(rocker->body.length) : closing.z;
        const double scale = std::abs(coupler.z) + dyad.coupler.length + std::abs(end);
        EXPECT_LE(std::abs(coupler.position(dyad.coupler.length) - end), 1e-13 * scale) << kind;
        EXPECT_LE(std::abs(std::abs(coupler.e) - 1), 1e-13) << kind;
        const Complex e = coupler.e;
        if (rocker) {
          EXPECT_GT(dyad.branch * (std::conj(coupler.z - rocker->pivot) * closing.e).imag(), 0) << kind;
        } else {
          const auto& slider = std::get<Slider>(dyad.closing);
          const Complex guide = std::polar(1.0, slider.direction);
          EXPECT_LE(std::abs((std::conj(guide) * (end - slider.guide)).imag()),
                    1e-13 * (scale + std::abs(slider.guide)))
              << kind;
          EXPECT_GT(dyad.branch * (std::conj(guide) * e).real(), 0) << kind;
        }
      }
    }
}

TEST(Kinematics, DerivativesAreThoseOfThePositions) {
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    Comparison z, z1, z2, e, turn1, turn2;
    for (const double tau : crank_angles()) {
      const std::vector<BodyMotion> ours = motion_at(linkage, tau);
      const std::vector<BodyMotion> theirs = newton_euler::motion(linkage, tau);
      ASSERT_EQ(ours.size(), theirs.size());
      for (std::size_t b = 0; b < ours.size(); ++b) {
        z.add(ours[b].z, theirs[b].z);
        z1.add(ours[b].z1, theirs[b].z1);
        z2.add(ours[b].z2, theirs[b].z2);
        turn1.add(ours[b].phi1, theirs[b].phi1);
        turn2.add(ours[b].phi2, theirs[b].phi2);
        e.add(ours[b].e, theirs[b].e);
      }
    }
    for (const Comparison& c : {z, z1, z2, e, turn1, turn2}) EXPECT_TRUE(c.agrees()) << label(linkages()[n], n) << c;
  }
}

// Joint forces of the three powers of the speed, added up.
MechanismForces rigid_forces(const Linkage& linkage, double tau, double speed) {
  const std::vector<BodyMotion> motion = motion_at(linkage, tau);
  const std::array<std::vector<BodyLoad>, 3> loads = rigid_loads(linkage, motion, tau);
  std::vector<BodyLoad> sum = loads[0];
  for (std::size_t b = 0; b < sum.size(); ++b) {
    sum[b].force += speed * (loads[1][b].force + speed * loads[2][b].force);
    sum[b].moment += speed * (loads[1][b].moment + speed * loads[2][b].moment);
  }
  return balance(linkage, motion, sum);
}

void compare(const MechanismForces& ours, const MechanismForces& theirs, Comparison& force, Comparison& torque) {
  ASSERT_EQ(ours.dyads.size(), theirs.dyads.size());
  for (std::size_t d = 0; d < ours.dyads.size(); ++d) {
    force.add(ours.dyads[d].joint0, theirs.dyads[d].joint0);
    force.add(ours.dyads[d].joint1, theirs.dyads[d].joint1);
    force.add(ours.dyads[d].ground, theirs.dyads[d].ground);
  }
  force.add(ours.crank_pivot, theirs.crank_pivot);
  torque.add(ours.torque, theirs.torque);
}

TEST(JointForces, RigidOnesBalanceEveryBodyAtOnce) {
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    for (const double factor : {0.0, 0.03, 1.0, 30.0}) {
      const double speed = factor * linkages()[n].speed;
      Comparison force, torque;
      for (const double tau : crank_angles())
        compare(rigid_forces(linkage, tau, speed), newton_euler::forces(linkage, tau, speed), force, torque);
      EXPECT_TRUE(force.size > 0 || factor == 0) << label(linkages()[n], n);
      EXPECT_TRUE(force.agrees()) << label(linkages()[n], n) << " at " << factor << ": force " << force;
      EXPECT_TRUE(torque.agrees()) << label(linkages()[n], n) << " at " << factor << ": torque " << torque;
    }
  }
}

TEST(Rod, RitzMatricesAreTheWeakFormOfTheBeamEquation) {
  constexpr Eigen::Index I = 6;
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    ASSERT_EQ(coefficients.links, elastic_links(linkage));
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const int link = coefficients.links[r];
      const Body& rod = *body_at(linkage, link);
      const HillSystem system = ritz_system(rod, coefficients.rods[r], I);
      for (const double factor : {0.1, 1.0, 4.0}) {
        const double speed = factor * linkages()[n].speed;
        const FourierSeries C = stiffness_at(system, speed), h = load_at(system, speed);
        std::vector<Comparison> stiffness(I * I), load(I), mass(I * I), damping(I * I);
        for (const double tau : crank_angles()) {
          const newton_euler::Ritz ritz = newton_euler::ritz(linkage, link, tau, speed, I);
          const Eigen::VectorXd c = fourier::evaluate(C, tau), load_now = fourier::evaluate(h, tau);
          for (Eigen::Index i = 0; i < I; ++i) {
            load[static_cast<std::size_t>(i)].add(load_now(i), ritz.load(i));
            for (Eigen::Index k = 0; k < I; ++k) {
              // Bending's own (i pi/l)^4 taken off, so that it hides nothing.
              const double bending = i == k ? std::pow(static_cast<double>(i + 1) * pi / rod.length, 4) : 0;
              const auto ik = static_cast<std::size_t>(i + I * k);
              stiffness[ik].add(c(i + I * k) - bending, ritz.stiffness(i, k) - bending);
              mass[ik].add(system.mass(i, k), ritz.mass(i, k));
              damping[ik].add(system.damping(i, k), ritz.damping(i, k));
            }
          }
        }
        const auto where = [&] { return label(linkages()[n], n) + " " + rod.name + " at " + std::to_string(factor); };
        constexpr double eps = std::numeric_limits<double>::epsilon();
        for (Eigen::Index i = 0; i < I; ++i) {
          EXPECT_TRUE(load[static_cast<std::size_t>(i)].agrees(1e-12 * fourier::wiener_norm(h, i)))
              << where() << " h " << i + 1 << ' ' << load[i];
          for (Eigen::Index k = 0; k < I; ++k) {
            const auto ik = static_cast<std::size_t>(i + I * k);
            const double rows = static_cast<double>((i + 1) * (k + 1));
            const double bending = std::pow(rows, 2) * std::pow(pi / rod.length, 4);
            // The series are cut at rounding of the turn's largest value, which six crank angles may not meet.
            const double largest = fourier::wiener_norm(C, i + I * k);
            EXPECT_TRUE(stiffness[ik].agrees(20 * eps * bending + 1e-12 * largest))
                << where() << " C " << i + 1 << ' ' << k + 1 << ' ' << stiffness[ik];
            EXPECT_TRUE(mass[ik].agrees(100 * eps * rows * system.mass(0, 0))) << where() << " M " << mass[ik];
            EXPECT_TRUE(damping[ik].agrees(100 * eps * rows * rows * system.damping(0, 0)))
                << where() << " B " << damping[ik];
          }
        }
      }
    }
  }
}

TEST(JointForces, ElasticOnesKeepEveryTermLinearInTheDeflection) {
  Random random(7);
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    const double speed = linkages()[n].speed;
    std::vector<LinkResponse> responses;
    for (const int link : elastic_links(linkage))
      responses.push_back({link, random_deflection(*body_at(linkage, link), 3, random)});
    const JointForces ours = joint_forces(linkage, speed, responses);
    Comparison force, added, torque, added_torque;
    for (const double tau : crank_angles()) {
      const MechanismForces elastic = newton_euler::forces(linkage, tau, speed, responses);
      const MechanismForces rigid = newton_euler::forces(linkage, tau, speed);
      const auto elastic_parts = newton_euler::joint_components(linkage, tau, elastic),
                 rigid_parts = newton_euler::joint_components(linkage, tau, rigid);
      ASSERT_EQ(ours.joints.size(), elastic_parts.size()) << label(linkages()[n], n);
      for (const JointForce& joint : ours.joints) {
        ASSERT_TRUE(elastic_parts.contains(joint.name)) << joint.name;
        const std::vector<double>&full = elastic_parts.at(joint.name), &stiff = rigid_parts.at(joint.name);
        ASSERT_EQ(static_cast<std::size_t>(joint.elastic.num_components()), full.size()) << joint.name;
        const Eigen::VectorXd bent = fourier::evaluate(joint.elastic, tau),
                              straight = fourier::evaluate(joint.rigid, tau);
        for (std::size_t k = 0; k < full.size(); ++k) {
          const auto row = static_cast<Eigen::Index>(k);
          force.add(bent(row), full[k]);
          added.add(bent(row) - straight(row), full[k] - stiff[k]);
        }
      }
      const double bent = fourier::evaluate(ours.torque, tau)(0),
                   straight = fourier::evaluate(ours.torque_rigid, tau)(0);
      torque.add(bent, elastic.torque);
      added_torque.add(bent - straight, elastic.torque - rigid.torque);
    }
    EXPECT_TRUE(std::min(added.size, added_torque.size) > 0 || responses.empty()) << label(linkages()[n], n);
    // joint_forces cuts its series below 1e-13 of the turn's largest coefficient.
    double largest_force = 0;
    for (const JointForce& joint : ours.joints)
      for (Eigen::Index k = 0; k < joint.elastic.num_components(); ++k)
        largest_force = std::max(largest_force, fourier::wiener_norm(joint.elastic, k));
    const double largest_torque = fourier::wiener_norm(ours.torque, 0);
    for (const Comparison& c : {force, added})
      EXPECT_TRUE(c.agrees(1e-12 * largest_force)) << label(linkages()[n], n) << " force " << c;
    for (const Comparison& c : {torque, added_torque})
      EXPECT_TRUE(c.agrees(1e-12 * largest_torque)) << label(linkages()[n], n) << " torque " << c;
  }
}

TEST(JointForces, MeanTorqueFeedsDampingAndSliders) {
  for (std::size_t n = 0; n < linkages().size(); n += 3) {
    const Linkage& linkage = linkages()[n].linkage;
    const double speed = linkages()[n].speed;
    const FourierSeries torque = joint_forces(linkage, speed, {}).torque_rigid;
    constexpr int N = 512;
    double lost = 0;
    for (int j = 0; j < N; ++j) lost += newton_euler::lost_power(linkage, 2 * pi * j / N, speed) / N;
    const double size = fourier::max_abs(torque, 0).value * speed;
    EXPECT_LE(std::abs(torque.c(0, 0).real() * speed - lost), 1e-10 * std::abs(size)) << label(linkages()[n], n);
  }
}

TEST(JointForces, DrivingTorqueDoesTheVirtualWorkOfAnyLoads) {
  Random random(11);
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    const double L = linkage.crank.body.length;
    for (const double tau : crank_angles()) {
      const std::vector<BodyMotion> motion = motion_at(linkage, tau);
      std::vector<BodyLoad> loads;
      double work = 0, size = 0;
      for (const BodyMotion& body : motion) {
        loads.push_back({Complex(random.uniform(-1, 1), random.uniform(-1, 1)), L * random.uniform(-1, 1)});
        const double part = (std::conj(body.z1) * loads.back().force).real() + body.phi1 * loads.back().moment;
        work += part;
        size += std::abs(part);
      }
      EXPECT_LE(std::abs(balance(linkage, motion, loads).torque - work), 1e-11 * size) << label(linkages()[n], n);
    }
  }
}

// The linkage seen in a mirror along the x-axis: at crank angle -tau it stands as the mirror image at tau.
Linkage mirrored(Linkage linkage) {
  const auto mirror_points = [](auto& points) {
    for (auto& [name, point] : points) point = std::conj(point);
  };
  const auto mirror_body = [&](Body& body) {
    body.com = std::conj(body.com);
    mirror_points(body.points);
  };
  linkage.gravity = -linkage.gravity;
  linkage.crank.pivot = std::conj(linkage.crank.pivot);
  mirror_body(linkage.crank.body);
  for (Dyad& dyad : linkage.dyads) {
    dyad.on.point = std::conj(dyad.on.point);
    mirror_body(dyad.coupler);
    if (auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      rocker->pivot = std::conj(rocker->pivot);
      mirror_body(rocker->body);
      dyad.branch = -dyad.branch;
    } else {
      auto& slider = std::get<Slider>(dyad.closing);
      slider.guide = std::conj(slider.guide);
      slider.direction = -slider.direction;
      mirror_points(slider.points);
      slider.force.c = slider.force.c.conjugate().eval();
    }
  }
  return linkage;
}

TEST(JointForces, MirroredLinkageHasMirroredForces) {
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    const Linkage& linkage = linkages()[n].linkage;
    const double speed = linkages()[n].speed;
    const Linkage mirror = mirrored(linkage);
    Comparison force, torque;
    for (const double tau : crank_angles()) {
      MechanismForces image = rigid_forces(mirror, -tau, -speed);  // the crank's image turns the other way
      for (DyadForces& dyad : image.dyads)
        dyad = {std::conj(dyad.joint0), std::conj(dyad.joint1), std::conj(dyad.ground)};
      image.crank_pivot = std::conj(image.crank_pivot);
      image.torque = -image.torque;
      compare(image, rigid_forces(linkage, tau, speed), force, torque);
    }
    EXPECT_TRUE(force.agrees()) << label(linkages()[n], n) << " force " << force;
    EXPECT_TRUE(torque.agrees()) << label(linkages()[n], n) << " torque " << torque;
  }
}

TEST(JointForces, AreLinearInGravity) {
  for (std::size_t n = 0; n < linkages().size(); ++n) {
    Linkage upright = linkages()[n].linkage;
    Linkage weightless = upright, reversed = upright;
    weightless.gravity = 0;
    reversed.gravity = -upright.gravity;
    const double speed = linkages()[n].speed;
    Comparison force, torque;
    for (const double tau : crank_angles()) {
      const MechanismForces down = rigid_forces(upright, tau, speed), up = rigid_forces(reversed, tau, speed);
      MechanismForces mean = down;
      for (std::size_t d = 0; d < mean.dyads.size(); ++d)
        mean.dyads[d] = {(down.dyads[d].joint0 + up.dyads[d].joint0) / 2.0,
                         (down.dyads[d].joint1 + up.dyads[d].joint1) / 2.0,
                         (down.dyads[d].ground + up.dyads[d].ground) / 2.0};
      mean.crank_pivot = (down.crank_pivot + up.crank_pivot) / 2.0;
      mean.torque = (down.torque + up.torque) / 2.0;
      compare(mean, rigid_forces(weightless, tau, speed), force, torque);
    }
    EXPECT_TRUE(force.agrees()) << label(linkages()[n], n) << " force " << force;
    EXPECT_TRUE(torque.agrees()) << label(linkages()[n], n) << " torque " << torque;
  }
}

}  // namespace
}  // namespace hb
