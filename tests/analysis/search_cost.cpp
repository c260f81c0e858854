// How many evaluations the search between the points of a sweep takes, against the number of points, on ordinary
// scenes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "hb/hb.hpp"

namespace {

using namespace hb;

struct Count {
  std::size_t points, boundaries, evaluations;
  double open_share;
};

Count search(const std::string& scene, double from, double to, std::size_t points) {
  SweepRequest request;
  request.x = along("rpm", from, to, points);
  request.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
  const Sweep found = sweep(SceneSource(std::string(HB_SOURCE_DIR "/") + scene), request);
  Count count{points, 0, 0, 0};
  for (const SweepRod& rod : found.rods) {
    count.boundaries += rod.boundaries.size();
    for (const auto& piece : rod.not_excluded) count.open_share += (piece[1] - piece[0]) / (to - from);
  }
  for (const Stage& stage : found.stages)
    if (const std::size_t at = stage.note.find("located, ");
        stage.name == "narrow bands and peaks" && at != stage.note.npos)
      count.evaluations = std::strtoul(stage.note.c_str() + at + 9, nullptr, 10);
  return count;
}

// Most evaluations are of leading exponents alone.
TEST(SearchCost, IsAFewEvaluationsPerPointAndBoundaryOnOrdinaryScenes) {
  for (const Count& c :
       {search("results/four_bar/scene.toml", 300, 3000, 136), search("results/six_link/scene.toml", 300, 3000, 55),
        search("results/six_link_campbell/scene.toml", 300, 10000, 98),
        search("results/slider_crank/scene.toml", 1000, 12000, 111),
        search("tests/scenes/six_link_4500.toml", 300, 6000, 58)}) {
    EXPECT_GT(c.evaluations, 0U);
    EXPECT_LE(c.evaluations, 2 * c.points + 20 * c.boundaries);
    EXPECT_LT(c.open_share, 0.01);
  }
}

}  // namespace
