// Both rods of the six-link mechanism at one speed, five Ritz terms each: steady state, stability, a dense Hill solve
// of the same system, and the theory error. Counters beside the time: the true error of the answer, the error bound it
// came with, and the highest harmonic used.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "dense_hill.hpp"
#include "hb/analysis/theory_error.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"

namespace hb::benchmarks {

namespace {

constexpr int num_modes = 5;

struct Rod {
  std::string name;
  HillSystem system;
};

struct Case {
  double second_moment, rpm, speed;
  std::vector<Rod> rods;
};

Case six_link(benchmark::State& state) {
  Case c{static_cast<double>(state.range(0)), static_cast<double>(state.range(1)), 0, {}};
  const Scene scene =
      read_scene(HB_SOURCE_DIR "/results/six_link/scene.toml", {{"*.J", std::to_string(c.second_moment)}});
  c.speed = speed_from_rpm(c.rpm, scene.units);
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
    const Body& body = *body_at(linkage, coefficients.links[r]);
    c.rods.push_back({body.name, ritz_system(body, coefficients.rods[r], num_modes)});
  }
  return c;
}

FourierSeries reference(const Rod& rod, double speed) {
  return dense_hill_solution(scale_system(rod.system, speed), 64, 3);
}

void steady_state(benchmark::State& state) {
  const Case c = six_link(state);
  SteadyOptions options;
  options.tolerance = 1e-12;
  for (auto _ : state)
    for (const Rod& rod : c.rods) benchmark::DoNotOptimize(solve_steady_state(rod.system, c.speed, options));

  double error = 0, bound = 0;
  int harmonics = 0;
  for (const Rod& rod : c.rods) {
    const SteadyState steady = solve_steady_state(rod.system, c.speed, options);
    error = std::max(error, relative_error(steady.q, reference(rod, c.speed)));
    bound = std::max(bound, steady.error_bound);
    harmonics = std::max(harmonics, steady.num_harmonics);
  }
  state.counters["error"] = error;
  state.counters["bound"] = bound;
  state.counters["harmonics"] = harmonics;
}

// As many harmonics as the solver above chose.
void dense_hill(benchmark::State& state) {
  const Case c = six_link(state);
  SteadyOptions options;
  options.tolerance = 1e-12;
  std::vector<int> harmonics;
  for (const Rod& rod : c.rods) harmonics.push_back(solve_steady_state(rod.system, c.speed, options).num_harmonics);
  for (auto _ : state)
    for (std::size_t r = 0; r < c.rods.size(); ++r)
      benchmark::DoNotOptimize(dense_hill_solution(scale_system(c.rods[r].system, c.speed), harmonics[r]));

  double error = 0;
  for (std::size_t r = 0; r < c.rods.size(); ++r)
    error = std::max(error, relative_error(dense_hill_solution(scale_system(c.rods[r].system, c.speed), harmonics[r]),
                                           reference(c.rods[r], c.speed)));
  state.counters["error"] = error;
  state.counters["harmonics"] = *std::max_element(harmonics.begin(), harmonics.end());
}

// Growth rate of tests/reference/six_link.json.
double reference_growth_rate(const Case& c, const std::string& rod) {
  std::ifstream file(HB_SOURCE_DIR "/tests/reference/six_link.json");
  const nlohmann::json table = nlohmann::json::parse(file);
  for (const auto& entry : table.at("cases"))
    if (entry.at("J") == c.second_moment && entry.at("rpm") == c.rpm && entry.at("modes") == num_modes)
      return entry.at("rods").at(rod).at("exponents").at(0).at(0);
  throw std::runtime_error("six_link.json has no such case");
}

void stability(benchmark::State& state) {
  const Case c = six_link(state);
  StabilityOptions options;
  options.leading_only = true;
  for (auto _ : state)
    for (const Rod& rod : c.rods) benchmark::DoNotOptimize(analyse_stability(rod.system, c.speed, options));

  double error = 0, bound = 0;
  for (const Rod& rod : c.rods) {
    const Stability stability = analyse_stability(rod.system, c.speed, options);
    const double scale = std::max(1.0, std::abs(stability.growth_rate));
    error = std::max(error, std::abs(stability.growth_rate - reference_growth_rate(c, rod.name)) / scale);
    bound = std::max(bound, stability.growth_error / scale);
  }
  state.counters["error"] = error;
  state.counters["bound"] = bound;
}

// Counters: that of AB, and its relative error against as many points along the rods as the exact model takes.
void theory_error(benchmark::State& state) {
  const Scene scene = read_scene(HB_SOURCE_DIR "/results/six_link/scene.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const auto modes = static_cast<Eigen::Index>(state.range(0));
  const double speed = speed_from_rpm(static_cast<double>(state.range(1)), scene.units);
  std::vector<HillSystem> systems;
  std::vector<FourierSeries> q;
  std::vector<ExactModel::Rod> links;
  for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
    systems.push_back(ritz_system(*body_at(linkage, coefficients.links[r]), coefficients.rods[r], modes));
    q.push_back(solve_steady_state(systems[r], speed).q);
    links.push_back({coefficients.links[r], modes});
  }
  std::vector<LinearRod> rods;
  for (std::size_t r = 0; r < q.size(); ++r) rods.push_back({&systems[r], &q[r]});
  const ExactModel model = theory_model(linkage, std::vector<Eigen::Index>(q.size(), modes)), fine(linkage, links);
  for (auto _ : state) benchmark::DoNotOptimize(theory_errors(model, speed, rods));
  const double value = *theory_errors(model, speed, rods).rods[0].q;
  state.counters["theory"] = value;
  state.counters["error"] = std::abs(value / *theory_errors(fine, speed, rods).rods[0].q - 1);
}

void theory_cases(benchmark::internal::Benchmark* rows) {
  rows->ArgNames({"modes", "rpm"})->Unit(benchmark::kMicrosecond);
  for (const int modes : {1, 2, 5})
    for (const int rpm : {300, 900, 1500}) rows->Args({modes, rpm});
}

void cases(benchmark::internal::Benchmark* rows) {
  rows->ArgNames({"J", "rpm"})->Unit(benchmark::kMicrosecond);
  for (const int rpm : {300, 1500, 3000}) rows->Args({45, rpm});
  for (const int rpm : {300, 3000}) rows->Args({4500, rpm});
}

BENCHMARK(steady_state)->Apply(cases);
BENCHMARK(stability)->Apply(cases);
BENCHMARK(dense_hill)->Apply(cases);
BENCHMARK(theory_error)->Apply(theory_cases);

}  // namespace

}  // namespace hb::benchmarks
