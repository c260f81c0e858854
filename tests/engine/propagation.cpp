// Propagation of one turn and the exponents of its cell maps: order of the collocation, Liouville's formula, QR sweeps
// where the product itself has lost its small multipliers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hb/engine/exponents/cell_chain.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/exponents/turn_exponents.hpp"

namespace {

using namespace hb;
using cplx = std::complex<double>;

constexpr double turn = 2 * std::numbers::pi;

// Diagonal x'' + b_i x' + (a_i + swing cos tau) x = 0.
struct Uncoupled {
  FourierSeries alpha, beta;

  Uncoupled(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double swing)
      : alpha(a.size() * a.size(), swing == 0 ? 0 : 1), beta(b.size() * b.size(), 0) {
    const Eigen::Index m = a.size();
    for (Eigen::Index i = 0; i < m; ++i) {
      alpha.c(i * m + i, 0) = a(i);
      beta.c(i * m + i, 0) = b(i);
      if (swing != 0) alpha.c(i * m + i, 1) = 0.5 * swing;
    }
  }
};

// Product of the cell maps, last cell on the left.
Eigen::MatrixXd product(const TurnMaps& maps) {
  const Eigen::Index n = maps.num_states();
  Eigen::MatrixXd P = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index k = 0; k < maps.num_cells; ++k) P = (maps.cells.middleCols(k * n, n) * P).eval();
  return P;
}

TurnMaps maps_of(const Uncoupled& system, Eigen::Index m, Eigen::Index cells) {
  return radau_turn(system.alpha, system.beta, m, radau_cells(cells));
}

TEST(RadauTurn, ErrorOfAStiffModeFallsWithTheFifteenthPowerOfTheCell) {
  const double w = 40, b = 0.02;
  const Uncoupled system(Eigen::VectorXd::Constant(1, w * w), Eigen::VectorXd::Constant(1, b), 0);
  const double damped = std::sqrt(w * w - b * b / 4);
  const double trace = 2 * std::exp(-b / 2 * turn) * std::cos(damped * turn);
  double last_error = 0, last_cells = 0;
  int compared = 0;
  for (Eigen::Index least = 8; least <= 200; least = static_cast<Eigen::Index>(last_cells) + 1) {
    const TurnMaps maps = maps_of(system, 1, least);
    const double error = std::abs(product(maps).trace() - trace), cells = static_cast<double>(maps.num_cells);
    if (last_error < 1e-3 && last_error > 1e-9 && error > 1e-11) {
      const double order = std::log(last_error / error) / std::log(cells / last_cells);
      EXPECT_NEAR(order, 15, 1.5) << cells;
      ++compared;
    }
    last_error = error;
    last_cells = cells;
  }
  EXPECT_GE(compared, 2);
  EXPECT_LT(last_error, 1e-11);
}

// What is left of an oscillator without damping over a turn, by so many cells.
TEST(RoughRadauTurn, DampsAnOscillatorAsItsCellsTell) {
  for (const double w : {0.9, 3.3, 20.3})
    for (const double error : {1e-2, 1e-4, 1e-7}) {
      const Uncoupled system(Eigen::VectorXd::Constant(1, w * w), Eigen::VectorXd::Zero(1), 0);
      const Eigen::Index least = static_cast<Eigen::Index>(std::ceil(rough_oscillator_cells(w, error)));
      const Eigen::Index cells = radau_cells(least);
      const TurnMaps maps = rough_radau_turn(system.alpha, system.beta, 1, cells);
      const double decay = -std::log(product(maps).determinant()) / (2 * turn);
      const double told = error * std::pow(rough_oscillator_cells(w, error) / static_cast<double>(cells), 7);
      EXPECT_NEAR(decay, told, 0.25 * told + 1e-13) << w << ' ' << error;
    }
}

TEST(RoughRadauTurn, UnresolvedFastModesVanish) {
  const Uncoupled system(Eigen::VectorXd::Constant(1, 1e16), Eigen::VectorXd::Constant(1, 1e3), 0);
  EXPECT_LT(product(rough_radau_turn(system.alpha, system.beta, 1, 8)).cwiseAbs().maxCoeff(), 1e-3);
}

