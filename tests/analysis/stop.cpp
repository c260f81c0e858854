// Work that is wished to end does so wherever it is, and leaves nothing behind.
#include <gtest/gtest.h>

#include <functional>

#include "hb/engine/system/scaled_system.hpp"
#include "hb/hb.hpp"
#include "lib/stop_wish.hpp"

namespace hb {
namespace {

Scene six_link() { return read_scene(std::string(HB_SOURCE_DIR) + "/tests/scenes/six_link.toml"); }

Request at(double rpm, int modes) {
  Request request;
  request.rpm = rpm;
  request.modes = modes;
  return request;
}

// Whether the work ended at the n-th look of its loops.
bool ends_at(long n, const std::function<void()>& work) {
  long looks = 0;
  const StopWish wish([&] { return ++looks >= n; });
  try {
    work();
  } catch (const Stopped&) {
    return true;
  }
  return false;
}

long looks_of(const std::function<void()>& work) {
  long looks = 0;
  const StopWish wish([&] {
    ++looks;
    return false;
  });
  work();
  return looks;
}

TEST(StopWish, IsOfItsThreadAndScope) {
  EXPECT_FALSE(stop_wished());
  EXPECT_NO_THROW(end_if_wished());
  {
    const StopWish outer([] { return true; });
    EXPECT_TRUE(stop_wished());
    {
      const StopWish inner([] { return false; });
      EXPECT_FALSE(stop_wished());
    }
    EXPECT_THROW(end_if_wished(), Stopped);
    const StopHeld held;
    EXPECT_TRUE(stop_wished());
    EXPECT_NO_THROW(end_if_wished());
  }
  EXPECT_FALSE(stop_wished());
}

TEST(StopWish, EndsOneSpeedAtAnyLookAndTheNextAnswerIsTheSame) {
  const Scene scene = six_link();
  const Request request = at(1500, 8);
  const SteadyResult expected = steady(scene, request);
  const long looks = looks_of([&] { (void)steady(scene, request); });
  ASSERT_GT(looks, 50);
  for (long n = 1; n <= looks; n += 1 + looks / 60) {
    EXPECT_TRUE(ends_at(n, [&] { (void)steady(scene, request); })) << n;
    const SteadyResult again = steady(scene, request);
    for (std::size_t r = 0; r < expected.rods.size(); ++r) {
      EXPECT_EQ(again.rods[r].steady->q.c, expected.rods[r].steady->q.c) << n;
      EXPECT_EQ(again.rods[r].stability->growth_rate, expected.rods[r].stability->growth_rate) << n;
    }
  }
}

// A system of many unknowns and harmonics is made ready in seconds: it looks once for each unknown at least.
TEST(StopWish, LooksWhileALargeSystemIsScaled) {
  constexpr Eigen::Index I = 12;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = 0.01 * Eigen::MatrixXd::Identity(I, I);
  system.stiffness[0] = FourierSeries(I * I, 20);
  for (Eigen::Index k = 0; k <= 20; ++k)
    for (Eigen::Index i = 0; i < I; ++i) system.stiffness[0].c(i + I * i, k) = 1.0 / static_cast<double>(1 + k + i);
  EXPECT_GE(looks_of([&] { (void)scale_system(system, 1); }), I);
  EXPECT_TRUE(ends_at(I, [&] { (void)scale_system(system, 1); }));
}

TEST(StopWish, EndsIntegrationInTime) {
  const Scene scene = six_link();
  CheckRequest request;
  static_cast<Request&>(request) = at(1500, 2);
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf, Integrator::collocation}) {
    request.integrator = integrator;
    const long looks = looks_of([&] { (void)check(scene, request); });
    for (const long n : {looks / 4, looks / 2, looks - looks / 8})
      EXPECT_TRUE(ends_at(n, [&] { (void)check(scene, request); })) << to_string(integrator) << " " << n;
  }
}

TEST(StopWish, EndsMapsAndSweeps) {
  const SceneSource source(std::string(HB_SOURCE_DIR) + "/tests/scenes/six_link.toml");
  SweepRequest along;
  along.modes = 2;
  along.x = hb::along("rpm", 300, 900, 4);
  MapRequest over;
  over.modes = 2;
  over.x = hb::along("rpm", 300, 900, 3);
  over.y = hb::along("*.J", 40, 60, 3);
  const std::function<void()> works[] = {[&] { (void)sweep(source, along); }, [&] { (void)map(source, over); }};
  for (const auto& work : works) {
    const long looks = looks_of(work);
    for (const long n : {1L, looks / 3, looks / 2, looks - 1}) EXPECT_TRUE(ends_at(n, work)) << n;
  }
}

}  // namespace
}  // namespace hb
