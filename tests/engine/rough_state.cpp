// Periodic answers to a few digits: what more modes add to an answer that is known.
#include "hb/engine/steady/rough_state.hpp"

#include <gtest/gtest.h>

#include "hb/engine/steady/steady_state.hpp"

namespace hb {
namespace {

// Three modes, the third one coupled to the others by so much.
HillSystem three_modes(double coupling) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(3, 3);
  system.damping = 0.02 * Eigen::MatrixXd::Identity(3, 3);
  FourierSeries K(9, 2);
  K.c(0, 0) = 1.7;
  K.c(4, 0) = 5.3;
  K.c(8, 0) = 40;
  K.c(0, 1) = {0.2, 0.1};
  K.c(1, 1) = K.c(3, 1) = {0.3, -0.1};
  K.c(4, 2) = {0.1, 0.2};
  for (const Eigen::Index entry : {2, 5, 6, 7}) K.c(entry, 1) = coupling * std::complex<double>(1, 0.5);
  system.stiffness[0] = K;
  FourierSeries load(3, 2);
  load.c(0, 0) = 1;
  load.c(0, 1) = {0.4, 0.3};
  load.c(1, 2) = {-0.2, 0.5};
  system.load[0] = load;
  return system;
}

HillSystem first_two(const HillSystem& all) {
  HillSystem two;
  two.mass = all.mass.topLeftCorner(2, 2);
  two.damping = all.damping.topLeftCorner(2, 2);
  FourierSeries K(4, all.stiffness[0].num_harmonics());
  for (Eigen::Index j = 0; j < 2; ++j) K.c.middleRows(2 * j, 2) = all.stiffness[0].c.middleRows(3 * j, 2);
  two.stiffness[0] = K;
  two.load[0] = FourierSeries(Eigen::MatrixXcd(all.load[0].c.topRows(2)));
  return two;
}

// However small it is: an iteration that ends where the answer of fewer modes solves the system well enough would say
// that the third mode adds nothing.
TEST(RoughState, TellsWhatMoreModesAdd) {
  constexpr double speed = 1, tolerance = 1e-7;
  for (const double coupling : {1e-2, 1e-5, 1e-8}) {
    const HillSystem system = three_modes(coupling);
    const SteadyOptions accurate{.tolerance = 1e-13};
    const FourierSeries few = solve_steady_state(first_two(system), speed, accurate).q;
    const FourierSeries exact = solve_steady_state(system, speed, accurate).q;
    const auto rough = RoughSolver(system, speed).solve(system.load[0], tolerance, &few);
    ASSERT_TRUE(rough);
    const double size = fourier::max_abs(exact, 2).value;
    EXPECT_NEAR(fourier::max_abs(*rough, 2).value, size, 0.01 * size) << coupling;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double largest = fourier::max_abs(exact, i).value;
      EXPECT_NEAR(fourier::max_abs(*rough, i).value, largest, 1e-5 * largest) << coupling;
    }
  }
}

}  // namespace
}  // namespace hb