// Of coupled modes, one to nine: nearer to the maps of eight stages by 2^7 with twice the cells.
TEST(RoughRadauTurn, ConvergesWithTheSeventhPowerOfTheCell) {
  for (const Eigen::Index m : {1, 2, 3, 4, 9}) {
    FourierSeries alpha(m * m, 2), beta(m * m, 0);
    for (Eigen::Index j = 0; j < m; ++j)
      for (Eigen::Index i = 0; i < m; ++i) {
        const double x = static_cast<double>(i - j), own = i == j ? 1 : 0;
        alpha.c(i + m * j, 0) = own * std::pow(1.3 + 0.4 * static_cast<double>(i), 2);
        alpha.c(i + m * j, 1) = cplx(0.2, 0.1 * x);
        alpha.c(i + m * j, 2) = cplx(0.05 * x, 0.1);
        beta.c(i + m * j, 0) = 0.1 * own;
      }
    const auto error = [&](Eigen::Index cells) {
      const Eigen::MatrixXd fine = product(radau_turn(alpha, beta, m, 64));
      return (product(rough_radau_turn(alpha, beta, m, cells)) - fine).norm() / fine.norm();
    };
    const double coarse = error(16), finer = error(32);
    EXPECT_LT(coarse, 1e-2) << m;
    EXPECT_NEAR(std::log2(coarse / finer), 7, 1) << m;
  }
}

