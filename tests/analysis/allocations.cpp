// Memory in the loop over the speeds of a sweep: how often it is taken from malloc, and page faults. In a program of
// its own, since malloc itself counts here (operator new and Eigen call it).
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>

#include "hb/hb.hpp"

namespace {

std::atomic<long> allocations{0};

}  // namespace

// The C library's own.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocations;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++allocations;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? 12 : 0;
}
}

namespace {

using namespace hb;

struct Counted {
  double allocations = 0, page_faults = 0;
};

double page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_minflt);
}

Counted of_sweep(const Scene& scene, const Only& only, int speeds) {
  SweepRequest request;
  request.modes = 5;
  request.only = only;
  request.search = false;
  request.x = along("rpm", 600, 1200, speeds);
  const Counted before{static_cast<double>(allocations), page_faults()};
  const Sweep found = sweep(scene, request);
  const Counted after{static_cast<double>(allocations), page_faults()};
  EXPECT_EQ(found.points.size(), static_cast<std::size_t>(speeds));
  return {after.allocations - before.allocations, after.page_faults - before.page_faults};
}

Counted lesser(const Counted& a, const Counted& b) {
  return {std::min(a.allocations, b.allocations), std::min(a.page_faults, b.page_faults)};
}

// What each speed more costs once everything is warm, its results included: the least of several runs, since where the
// system puts stack and heap decides over a few dozen pages. The heap keeps its pages, as in the command.
Counted per_speed(const Only& only) {
  constexpr int kept = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kept);
  mallopt(M_TRIM_THRESHOLD, kept);
  const Scene scene = read_scene(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  constexpr int few = 10, many = 40, runs = 4;
  (void)of_sweep(scene, only, many);
  Counted less{HUGE_VAL, HUGE_VAL}, more = less;
  for (int run = 0; run < runs; ++run) {
    less = lesser(less, of_sweep(scene, only, few));
    more = lesser(more, of_sweep(scene, only, many));
  }
  constexpr double further = many - few;
  return {(more.allocations - less.allocations) / further, (more.page_faults - less.page_faults) / further};
}

void expect_at_most(const Only& only, double most_allocations, double most_page_faults) {
  const Counted found = per_speed(only);
  testing::Test::RecordProperty("allocations per speed", std::to_string(found.allocations));
  testing::Test::RecordProperty("page faults per speed", std::to_string(found.page_faults));
  EXPECT_LE(found.allocations, most_allocations);
  EXPECT_LE(found.page_faults, most_page_faults);
}

// Upper limits, a twentieth above what was reached (672, 4032 and 5810 allocations, of what the results themselves take
// too; no page faults, where 30 faults of 30 further speeds are let pass). No allocation in the loop itself is what is
// aimed at.
TEST(Allocations, PerSpeedOfTheGrowthRateAlone) {
  expect_at_most({.steady = false, .stability = true, .reactions = false, .shape = false, .growth = true}, 705, 1);
}

TEST(Allocations, PerSpeedOfSteadyStateAndExponents) {
  expect_at_most({.steady = true, .stability = true, .reactions = false, .shape = false}, 4235, 1);
}

TEST(Allocations, PerSpeedOfEverything) { expect_at_most({}, 6100, 1); }

}  // namespace
