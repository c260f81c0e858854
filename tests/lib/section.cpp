#include "lib/rod/section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "lib/constants.hpp"
#include "lib/scene/scene.hpp"

namespace {

using namespace hb;

// A slider-crank whose rod has this in its `elastic` table.
Scene scene_with(const std::string& elastic, const std::vector<Override>& overrides = {}) {
  const std::string text =
      "gravity = 0\n[crank]\npivot = [0, 0]\nlength = 1\n[[dyad]]\non = \"crank\"\n"
      "coupler = { name = \"rod\", length = 4, elastic = { E = 2e5, density = 3, " +
      elastic + " } }\nslider = { name = \"piston\", guide = [0, 0] }\nbranch = 1\n";
  return parse_scene(text, "scene.toml", overrides);
}

const Body& rod_of(const Scene& scene) { return std::get<Linkage>(scene.model).dyads[0].coupler; }

std::string refusal(const std::string& elastic) {
  try {
    (void)scene_with(elastic);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

TEST(Section, AgreesWithTheIntegralsOverTheArea) {
  // F = int b(y) dy, J = int y^2 b(y) dy by the midpoint rule, b the width at height y.
  const auto integrals = [](double half, const std::function<double(double)>& width) {
    constexpr int n = 200000;
    SectionValues sum;
    for (int k = 0; k < n; ++k) {
      const double y = half * (-1 + (2 * k + 1.0) / n), strip = width(y) * 2 * half / n;
      sum.area += strip;
      sum.second_moment += y * y * strip;
    }
    return sum;
  };
  const auto disc = [](double radius, double y) {
    return std::abs(y) < radius ? 2 * std::sqrt(radius * radius - y * y) : 0.0;
  };
  const auto expect_equal = [](const SectionValues& found, const SectionValues& expected) {
    EXPECT_NEAR(found.area, expected.area, 1e-6 * expected.area);
    EXPECT_NEAR(found.second_moment, expected.second_moment, 1e-6 * expected.second_moment);
  };
  expect_equal(rectangular_section(2, 3), integrals(1.5, [](double) { return 2.0; }));
  expect_equal(round_section(3), integrals(1.5, [&](double y) { return disc(1.5, y); }));
  expect_equal(tubular_section(3, 0.4), integrals(1.5, [&](double y) { return disc(1.5, y) - disc(1.1, y); }));
}

TEST(Section, OfATubeKeepsItsDigitsForThinWallsAndEndsAtTheRod) {
  const double D = 7, t = 1e-9;
  const SectionValues thin = tubular_section(D, t), full = tubular_section(D, D / 2), solid = round_section(D);
  EXPECT_NEAR(thin.area, std::numbers::pi * t * (D - t), 4 * eps * thin.area);
  EXPECT_NEAR(full.area, solid.area, 4 * eps * solid.area);
  EXPECT_NEAR(full.second_moment, solid.second_moment, 4 * eps * solid.second_moment);
}

TEST(Section, OfASceneGivesAreaSecondMomentAndMass) {
  const Body rod = rod_of(scene_with("section = { shape = \"rectangle\", width = 0.2, height = 0.3 }"));
  EXPECT_NEAR(rod.elastic->area, 0.06, 4 * eps);
  EXPECT_NEAR(rod.elastic->second_moment, 0.2 * 0.027 / 12, 4 * eps);
  EXPECT_NEAR(rod.mass, 3 * 0.06 * 4, 16 * eps);
}

TEST(Section, IsReplacedByPath) {
  const std::string tube = "section = { shape = \"tube\", diameter = 0.3, wall = 0.02 }";
  const Scene scene = scene_with(tube, {number_override("rod.section.wall", 0.05)});
  EXPECT_NEAR(rod_of(scene).elastic->area, tubular_section(0.3, 0.05).area, 4 * eps);
}

TEST(Section, ThatIsWrongIsRefusedInWords) {
  EXPECT_NE(refusal("section = { shape = \"rectangle\", width = 1, height = 1 }, J = 2").find("found beside section"),
            std::string::npos);
  EXPECT_NE(refusal("section = { shape = \"star\" }").find("rectangle, tube, round"), std::string::npos);
  EXPECT_NE(refusal("section = { shape = \"tube\", diameter = 1, wall = 0.6 }").find("half the diameter"),
            std::string::npos);
  EXPECT_NE(refusal("section = { shape = \"round\", diameter = 1, wall = 0.1 }").find("found on the shape round"),
            std::string::npos);
  EXPECT_NE(refusal("section = { shape = \"rectangle\", width = 1 }").find("height"), std::string::npos);
  EXPECT_NE(refusal("section = { shape = \"rectangle\", width = -1, height = 1 }").find("width"), std::string::npos);
  EXPECT_NE(refusal("section = 3").find("section"), std::string::npos);
}

}  // namespace
