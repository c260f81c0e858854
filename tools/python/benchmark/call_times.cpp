// CPU seconds per call from C++, beside which call_times.py sets those from Python: shortest of several rounds.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "hb/hb.hpp"

namespace {

double shortest(int rounds, int calls, const std::function<void(int)>& call) {
  double best = 1e300;
  for (int round = 0; round < rounds; ++round) {
    const std::clock_t start = std::clock();
    for (int k = 0; k < calls; ++k) call(k);
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / calls);
  }
  return best;
}

hb::FourierSeries series(std::initializer_list<double> coefficients) {
  hb::FourierSeries result(1, static_cast<Eigen::Index>(coefficients.size()) - 1);
  Eigen::Index k = 0;
  for (const double c : coefficients) result.c(0, k++) = c;
  return result;
}

}  // namespace

// call_times SCENE ROUNDS
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const hb::Scene scene = hb::read_scene(argv[1]);
  const int rounds = std::atoi(argv[2]);
  hb::Request request;
  request.omega = 1;
  request.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  const double steady = shortest(rounds, 20, [&](int) { (void)hb::steady(scene, request); });

  hb::HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, 0.1);
  system.stiffness[0] = series({1.2, 0.2});
  constexpr int speeds = 10000;
  const double stability = shortest(std::max(1, rounds / 10), speeds,
                                    [&](int k) { (void)hb::analyse_stability(system, 0.5 + 3.0 * k / speeds); });
  fmt::print("{{\"steady\": {}, \"stability\": {}}}\n", steady, stability);
}
