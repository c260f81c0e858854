// How run time grows with the number of modes, harmonics and points, as CSV on standard output. The yardstick of the
// same run is Eigen's product of 512 x 512 matrices: `of_dgemm` is the rate of the method's own floating-point
// operations relative to it.
#include <sys/resource.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <string>

#include "dense_hill.hpp"
#include "hb/engine/boundaries/stability_map.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "synthetic.hpp"
#include "timing.hpp"

namespace hb::benchmarks {

namespace {

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void row(const char* what, long modes, long harmonics, long points, double error, const Timing& timing,
         double of_dgemm) {
  std::printf("%s,%ld,%ld,%ld,%.3e,%.4e,%.4e,%.3f,%.1f\n", what, modes, harmonics, points, error, timing.best,
              timing.median, of_dgemm, peak_megabytes());
  std::fflush(stdout);
}

// x'' + 0.1 x' + (1.2 + swing cos Omega t) x = 0.
std::optional<ScaledSystem> mathieu(double Omega, double swing) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, 0.1);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c << 1.2, swing / 2;
  return scale_system(system, Omega);
}

// Two systems that do not feel each other as one.
HillSystem beside(const HillSystem& a, const HillSystem& b) {
  const Eigen::Index m = a.num_modes(), n = b.num_modes(), I = m + n;
  HillSystem both;
  both.mass = both.damping = Eigen::MatrixXd::Zero(I, I);
  both.mass.topLeftCorner(m, m) = a.mass;
  both.mass.bottomRightCorner(n, n) = b.mass;
  both.damping.topLeftCorner(m, m) = a.damping;
  both.damping.bottomRightCorner(n, n) = b.damping;
  both.stiffness[0] = FourierSeries(I * I, a.stiffness[0].num_harmonics());
  for (Eigen::Index j = 0; j < m; ++j)
    for (Eigen::Index i = 0; i < m; ++i) both.stiffness[0].c.row(i + I * j) = a.stiffness[0].c.row(i + m * j);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) both.stiffness[0].c.row(m + i + I * (m + j)) = b.stiffness[0].c.row(i + n * j);
  return both;
}

std::vector<double> spaced(double from, double to, int n) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(from + (to - from) * k / (n - 1));
  return values;
}

}  // namespace

}  // namespace hb::benchmarks

int main() {
  using namespace hb;
  using namespace hb::benchmarks;
  const double rate = dgemm_rate();
  std::printf("%s; Eigen's DGEMM %.1f GFlop/s\n", header().c_str(), rate * 1e-9);
  std::printf("what,modes,harmonics,points,error,seconds_min,seconds_median,of_dgemm,peak_megabytes\n");

  // Elimination of 8 I unknowns with 2 I right-hand sides per cell; error: against twice the cells, all of the turn.
  for (const Eigen::Index I : {1, 2, 5, 10, 20, 40}) {
    const ScaledSystem system = scale_system(synthetic(I), 1);
    FourierSeries beta(I * I, 0);
    for (Eigen::Index i = 0; i < I; ++i) beta.c(i + I * i, 0) = system.G(i, i);
    const Eigen::Index cells = radau_cells(std::max<Eigen::Index>(12, 3 * I));
    const auto turn = [&](Eigen::Index n) {
      const TurnMaps maps = radau_turn(system.K, beta, I, n);
      Eigen::MatrixXd product = Eigen::MatrixXd::Identity(2 * I, 2 * I);
      for (Eigen::Index c = 0; c < maps.num_cells; ++c)
        product = (maps.cells.middleCols(2 * I * c, 2 * I) * product).eval();
      return product;
    };
    const Eigen::MatrixXd fine = turn(radau_cells(2 * cells));
    const double error = (turn(cells) - fine).norm() / fine.norm();
    const Timing timing = timed([&] { (void)radau_turn(system.K, beta, I, cells); });
    const double n = 8.0 * static_cast<double>(I), right = 2.0 * static_cast<double>(I);
    const double flops = static_cast<double>(cells) * (2.0 / 3 * n * n * n + 2 * n * n * right);
    row("radau_turn", I, system.K.num_harmonics(), cells, error, timing, flops / timing.best / rate);
  }
  // Harmonics asked for, I = 5.
  const HillSystem five = synthetic(5);
  const SteadyState exact = solve_steady_state(five, 1, {.tolerance = 1e-13});
  for (const auto& [name, method] :
       {std::pair{"steady_direct", SteadyMethod::direct}, std::pair{"steady_iterative", SteadyMethod::iterative}})
    for (const int H : {32, 64, 128, 256, 512}) {
      const SteadyOptions options{.tolerance = 1e-12, .num_harmonics = H, .method = method};
      const SteadyState state = solve_steady_state(five, 1, options);
      row(name, 5, state.num_harmonics, 1, relative_error(state.q, exact.q),
          timed([&] { (void)solve_steady_state(five, 1, options); }), 0);
    }
  // What is saved by taking apart what does not belong together: the same systems with a coupling of 1e-12 that forbids
  // it. Error: difference of the growth rates.
  const auto stability_rows = [](const char* with, const char* without, const HillSystem& apart,
                                 const HillSystem& together, const StabilityOptions& options) {
    const double a = analyse_stability(apart, 1, options).growth_rate, b = analyse_stability(together, 1).growth_rate;
    row(with, apart.num_modes(), apart.stiffness[0].num_harmonics(), 1, std::abs(a - b),
        timed([&] { (void)analyse_stability(apart, 1, options); }), 0);
    row(without, together.num_modes(), together.stiffness[0].num_harmonics(), 1, 0,
        timed([&] { (void)analyse_stability(together, 1); }), 0);
  };
  HillSystem groups = beside(synthetic(4), synthetic(4));
  HillSystem coupled = groups;
  coupled.stiffness[0].c(8 * 4, 1) = coupled.stiffness[0].c(4, 1) = 1e-12;
  stability_rows("groups_apart", "groups_together", groups, coupled, {});
  HillSystem even = synthetic(4);
  even.stiffness[0].c.col(1).setZero();
  HillSystem odd = even;
  odd.stiffness[0].c(0, 1) = 1e-12;
  stability_rows("shorter_period", "whole_period", even, odd, {});
  HillSystem damped = synthetic(4);
  for (Eigen::Index i = 0; i < 4; ++i) damped.damping(i, i) *= 25;
  stability_rows("verdict_alone", "exponents", damped, damped, {.verdict_only = true});
  // Points of a map on one thread, and the memory of the process; error: the largest that a boundary point claims.
  for (const int n : {10, 32, 100, 316, 1000}) {
    StabilityMap map;
    const Timing timing = timed([&] { map = stability_map(mathieu, spaced(1, 3, n), spaced(0.05, 0.6, n)); }, 1);
    double error = 0;
    for (const BoundaryCurve& curve : map.boundaries)
      for (const BoundaryPoint& p : curve.points) error = std::max(error, p.error / (p.along_x ? p.x : p.y));
    row("map_mathieu", 1, 1, static_cast<long>(n) * n, error, timing, 0);
  }
}
