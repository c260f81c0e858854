// Yardsticks for the times of whole commands, as CSV on standard output: hb_yardsticks [NAME...] of dgemm, dense_hill,
// cvode_shooting (default: all). Eigen and SUNDIALS do their work. Errors against a dense Hill solution with more
// harmonics whose residuals are taken in long double.
#include <Eigen/Core>
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "cases.hpp"
#include "dense_hill.hpp"
#include "hb/engine/time/shooting.hpp"
#include "lib/time_domain.hpp"
#include "timing.hpp"

namespace hb::benchmarks {

namespace {

constexpr int harmonics = 44;  // six-link rod AB at 1500 rpm to 1e-12

void dgemm_row() {
  const double rate = dgemm_rate();
  std::printf("dgemm,C += A B of size 512: %.1f GFlop/s,%.4e,\n", rate * 1e-9, 2.0 * 512 * 512 * 512 / rate);
}

void dense_hill_row(const Case& c, const FourierSeries& exact) {
  const ScaledSystem scaled = scale_system(c.system, c.speed);
  const double error = relative_error(dense_hill_solution(scaled, harmonics), exact);
  const Timing timing = timed([&] { (void)dense_hill_solution(scaled, harmonics); });
  std::printf("dense_hill,%s with %d harmonics,%.4e,%.1e\n", c.name.c_str(), harmonics, timing.best, error);
}

void shooting_row(const Case& c, const FourierSeries& exact) {
  const ShootingOptions options{.integrator = Integrator::adams, .single_run = 1e-10};
  const ShootingResult result = solve_by_shooting(time_domain_system(c.system, c.speed), options);
  const double error = relative_error(result.orbit.q, exact);
  const Timing timing = timed([&] { (void)solve_by_shooting(time_domain_system(c.system, c.speed), options); });
  std::printf("cvode_shooting,%s at tolerance 1e-10,%.4e,%.1e\n", c.name.c_str(), timing.best, error);
}

}  // namespace

}  // namespace hb::benchmarks

int main(int argc, char** argv) {
  using namespace hb::benchmarks;
  const auto asked = [&](std::string_view name) {
    return argc == 1 || std::any_of(argv + 1, argv + argc, [&](const char* a) { return name == a; });
  };
  std::printf("%s\nyardstick,of what,seconds,error\n", header().c_str());
  if (asked("dgemm")) dgemm_row();
  if (!asked("dense_hill") && !asked("cvode_shooting")) return 0;
  const std::vector<Case> cases = all_cases();
  const auto rod =
      std::find_if(cases.begin(), cases.end(), [](const Case& c) { return c.name == "six_link_45_1500rpm"; });
  const hb::FourierSeries exact = dense_hill_solution(hb::scale_system(rod->system, rod->speed), harmonics + 20, 3);
  if (asked("dense_hill")) dense_hill_row(*rod, exact);
  if (asked("cvode_shooting")) shooting_row(*rod, exact);
}