TEST(RadauTurn, UnresolvedFastModesVanish) {
  const Uncoupled system(Eigen::VectorXd::Constant(1, 1e16), Eigen::VectorXd::Constant(1, 1e3), 0);
  EXPECT_LT(product(maps_of(system, 1, 8)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(RadauTurn, DeterminantIsThatOfLiouville) {
  const Uncoupled system(Eigen::Vector2d(1.3, 7.1), Eigen::Vector2d(0.05, 0.11), 0.4);
  const TurnMaps maps = maps_of(system, 2, 24);
  EXPECT_NEAR(maps.damping_trace, 0.16, 1e-15);
  EXPECT_NEAR(std::log(product(maps).determinant()), -turn * 0.16, 1e-12);
}

TEST(TurnExponents, AreThoseOfTheConstantSystemFolded) {
  const Eigen::Vector3d a(1.21, 30, 5.3), b(0.02, 0.3, 4.8);  // the last overdamped
  const Uncoupled system(a, b, 0);
  const TurnMaps maps = maps_of(system, 3, 48);
  const TurnExponents found = turn_exponents(maps, Eigen::MatrixXd::Zero(6, 6));
  ASSERT_EQ(found.s.size(), 6u);
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      cplx s = -b(i) / 2 + sign * std::sqrt(cplx(b(i) * b(i) / 4 - a(i)));
      s = {s.real(), s.imag() - std::round(s.imag())};
      double nearest = HUGE_VAL, bar = 0;
      for (std::size_t k = 0; k < found.s.size(); ++k) {
        cplx d = found.s[k] - s;
        d = {d.real(), d.imag() - std::round(d.imag())};
        if (std::abs(d) < nearest) {
          nearest = std::abs(d);
          bar = found.error[k];
        }
      }
      // The maps themselves are known to the collocation's error.
      EXPECT_LE(nearest, bar + 1e-12) << s;
    }
  }
  for (std::size_t k = 1; k < found.s.size(); ++k) EXPECT_GE(found.s[k - 1].real(), found.s[k].real());
}

// Of one mode, of several and of the leading ones alone: those that have errors, with none.
TEST(TurnExponents, ValuesAloneAreTheSame) {
  for (const Eigen::Index m : {1, 2, 3}) {
    const Eigen::VectorXd a = Eigen::Vector3d(1.21, 30, 5.3).head(m), b = Eigen::Vector3d(0.02, 0.3, 4.8).head(m);
    const TurnMaps maps = maps_of(Uncoupled(a, b, 0.3), m, 48);
    for (const bool leading_only : {false, true}) {
      const TurnExponents full = turn_exponents(maps, Eigen::MatrixXd::Zero(2 * m, 2 * m), leading_only),
                          values = turn_values(maps, leading_only);
      EXPECT_EQ(values.others_below, HUGE_VAL);
      ASSERT_GE(values.s.size(), full.s.size());
      for (std::size_t k = 0; k < full.s.size(); ++k) {
        double nearest = HUGE_VAL;
        for (const cplx& s : values.s) nearest = std::min(nearest, std::abs(s - full.s[k]));
        EXPECT_LE(nearest, full.error[k]) << m << ' ' << full.s[k];
      }
      for (const double error : values.error) EXPECT_EQ(error, HUGE_VAL);
      EXPECT_EQ(values.subspaces.size() > 0, m > 1 && !leading_only);
    }
  }
}

// N numbers as a chain, each of the deviation and error given.
CellChain chain_of(const Eigen::RowVectorXd& factors, double deviation, double given) {
  const Eigen::Index N = factors.size();
  return {factors, Eigen::MatrixXd::Constant(1, N, deviation * deviation), Eigen::MatrixXd::Constant(1, N, given),
          Eigen::MatrixXd::Identity(1, 1)};
}

TEST(CellChain, JoinedCellsHaveTheProductAndItsErrors) {
  const Eigen::RowVectorXd d = Eigen::RowVectorXd::LinSpaced(8, 0.8, 1.5);
  const double deviation = 3, given = 1e-9;
  const CellChain chain = joined(chain_of(d, deviation, given), 0.1);
  ASSERT_EQ(chain.joined, 4);
  ASSERT_EQ(chain.num_cells(), 2);
  for (Eigen::Index c = 0; c < 2; ++c) {
    const Eigen::RowVectorXd own = d.segment(4 * c, 4);
    EXPECT_NEAR(chain.factors(c), own.prod(), 4e-15);
    EXPECT_NEAR(chain.given(c) / own.prod(), given * own.cwiseInverse().sum(), 1e-20);
    // Of the sum of deviations, with that of the products: 0.35 each and little beside 3.
    const double sum = deviation * own.cwiseInverse().sum(), all = std::sqrt(chain.rounding(c)) / own.prod();
    EXPECT_GT(all, sum);
    EXPECT_LT(all, 1.02 * sum);
  }
}

// Of maps that do not commute the later one stands on the left, with its errors.
TEST(CellChain, JoinsInOrder) {
  const Eigen::Matrix2d first = (Eigen::Matrix2d() << 1, 2, 0, 1).finished(),
                        second = (Eigen::Matrix2d() << 1, 0, 3, 1).finished(),
                        in_first = (Eigen::Matrix2d() << 1e-9, 0, 0, 0).finished(),
                        in_second = (Eigen::Matrix2d() << 0, 0, 0, 2e-9).finished();
  const auto beside = [](const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
    return (Eigen::MatrixXd(2, 4) << a, b).finished();
  };
  const CellChain chain = joined({beside(first, second), beside(1e20 * in_first, 1e20 * in_second),
                                  beside(in_first, in_second), Eigen::Matrix2d::Identity()},
                                 0);
  ASSERT_EQ(chain.joined, 2);
  EXPECT_EQ(chain.factors, second * first);
  EXPECT_TRUE(chain.given.isApprox(second * in_first + in_second * first, 1e-15)) << chain.given;
  const Eigen::Matrix2d early = second.cwiseAbs2() * (1e20 * in_first), late = (1e20 * in_second) * first.cwiseAbs2();
  EXPECT_TRUE(chain.rounding.isApprox((early.cwiseSqrt() + late.cwiseSqrt()).cwiseAbs2(), 1e-9)) << chain.rounding;
}

TEST(CellChain, IsJoinedNoFurtherThanProductsKeepWhatIsSmall) {
  const CellChain mild = chain_of(Eigen::RowVectorXd::Constant(8, 1.1), 1, 0);
  EXPECT_EQ(joined(mild, 1).joined, 4);
  EXPECT_EQ(joined(mild, 1.5).joined, 2);
  EXPECT_EQ(joined(mild, 2.5).joined, 1);
  EXPECT_EQ(joined(mild, HUGE_VAL).joined, 1);
  EXPECT_EQ(joined(chain_of(Eigen::RowVectorXd::Constant(8, 2.5), 1, 0), 0).joined, 2);
  EXPECT_EQ(joined(chain_of(Eigen::RowVectorXd::Constant(6, 1.1), 1, 0), 0).joined, 2);
  EXPECT_EQ(joined(chain_of(Eigen::RowVectorXd::Constant(7, 1.1), 1, 0), 0).joined, 1);
}

// The same exponents as cell by cell, with bars of about the same size.
TEST(TurnExponents, OfJoinedCellsAreThoseOfTheCells) {
  for (const Eigen::Index m : {2, 3, 4}) {
    const Eigen::VectorXd a = Eigen::Vector4d(1.21, 30, 5.3, 3.1).head(m),
                          b = Eigen::Vector4d(0.02, 0.3, 2.4, 0.1).head(m);
    Uncoupled system(a, b, 0.3);
    for (Eigen::Index i = 0; i + 1 < m; ++i)  // coupled, one way stronger than back
      for (const auto& [entry, size] : {std::pair(i + m * (i + 1), 0.2), std::pair(i + 1 + m * i, 0.05)})
        system.alpha.c(entry, 1) = size;
    TurnMaps maps = maps_of(system, m, 64);
    for (const double wrong : {0.0, 1e-13})
      for (const bool leading_only : {false, true}) {
        const Eigen::MatrixXd given = Eigen::MatrixXd::Constant(2 * m, 2 * m, wrong);
        const double damping = maps.damping;
        const TurnExponents found = turn_exponents(maps, given, leading_only);
        maps.damping = HUGE_VAL;
        const TurnExponents singly = turn_exponents(maps, given, leading_only);
        maps.damping = damping;
        EXPECT_LT(damping, 1);  // joined by fours
        ASSERT_EQ(found.s.size(), singly.s.size());
        for (std::size_t k = 0; k < found.s.size(); ++k) {
          EXPECT_LE(std::abs(found.s[k] - singly.s[k]), found.error[k]) << m << ' ' << k;
          EXPECT_GT(found.error[k], 0.5 * singly.error[k]) << m << ' ' << k;
          EXPECT_LT(found.error[k], 2 * singly.error[k]) << m << ' ' << k;
        }
      }
  }
}

// Turns that would take too many cells.
TEST(PropagatedExponents, LeaveNothingBoundedThatIsNotComputed) {
  const Eigen::VectorXd w2 = Eigen::Vector2d(1, 1e12), b = Eigen::Vector2d(0.02, 0.2);
  const Uncoupled system(w2, b, 0);
  ReducedSystem reduced;
  reduced.num_modes = 2;
  reduced.alpha = system.alpha;
  reduced.beta = system.beta;
  reduced.alpha_error = reduced.beta_error = Eigen::MatrixXd::Zero(2, 2);
  for (const double w : {1e6, 1e8}) {
    reduced.alpha.c(3, 0) = w * w;
    for (const bool leading_only : {false, true}) {
      const Exponents found = propagated_exponents(reduced, 1e-6, leading_only);
      EXPECT_TRUE(!found.s.empty() || found.others_below == HUGE_VAL) << w << ' ' << leading_only;
    }
  }
}

TEST(TurnExponents, SweepsKeepMultipliersThatTheProductLoses) {
  // Multipliers e^(-2 pi 0.05) and e^(-2 pi 9): 2.7e-25 is below the rounding of any product of the maps. Turned by 0.5
  // rad, so that both modes stand in every entry.
  Eigen::Matrix2d turned, alpha = Eigen::Vector2d(4.0025, 81.49).asDiagonal(),
                          beta = Eigen::Vector2d(0.1, 18).asDiagonal();
  turned << std::cos(0.5), -std::sin(0.5), std::sin(0.5), std::cos(0.5);
  alpha = (turned * alpha * turned.transpose()).eval();
  beta = (turned * beta * turned.transpose()).eval();
  FourierSeries a(4, 0), b(4, 0);
  a.c.col(0).real() = alpha.reshaped();
  b.c.col(0).real() = beta.reshaped();
  const TurnMaps maps = radau_turn(a, b, 2, radau_cells(64));
  const TurnExponents found = turn_exponents(maps, Eigen::MatrixXd::Zero(4, 4));
  ASSERT_EQ(found.s.size(), 4u);
  EXPECT_NEAR(found.s[2].real(), -9, 1e-10);
  EXPECT_NEAR(found.s[3].real(), -9, 1e-10);
  EXPECT_NEAR(std::abs(found.s[2].imag()), std::abs(0.7 - std::round(0.7)), 1e-10);
  EXPECT_LT(found.error[3], 1e-8);
  const Eigen::VectorXcd multipliers = product(maps).eigenvalues();
  const double least = std::log(multipliers.cwiseAbs().minCoeff()) / turn;
  EXPECT_GT(std::abs(least + 9), 1e-6) << "the product alone would have done";
}

// A leading subspace came back to 1e-13 only, and what that does was told too small by the growth over the last cell.
TEST(TurnExponents, SubspacesThatHaveNotQuiteComeBackCostNoAccuracy) {
  FourierSeries alpha(4, 0), beta(4, 0);
  alpha.c.col(0).real() = Eigen::Vector4d(-0.30, -0.02425, -1.2, -0.185);
  const Eigen::Matrix2d growth2 = -Eigen::Map<const Eigen::Matrix2d>(Eigen::MatrixXd(alpha.c.col(0).real()).data());
  const double half = growth2.trace() / 2, root = std::sqrt(half * half - growth2.determinant());
  const std::vector<double> exact = {std::sqrt(half + root), std::sqrt(half - root), -std::sqrt(half - root),
                                     -std::sqrt(half + root)};
  const TurnMaps maps = radau_turn(alpha, beta, 2, radau_cells(12));
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(4, 4);
  const Eigen::MatrixXd settled = turn_exponents(maps, none).subspaces;
  for (const double turned : {0.0, 5e-13, 1e-12, 2e-12}) {
    Eigen::MatrixXd start = settled;
    start.col(0) += turned * settled.col(1);
    start.col(1) -= turned * settled.col(0);
    const TurnExponents found = turn_exponents(maps, none, false, start);
    ASSERT_EQ(found.s.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(found.s[i].real(), exact[i], std::min(found.error[i], 2e-15)) << turned << ' ' << i;
      EXPECT_LT(found.error[i], 2e-14) << turned << ' ' << i;
    }
  }
}

}  // namespace
