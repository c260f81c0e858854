// What a speed and the points of a sweep are said to take, against the growth of a process that computes them.
#include "hb/analysis/expected_memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "hb/hb.hpp"

namespace {

using namespace hb;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

double largest_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// Measured over said, in a process of its own: `run` is given what to call when it begins, with the bytes said.
double measured_over_said(const std::function<void(const std::function<void(double)>&)>& run) {
  int ends[2];
  if (pipe(ends) != 0) return 0;
  const pid_t child = fork();
  if (child == 0) {
    double said = 0, before = 0;
    run([&](double bytes) {
      said = bytes;
      before = largest_memory();
    });
    const double ratio = (largest_memory() - before) / said;
    _exit(write(ends[1], &ratio, sizeof ratio) == sizeof ratio ? 0 : 1);
  }
  close(ends[1]);
  double ratio = 0;
  const bool there = read(ends[0], &ratio, sizeof ratio) == sizeof ratio;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return there ? ratio : 0;
}

double of_a_speed(double crank, int modes, const Only& only) {
  return measured_over_said([&](const std::function<void(double)>& begin) {
    const SceneSource source(HB_SOURCE_DIR "/tests/scenes/slider_crank.toml");
    Request request;
    request.rpm = 300;
    request.modes = modes;
    request.only = only;
    (void)steady(source.with({number_override("crank.length", crank)}), request,
                 [&](double, double bytes) { begin(bytes); });
  });
}

TEST(ExpectedMemory, OfASpeedNearADeadCentreIsThatMeasured) {
  if (sanitized) GTEST_SKIP() << "sanitizers take memory of their own";
  const Only response{true, false, false, false}, exponents{false, true, false, false};
  for (const double ratio : {of_a_speed(144.9, 10, response), of_a_speed(144.9, 10, exponents)}) {
    EXPECT_GT(ratio, 1 / 3.0);
    EXPECT_LT(ratio, 3);
  }
}

TEST(ExpectedMemory, OfTheSweepsPointsIsThatMeasured) {
  if (sanitized) GTEST_SKIP() << "sanitizers take memory of their own";
  constexpr std::size_t points = 3000;
  const double ratio = measured_over_said([](const std::function<void(double)>& begin) {
    SweepRequest request;
    request.x = along("rpm", 300, 1900, points);
    request.modes = 5;
    request.search = false;
    request.only = {false, true, false, false};
    const SceneSource source(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
    const auto scene = sweep_scene(SceneFamily(source, {}), request);
    begin(expected_bytes_of_points(scene->first(), scene->settings(), points, false));
    Work work;
    (void)run_sweep(*scene, work);
  });
  EXPECT_GT(ratio, 1 / 3.0);
  EXPECT_LT(ratio, 3);
}

}  // namespace
