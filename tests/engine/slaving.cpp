// Reductions to a few modes: what they leave is an exact system of fewer modes, and their errors hold.
#include "hb/engine/exponents/slaving.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <vector>

#include "hb/engine/exponents/anderson.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/exponents/slaving_pairs.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "tests/support/long_double_floquet.hpp"

namespace hb {
namespace {

using cplx = std::complex<double>;

// Two modes, mass 1, symmetric stiffness mean + first cos tau.
HillSystem two_modes(double damping, const Eigen::Matrix2d& mean, const Eigen::Matrix2d& first) {
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = damping * Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) = mean.reshaped().cast<cplx>();
  system.stiffness[0].c.col(1) = 0.5 * first.reshaped().cast<cplx>();
  return system;
}

// From the nearest one, by more than that is wrong.
double off(cplx s, const std::vector<reference::FloquetExponent>& exact) {
  double nearest = HUGE_VAL;
  for (const auto& x : exact) {
    const double turn = std::remainder(s.imag() - double(x.value.imag()), 1.0);
    nearest = std::min(nearest, std::hypot(s.real() - double(x.value.real()), turn) - double(x.error));
  }
  return nearest;
}

void expect_covered(const HillSystem& system, StabilityMethod method, double most) {
  const auto exact = reference::floquet_exponents(system, 1);
  const Stability result = analyse_stability(system, 1, {.method = method});
  ASSERT_EQ(result.exponents.size(), exact.size());
  for (const Exponent& e : result.exponents) {
    EXPECT_LE(off(e.value, exact), e.error) << to_string(method) << ": " << e.value << "; " << result.evidence;
    EXPECT_LE(e.error, most) << to_string(method);
  }
}

// K ends at its 14th harmonic: the 28th of alpha, -|K_FS|^2/w_F^2 of the coupling's, locks a mode of 14 turns. On few
// samples it would be folded back to another harmonic.
TEST(Slaving, AlphaHasAllHarmonicsOfTheCouplingAndWhatFollowsIt) {
  HillSystem system = two_modes(0, (Eigen::Matrix2d() << 196, 0, 0, 1000.3 * 1000.3).finished(),
                                (Eigen::Matrix2d() << 0.001, 0, 0, 0).finished());
  system.stiffness[0] = fourier::resized(system.stiffness[0], 14);
  system.stiffness[0].c(1, 14) = system.stiffness[0].c(2, 14) = 5;
  const std::array<Eigen::Index, 1> slow{0};
  const ReducedSystem reduced = slave_to(scale_system(system, 1), slow, 1e-12);
  ASSERT_TRUE(reduced.converged);
  ASSERT_GE(reduced.alpha.num_harmonics(), 28);
  EXPECT_NEAR(std::abs(reduced.alpha.c(0, 28)), 25 / (1000.3 * 1000.3), 1e-3 * 25e-6);
  EXPECT_LT(std::abs(reduced.alpha.c(0, 20)), 1e-12);
  system.stiffness[0].c(0, 0) += 2 * 25 / (1000.3 * 1000.3);
  const Stability stability = analyse_stability(system, 1, {});
  EXPECT_GT(stability.growth_rate, 5e-7);
}

// With 32 samples A has harmonics up to 15: strong modulation takes more of them, a neighbour's solution all it has.
TEST(Slaving, GetsAsManyHarmonicsAsItTakes) {
  int with_more = 0;
  for (const double modulation : {0.1, 0.2, 0.25, 0.3}) {
    const Eigen::Matrix2d mean = (Eigen::Matrix2d() << 90, 9, 9, 700).finished(),
                          first = (Eigen::Matrix2d() << 90 * modulation, 20, 20, 600 * modulation).finished();
    const ScaledSystem system = scale_system(two_modes(0.1, mean, first), 1),
                       beside = scale_system(two_modes(0.1, 1.0001 * mean, first), 1);
    const std::array<Eigen::Index, 1> slow{0};
    const ReducedSystem reduced = slave_to(system, slow, 1e-12);
    ASSERT_TRUE(reduced.converged) << modulation;
    if (reduced.solved.solution.size() > 4 * 16) ++with_more;
    SampledStiffness stiffness(beside);
    const ReducedSystem begun = slave_to(stiffness, slow, 1e-12, false, reduced.solved),
                        alone = slave_to(beside, slow, 1e-12);
    ASSERT_TRUE(begun.converged && alone.converged) << modulation;
    EXPECT_LT(begun.iterations, alone.iterations) << modulation;
    const Eigen::Index H = std::min(begun.alpha.num_harmonics(), alone.alpha.num_harmonics());
    EXPECT_LE((begun.alpha.c.leftCols(H + 1) - alone.alpha.c.leftCols(H + 1)).cwiseAbs().maxCoeff(),
              begun.alpha_error(0) + alone.alpha_error(0));
  }
  EXPECT_GT(with_more, 0);
}

// Equal modes coupled by a ten-millionth: the residual of the reduction was weighed by the coupling alone, though it
// moves the fast mode by its size over the distance of the two frequencies.
TEST(Slaving, WeaklyCoupledEqualModesHaveErrorsThatHold) {
  const HillSystem system = two_modes(0.001, (Eigen::Matrix2d() << 0.7, 7e-8, 7e-8, 0.70000014).finished(),
                                      (Eigen::Matrix2d() << 0.21, 2.1e-8, 2.1e-8, 0.209999987).finished());
  // Of use beside the distance of the two exponents, 1.2e-7. Slaving converges here or not with the last bits of the
  // machine's arithmetic: its bar is 2e-11, that of the propagation which takes over 3e-15.
  for (const StabilityMethod method :
       {StabilityMethod::automatic, StabilityMethod::slaving, StabilityMethod::propagation})
    expect_covered(system, method, 3e-11);
}

// The rounding of all harmonics was summed as if each met the largest gain: 6e-14 to 1e-13.
TEST(Slaving, RoundingCountsWhereItReachesTheResonantHarmonic) {
  for (const double coupling : {0.1, 0.3}) {
    const HillSystem system = two_modes(0.01, (Eigen::Matrix2d() << 1.3, coupling, coupling, 5).finished(),
                                        (Eigen::Matrix2d() << 0.4, coupling, coupling, 1).finished());
    expect_covered(system, StabilityMethod::slaving, 2e-14);
  }
}

// In fewer corrections if it is any good.
TEST(Slaving, ARoughStartLeadsWhereZeroLeads) {
  const HillSystem system =
      two_modes(0.02, Eigen::Vector2d(2, 90).asDiagonal(), Eigen::Matrix2d{{0.3, 0.5}, {0.5, 2.0}});
  const ScaledSystem here = scale_system(system, 1), beside = scale_system(system, 1.02);
  SampledStiffness stiffness(here), stiffness_beside(beside);
  constexpr std::array<Eigen::Index, 1> slow{0};
  const ReducedSystem zero = slave_to(stiffness, slow, 0, false);
  SlavingStart start = slave_to(stiffness_beside, slow, 0, false).solved;
  start.rough = true;
  const auto compare = [&] {
    const ReducedSystem begun = slave_to(stiffness, slow, 0, false, start);
    EXPECT_TRUE(begun.converged);
    const FourierSeries apart = fourier::difference(begun.alpha, zero.alpha);
    EXPECT_LE(fourier::wiener_norm(apart, 0), begun.alpha_error(0, 0) + zero.alpha_error(0, 0));
    EXPECT_LE(begun.alpha_error(0, 0), 4 * zero.alpha_error(0, 0));
    return begun.iterations;
  };
  ASSERT_TRUE(zero.converged);
  EXPECT_LT(compare(), zero.iterations);
  start.solution *= 100;
  compare();
  start.solution.setConstant(HUGE_VAL);
  compare();
}

TEST(Slaving, ConstantCoefficientsReduceToOneModesCharacteristicEquation) {
  // Two coupled modes without modulation: the slow one alone has the roots of the whole that belong to it.
  const HillSystem system = two_modes(0.1, (Eigen::Matrix2d() << 1, 0.3, 0.3, 9).finished(), Eigen::Matrix2d::Zero());
  ScaledSystem scaled = scale_system(system, 1);
  // In the given coordinates, where the modes are coupled.
  scaled.K = system.stiffness[0];
  scaled.G = system.damping;
  const ReducedSystem reduced = slave_to(scaled, std::array<Eigen::Index, 1>{0});
  ASSERT_TRUE(reduced.converged);
  const double slow = 5 - std::sqrt(16 + 0.09);  // eigenvalue of the mean stiffness
  EXPECT_NEAR(reduced.alpha.c(0, 0).real(), slow, 1e-14);
  EXPECT_NEAR(reduced.beta.c(0, 0).real(), 0.1, 1e-14);
  EXPECT_LE(reduced.alpha_error.maxCoeff(), 1e-13);
}

// Of a system that grows by more than `least`: the growth rate within its error, and no word of stability.
template <class Reference>
void expect_growing(const HillSystem& system, const Reference& exact, const StabilityOptions& options, double least) {
  const double growth = double(exact.front().value.real());
  ASSERT_GT(growth, least);
  const Stability result = analyse_stability(system, 1, options);
  EXPECT_NE(result.verdict, Verdict::stable) << result.growth_rate << " +- " << result.growth_error;
  EXPECT_NEAR(result.growth_rate, growth, result.growth_error + double(exact.front().error));
}

// Coupled one way but for 1e-7, so that no step is taken; resonant to 1e-6 with what modulates both modes, to 0.1 by
// their means. The equations are nearer to a solution than is asked for, the exponents are not.
TEST(Slaving, ResonancesThatModulationShiftsAreSeenWithoutAStep) {
  HillSystem system = two_modes(1.2e-10, Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero());
  system.damping(0, 0) = 1.0458339046639649e-10;
  system.damping(1, 1) = 1.4431597237533822e-10;
  Eigen::MatrixXcd c(4, 3);
  c << 1075.0620960734027, cplx(-160.39783575989549, -123.70060256956175),
      cplx(-2.1881152461844793, 7.5789828735028495), -6.6503995675735842e-4,
      cplx(3.1413196239476652e-4, 3.3110226414909046e-4), cplx(1.0545050356167e-4, -2.8541434171832e-4),
      -6.1872775916459624e-8, cplx(-1.2972321896869581e-7, 1.5527723142343919e-7),
      cplx(-9.5052996869762583e-8, -9.5708398927393623e-8), 1648.1407973302084,
      cplx(158.12770178687285, 36.987863655699627), cplx(1.3764665216810645, -42.20407613655744);
  system.stiffness[0] = FourierSeries(c);
  const auto exact = reference::floquet_exponents(system, 1);
  expect_growing(system, exact, {}, 8e-10);
  const ScaledSystem scaled = scale_system(system, 1);
  for (const Eigen::Index mode : {0, 1}) {
    const std::array<Eigen::Index, 1> slow{mode};
    const ReducedSystem reduced = slave_to(scaled, slow, 1e-12);
    if (!reduced.converged) continue;
    const Exponents pair = reduced_exponents(reduced, 1e-9);
    for (std::size_t i = 0; i < pair.s.size(); ++i) EXPECT_LE(off(pair.s[i], exact), pair.error[i]) << mode;
  }
}

// Frequencies 23 apart, more than the harmonics that the slaved modes' motion has.
TEST(Slaving, ShiftedResonancesOfHighOrderAreSeen) {
  HillSystem system = two_modes(0, Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero());
  system.damping(0, 0) = 7.8053108520875879e-11;
  system.damping(1, 1) = 1.2207097479854549e-10;
  Eigen::MatrixXcd c(4, 3);
  c << 80.403665242637871, cplx(-9.9196574035869336, 3.4993474251964054),
      cplx(2.6639007211336527, -0.41395444560765043), -5.9496858265652565e-4,
      cplx(-7.5901115813978366e-5, -4.0197420800098057e-4), cplx(-1.4671184551259762e-4, -2.2989313522105091e-4),
      4.5301397546825114e-4, cplx(-3.7100095650527989e-4, -1.9884098558339583e-4),
      cplx(6.6544621172316809e-5, 2.7261270912455422e-4), 1048.2472945006787,
      cplx(-12.427334124963958, 226.37443151370704), cplx(48.678249251016098, -13.788457058846769);
  system.stiffness[0] = FourierSeries(c);
  expect_growing(system, reference::floquet_exponents(system, 1), {}, 1.3e-10);
}

// Three modes, each coupled to the next one alone and all resonant with each other: what is left of one equation comes
// back through two of them.
TEST(Slaving, ThreeModesThatMeetAreSeenTogether) {
  HillSystem system;
  system.mass = Eigen::Matrix3d::Identity();
  system.damping = Eigen::Vector3d(1.8081567699279399e-6, 2.1344596633437064e-6, 2.7270222510024918e-6).asDiagonal();
  Eigen::MatrixXcd c = Eigen::MatrixXcd::Zero(9, 2);
  c.row(0) << 441.22163187401526, cplx(-42.390370770302155, -66.250923454055339);
  c.row(2) << -5.0629207070003587e-4, cplx(7.3652369360048011e-4, 2.0697426880825526e-3);
  c.row(3) << 7.3932786773412895e-5, cplx(-8.8005577544073989e-5, 2.3718920192025217e-5);
  c.row(4) << 629.34822695506114, cplx(41.610121227620304, -116.97982143847877);
  c.row(7) << -9.1902739066367339e-5, cplx(1.2906786542298609e-5, 5.034612435190194e-5);
  c.row(8) << 617.14967723229074, cplx(-10.830752543415004, -21.495348401913414);
  system.stiffness[0] = FourierSeries(c);
  const auto exact = reference::floquet_exponents(system, 1);
  for (const StabilityMethod method : {StabilityMethod::automatic, StabilityMethod::slaving})
    expect_growing(system, exact, {.tolerance = 1e-7, .method = method}, 6.8e-8);
}

TEST(Slaving, StatesOfTheReductionAreMappedOntoThemselvesByATurn) {
  const HillSystem system = two_modes(0.05, (Eigen::Matrix2d() << 1.3, 0.2, 0.2, 20).finished(),
                                      (Eigen::Matrix2d() << 0.3, 0.4, 0.4, 2).finished());
  const ScaledSystem scaled = scale_system(system, 1);
  const ReducedSystem reduced = slave_to(scaled, std::array<Eigen::Index, 1>{0});
  ASSERT_TRUE(reduced.converged);
  // Sum of the two exponents of the reduced equation: minus the mean of beta; of the whole: minus the trace of G.
  const Stability whole = analyse_stability(scaled, {.method = StabilityMethod::propagation});
  double sum = 0;
  for (const Exponent& e : whole.exponents)
    if (e.mode == 0) sum += e.value.real();
  EXPECT_NEAR(sum, -reduced.beta.c(0, 0).real(), 1e-11);
}

TEST(Slaving, AModeInResonanceWithTheKeptOneIsRefused) {
  // Principal combination resonance of 1 and 2 at the speed 3.
  HillSystem system = two_modes(0.0, Eigen::Vector2d(1, 4).asDiagonal().toDenseMatrix(),
                                (Eigen::Matrix2d() << 0, 1.5, 1.5, 0).finished());
  const ScaledSystem scaled = scale_system(system, 3);
  EXPECT_FALSE(slave_to(scaled, std::array<Eigen::Index, 1>{0}).converged);
  Eigen::Index strongest = -1;
  EXPECT_GT(resonance_strength(scaled, std::array<Eigen::Index, 1>{0}).maxCoeff(&strongest), 1e-3);
  EXPECT_EQ(strongest, 1);
}

// Against the equations with products formed harmonic by harmonic.
TEST(Slaving, PairsAreInvertedWithWhatModulatesThem) {
  constexpr Eigen::Index band = slaving::PairInverse::band, pairs = 7, H = 15;  // 4 + 2 + 1 of them at once
  std::srand(5);
  slaving::PairInverse::Equations of{Eigen::MatrixXd::Random(pairs, 2 * band + 2),
                                     Eigen::MatrixXd::Random(pairs, 2 * band + 2), Eigen::VectorXd::Random(pairs),
                                     Eigen::VectorXd::Random(pairs)};
  of.fast.col(0) = Eigen::VectorXd::LinSpaced(pairs, 7, 60);
  of.slow.col(0) = Eigen::VectorXd::LinSpaced(pairs, 2, 3);
  of.fast.col(band + 1).setZero();
  of.slow.col(band + 1).setZero();
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Random(pairs, H + 1), C = Eigen::MatrixXcd::Random(pairs, H + 1);
  A.col(0) = A.col(0).real().cast<cplx>();
  C.col(0) = C.col(0).real().cast<cplx>();
  Eigen::MatrixXd re(2 * pairs, H + 1), im(2 * pairs, H + 1);
  for (Eigen::Index q = 0; q < pairs; ++q) {
    const auto harmonic = [](const auto& row, Eigen::Index k) -> cplx {
      if (std::abs(k) >= row.size()) return 0;
      return k < 0 ? std::conj(row(-k)) : row(k);
    };
    const Eigen::RowVectorXcd kappa = of.fast.row(q).head(band + 1) + cplx(0, 1) * of.fast.row(q).tail(band + 1),
                              alpha = of.slow.row(q).head(band + 1) + cplx(0, 1) * of.slow.row(q).tail(band + 1);
    const auto product = [&](const Eigen::RowVectorXcd& f, const Eigen::RowVectorXcd& x) {
      Eigen::RowVectorXcd result = Eigen::RowVectorXcd::Zero(H + 1);
      for (Eigen::Index k = 0; k <= H; ++k)
        for (Eigen::Index m = -band; m <= band; ++m) result(k) += harmonic(f, m) * harmonic(x, k - m);
      return result;
    };
    const Eigen::RowVectorXcd rate = cplx(0, 1) * Eigen::RowVectorXd::LinSpaced(H + 1, 0, H).cast<cplx>();
    const double g = of.fast_damping(q), b = of.slow_damping(q);
    const Eigen::RowVectorXcd P = rate.cwiseProduct(A.row(q)) - product(alpha, C.row(q)),
                              R = A.row(q) + rate.cwiseProduct(C.row(q)) - b * C.row(q);
    const Eigen::RowVectorXcd r1 = rate.cwiseProduct(P) + g * P - product(alpha, R) + product(kappa, A.row(q)),
                              r2 = P + rate.cwiseProduct(R) + (g - b) * R + product(kappa, C.row(q));
    re.row(q) = r1.real(), im.row(q) = r1.imag();
    re.row(pairs + q) = r2.real(), im.row(pairs + q) = r2.imag();
  }
  slaving::PairInverse inverse(pairs, H);
  inverse.factorise(of);
  const Eigen::VectorXd weight = Eigen::VectorXd::LinSpaced(pairs, 1, 2);
  Eigen::VectorXd step(4 * pairs * (H + 1));
  inverse.solve({re.data(), im.data(), 2 * pairs}, weight.data(), step.data());
  for (Eigen::Index k = 0; k <= H; ++k)
    for (Eigen::Index q = 0; q < pairs; ++q) {
      const auto part = [&](Eigen::Index p) { return step(4 * pairs * k + pairs * p + q); };
      EXPECT_LT(std::abs(cplx(part(0), part(2)) + A(q, k)), 1e-11) << q << ' ' << k;
      EXPECT_LT(std::abs(cplx(part(1), part(3)) + weight(q) * C(q, k)), 1e-11) << q << ' ' << k;
    }
}

// The constant part of the equations alone takes 15 to 27 steps.
TEST(Slaving, TakesFewStepsWhereModesAreStronglyModulated) {
  for (const double modulation : {0.1, 0.2, 0.3}) {
    const Eigen::Matrix2d mean = (Eigen::Matrix2d() << 90, 9, 9, 700).finished(),
                          first = (Eigen::Matrix2d() << 90 * modulation, 20, 20, 600 * modulation).finished();
    const std::array<Eigen::Index, 1> slow{0};
    const ReducedSystem reduced = slave_to(scale_system(two_modes(0.1, mean, first), 1), slow, 1e-12);
    EXPECT_TRUE(reduced.converged) << modulation;
    EXPECT_LT(reduced.iterations, 12) << modulation;
  }
}

// Of n unknowns n secants say all: long before the window is full.
TEST(Slaving, MixingSolvesLinearEquationsInAsManySteps) {
  const Eigen::Matrix3d A = (Eigen::Matrix3d() << 3, 1, 0, -1, 2, 0.5, 0, 0.5, 4).finished();
  const Eigen::Vector3d b(1, 2, 3);
  Anderson anderson;
  Eigen::VectorXd x = Eigen::Vector3d::Zero();
  for (int step = 0; step < 4; ++step) x = anderson.step(x, b - A * x);
  EXPECT_LT((A * x - b).norm(), 1e-12);
}

}  // namespace
}  // namespace hb
