// What the engine's cell maps and QR steps round, measured in units of hb/engine/README.md (E11).
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "hb/engine/exponents/qr_sweep.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/slaving.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "lib/constants.hpp"
#include "tools/attack/families.hpp"
#include "tools/attack/long_radau.hpp"

namespace hb::attack {
namespace {

using Eigen::Index;

// Errors over epsilon T.
struct Rounding {
  double count = 0, squares = 0, largest = 0;
  double alike = 0;  // sum over entries of N times the square of the mean over the cells, without what chance gives
  double steps = 0, step_squares = 0;  // QR: entries of Q R - Phi Q over 0.6 epsilon |R|/sqrt(n)

  void add(const TurnMaps& maps, const std::vector<LongMatrix>& exact) {
    const Index n = maps.num_states(), N = maps.num_cells;
    for (Index q = 0; q < n * n; ++q) {
      double sum = 0, sum_squares = 0;
      for (Index i = 0; i < N; ++i) {
        const auto map = maps.cells.middleCols(n * i, n);
        const double T = std::min(maps.terms(q), map.norm());
        if (T == 0) continue;
        const double error = double(map(q % n, q / n) - exact[std::size_t(i)](q)) / (eps * T);
        sum += error;
        sum_squares += error * error;
        largest = std::max(largest, std::abs(error));
        ++count;
      }
      squares += sum_squares;
      alike += (sum * sum - sum_squares) / double(N - 1);
    }
  }
  void add(const TurnMaps& maps, const QrSweep& sweep) {
    const Index n = maps.num_states();
    for (Index i = 0; i < maps.num_cells; ++i) {
      const auto part = [&](const Eigen::MatrixXd& all, Index k) {
        return LongMatrix(all.middleCols(n * k, n).cast<long double>());
      };
      const LongMatrix rest =
          part(sweep.frames, i + 1) * part(sweep.R, i) - part(maps.cells, i) * part(sweep.frames, i);
      const double unit = 0.6 * eps * sweep.R.middleCols(n * i, n).norm() / std::sqrt(double(n));
      step_squares += double(rest.squaredNorm()) / (unit * unit);
      steps += double(n * n);
    }
  }
};

// The modes of one case, all propagated with about as many cells as the engine takes.
void measure(const Case& c, Rounding& rounding) {
  const ScaledSystem system = scale_system(c.system, c.speed);
  std::vector<Index> all(std::size_t(system.num_modes()));
  std::iota(all.begin(), all.end(), Index(0));
  const ReducedSystem whole = slave_to(system, all);
  const double fastest = std::sqrt(system.mean_diagonal().cwiseAbs().maxCoeff());
  constexpr Index most_cells = 400;
  const Index cells = radau_cells(std::max<Index>(16, Index(fastest)));
  if (cells > most_cells) return;
  const TurnMaps maps = radau_turn(whole.alpha, whole.beta, whole.num_modes, cells);
  rounding.add(maps, long_radau_turn(whole.alpha, whole.beta, cells, maps.scale));
  if (whole.num_modes > 1) rounding.add(maps, qr_sweep(maps.cells, {}));
}

// Whether what errors are made of is as was measured. Not so where cells need pivots, see there; the engine takes
// one-way systems apart before.
bool as_described(Family family, const Rounding& r) {
  if (family == Family::non_normal || family == Family::one_way || family == Family::shifted) return true;
  return std::sqrt(r.squares / r.count) < 0.75 && r.largest < 20 && r.alike < 0.25 * r.squares;
}

int run(int cases, std::uint64_t seed) {
  fmt::print("{:<12} {:>9} {:>9} {:>9} {:>7} {:>9}\n", "family", "entries", "rms", "largest", "alike", "QR rms");
  bool held = true;
  for (int f = 0; f < num_families; ++f) {
    Rounding rounding;
    for (int k = 0; k < cases; ++k) measure(random_case(Family(f), seed * 1000000 + std::uint64_t(k)), rounding);
    const bool described = as_described(Family(f), rounding);
    held = held && described;
    fmt::print("{:<12} {:>9} {:>9.3g} {:>9.3g} {:>7.3f} {:>9.3f}{}\n", names[std::size_t(f)], rounding.count,
               std::sqrt(rounding.squares / rounding.count), rounding.largest, rounding.alike / rounding.squares,
               std::sqrt(rounding.step_squares / std::max(rounding.steps, 1.0)), described ? "" : "  MORE THAN SAID");
  }
  return held ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  CLI::App app{"Rounding of cell maps against maps in 80 bits, over epsilon T"};
  int cases = 25;
  std::uint64_t seed = 31;
  app.add_option("--cases", cases, "of each family");
  app.add_option("--seed", seed, "which cases");
  CLI11_PARSE(app, argc, argv);
  return hb::attack::run(cases, seed);
}
