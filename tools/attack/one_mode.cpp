// Maps of one random mode each, told by the discriminant, against single answers and propagation.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "hb/engine/boundaries/stability_map.hpp"
#include "lib/stopwatch.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tools/attack/case_flags.hpp"

namespace hb::attack {
namespace {

using stress::Random;

struct Options {
  int cases = 2, first = 0;
  double seconds = HUGE_VAL;
  std::uint64_t seed = 1;
};

enum class Across { speed, stiffness, damping };

// Over its speed, mean stiffness or damping x and the strength y of what is periodic.
struct Plane {
  Across across;
  double damping, mean, speed, x0, x1, y0, y1;
  std::vector<std::complex<double>> harmonics;

  explicit Plane(Random& random)
      : across(static_cast<Across>(random.integer(0, 2))),
        damping(random.chance(0.35) ? 0 : random.power(-4, 0.3)),
        mean(random.chance(0.2) ? -random(0.05, 1) : random.power(-1, 0.7)),
        speed(random(0.5, 3)) {
    const int H = random.integer(1, 5), divisor = random.chance(0.2) ? 2 : 1;
    harmonics.assign(static_cast<std::size_t>(H * divisor), 0.0);
    for (int j = 1; j <= H; ++j)
      harmonics[static_cast<std::size_t>(j * divisor - 1)] = std::polar(random(0, 1) / (j * j), random(0, 6.28));
    y0 = random.chance(0.3) ? 0 : random(0, 0.3);
    y1 = y0 + random(0.2, 2);
    x0 = across == Across::speed ? random(0.25, 1.5) : across == Across::stiffness ? mean - random(0, 2) : 0;
    x1 = across == Across::speed       ? x0 * random(1.3, 5)
         : across == Across::stiffness ? mean + random(0.3, 5)
                                       : random(0.05, 0.8);
  }

  [[nodiscard]] HillSystem system(double x, double y) const {
    HillSystem system;
    system.mass = Eigen::MatrixXd::Constant(1, 1, 1.3);
    system.damping = Eigen::MatrixXd::Constant(1, 1, across == Across::damping ? x : damping);
    FourierSeries& stiffness = system.stiffness[0] = FourierSeries(1, static_cast<Eigen::Index>(harmonics.size()));
    stiffness.c(0, 0) = across == Across::stiffness ? x : mean;
    for (std::size_t j = 0; j < harmonics.size(); ++j)
      stiffness.c(0, static_cast<Eigen::Index>(j + 1)) = y * harmonics[j];
    return system;
  }
  [[nodiscard]] double speed_at(double x) const { return across == Across::speed ? x : speed; }
  [[nodiscard]] std::optional<ScaledSystem> at(double x, double y) const {
    return scale_system(system(x, y), speed_at(x));
  }
  // Strengths and speeds below zero, and damping, are outside.
  [[nodiscard]] bool holds(double x, double y) const { return y >= 0 && (across == Across::stiffness || x >= 0); }
};

std::vector<double> spaced(double from, double to, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(from + (to - from) * k / (count - 1));
  return values;
}

struct Tally {
  long maps = 0, points = 0, interpolated = 0, undecided = 0, wrong = 0, uncovered = 0;
  long curve_points = 0, open = 0, wrong_curve_points = 0;
};

bool unstable(Verdict v) { return v == Verdict::unstable; }

class Attack {
 public:
  Attack(const Plane& plane, std::string name, Tally& tally)
      : plane_(plane),
        name_(std::move(name)),
        tally_(tally),
        map_(stability_map([&](double x, double y) { return plane.at(x, y); }, spaced(plane.x0, plane.x1, nx),
                           spaced(plane.y0, plane.y1, ny))) {
    ++tally_.maps;
  }

  void check_points(Random& random) {
    constexpr int anywhere = 400, most_beside = 300, every_row = 9;
    for (int k = 0; k < anywhere; ++k)
      check_point(static_cast<std::size_t>(random.integer(0, nx - 1)),
                  static_cast<std::size_t>(random.integer(0, ny - 1)));
    int beside = 0;
    for (std::size_t j = 0; j < ny; j += every_row)
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        if (map_.at(i, j).verdict == map_.at(i + 1, j).verdict || beside++ >= most_beside) continue;
        check_point(i, j);
        check_point(i + 1, j);
      }
  }

  // Both verdicts are met within twice the error of a point of a curve: tongues may be narrower than that.
  void check_curves() {
    constexpr std::size_t every = 7;
    for (const BoundaryCurve& curve : map_.boundaries)
      for (std::size_t n = 0; n < curve.points.size(); n += every) check_curve_point(curve.points[n]);
  }

 private:
  static constexpr int nx = 241, ny = 201;

  void check_point(std::size_t i, std::size_t j) {
    const double x = map_.x[i], y = map_.y[j];
    const MapPoint& told = map_.at(i, j);
    const Stability single = analyse_stability(*plane_.at(x, y)),
                    other = analyse_stability(plane_.system(x, y), plane_.speed_at(x),
                                              {.tolerance = 1e-11, .method = StabilityMethod::propagation});
    ++tally_.points;
    tally_.interpolated += told.source == MapSource::interpolated;
    tally_.undecided += single.verdict == Verdict::undecided;
    const bool sure = other.verdict != Verdict::undecided && told.verdict != Verdict::undecided;
    if (told.verdict != single.verdict || (sure && unstable(told.verdict) != unstable(other.verdict))) {
      ++tally_.wrong;
      fmt::print("  POINT {}: {:.17g}, {:.17g} {}, alone {}, propagated {}\n", name_, x, y, to_string(told.verdict),
                 to_string(single.verdict), to_string(other.verdict));
    }
    // Bilinear between nodes there is none.
    const double error = static_cast<double>(told.growth_error);
    if (!std::isnan(error) && !(std::abs(told.growth_rate - other.growth_rate) <= error + other.growth_error)) {
      ++tally_.uncovered;
      fmt::print("  GROWTH {}: {:.17g}, {:.17g} {:.17g} +/- {:.2g}, propagated {:.17g} +/- {:.2g}\n", name_, x, y,
                 told.growth_rate, error, other.growth_rate, other.growth_error);
    }
  }

  void check_curve_point(const BoundaryPoint& p) {
    constexpr unsigned bits = 10;
    const double reach = 2 * p.error;
    if (!plane_.holds(p.along_x ? p.x - reach : p.x, p.along_x ? p.y : p.y - reach)) return;
    bool stable_met = false, unstable_met = false, open = false;
    // One end, the other, halves, quarters and so on between the two.
    for (unsigned k = 0; k <= (1u << bits) && !(stable_met && unstable_met); ++k) {
      unsigned reversed = k == 1 ? 1u << bits : 0;
      if (k > 1)
        for (unsigned bit = 0; bit < bits; ++bit) reversed |= ((k - 1) >> bit & 1u) << (bits - 1 - bit);
      const double step = reach * (2.0 * reversed / (1u << bits) - 1);
      const auto there = p.along_x ? plane_.at(p.x + step, p.y) : plane_.at(p.x, p.y + step);
      const Verdict verdict = analyse_stability(*there).verdict;
      open = open || verdict == Verdict::undecided;
      (unstable(verdict) ? unstable_met : stable_met) = verdict != Verdict::undecided || stable_met;
    }
    ++tally_.curve_points;
    if (stable_met && unstable_met) return;
    if (open) {
      ++tally_.open;
      return;
    }
    ++tally_.wrong_curve_points;
    fmt::print("  CURVE {}: {:.17g}, {:.17g} along {} +/- {:.2g}, one verdict\n", name_, p.x, p.y,
               p.along_x ? "x" : "y", p.error);
  }

  const Plane& plane_;
  const std::string name_;
  Tally& tally_;
  const StabilityMap map_;
};

int run(const Options& options) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what was found is not lost with the rest
  const Stopwatch watch;
  Tally tally;
  for (int k = options.first; k < options.first + options.cases && watch.seconds() < options.seconds; ++k) {
    Random random(options.seed * 1000003 + static_cast<std::uint64_t>(k));
    const Plane plane(random);
    Attack attack(plane, fmt::format("seed {}, number {}", options.seed, k), tally);
    attack.check_points(random);
    attack.check_curves();
  }
  fmt::print(
      "maps of one mode, seed {}: {} maps; {} points ({} interpolated), {} undecided, {} wrong, {} uncovered; "
      "{} points of curves, {} open, {} wrong\n",
      options.seed, tally.maps, tally.points, tally.interpolated, tally.undecided, tally.wrong, tally.uncovered,
      tally.curve_points, tally.open, tally.wrong_curve_points);
  return tally.wrong + tally.uncovered + tally.wrong_curve_points == 0 ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  using namespace hb::attack;
  CLI::App app{"Maps of one random mode against single answers"};
  Options options;
  add_case_flags(app, options, "how many maps");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
