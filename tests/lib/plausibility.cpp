// Numbers that are possible but hardly meant are told, with the slip that is likely behind them.
#include <gtest/gtest.h>

#include "lib/scene/scene.hpp"

using namespace hb;

namespace {

const std::string good = R"(gravity = 9.81
[crank]
pivot = [0, 0]
length = 0.04
[[dyad]]
on = "crank"
coupler = { name = "rod", length = 0.15, mass = 0.1, elastic = { E = 210e9, area = 1e-4, J = 6e-10 } }
slider = { name = "piston", mass = 0.4, guide = [0, 0] }
branch = 1
[analysis]
rpm = 3000
)";

std::vector<std::string> warnings_with(const std::vector<Override>& overrides) {
  return parse_scene(good, "file.toml", overrides).warnings;
}

void expect_only(const std::vector<Override>& overrides, const std::string& part) {
  const std::vector<std::string> warnings = warnings_with(overrides);
  ASSERT_EQ(warnings.size(), 1u) << overrides[0].path << "=" << overrides[0].value
                                 << (warnings.empty() ? "" : "\n" + warnings[0] + "\n" + warnings.back());
  EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
  EXPECT_EQ(warnings[0].find('\n'), std::string::npos);
}

}  // namespace

TEST(Plausibility, AnOrdinarySceneHasNoWarning) {
  EXPECT_TRUE(warnings_with({}).empty());
  EXPECT_TRUE(warnings_with({{"gravity", "0"}}).empty());
  EXPECT_TRUE(warnings_with({{"gravity", "1.62"}}).empty());
  EXPECT_TRUE(warnings_with({{"rod.E", "1.2e9"}}).empty());
  EXPECT_TRUE(warnings_with({{"rod.E", "1200 GPa"}}).empty());
}

TEST(Plausibility, YoungsModulusInTheWrongUnitNamesTheUnit) {
  expect_only({{"rod.E", "210000"}}, "rod.elastic.E: found 210 kPa; 210 GPa if the number was in MPa");
  expect_only({{"rod.E", "210e6"}}, "found 210 MPa; 210 GPa if the number was in kPa");
  expect_only({{"rod.E", "210"}}, "found 210 Pa; 210 GPa if the number was in GPa");
  expect_only({{"rod.E", "30e6"}}, "found 30 MPa; 206.8 GPa if the number was in psi");
  expect_only({{"rod.E", "210 MPa"}}, "found 210 MPa; 210 GPa if the number was in GPa");
  EXPECT_TRUE(warnings_with({{"rod.E", "210000"}})[0].starts_with("rod.E=210000: rod.elastic.E: "));
  // mm, kg, s: kilopascal.
  const std::string in_mm = R"(units.length = "mm"
crank = { pivot = [0, 0], length = 40 }
[[dyad]]
on = "crank"
coupler = { name = "rod", length = 150, mass = 0.1, elastic = { E = 210000, area = 100, J = 500 } }
slider = { name = "piston", mass = 0.4, guide = [0, 0] }
branch = 1
)";
  const std::vector<std::string> warnings = parse_scene(in_mm, "file.toml").warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(
      warnings[0],
      "file.toml:5: rod.elastic.E: found 210 MPa; 210 GPa if the number was in MPa (solids have 1 GPa to 1.5 TPa); "
      "taken as given");
}

TEST(Plausibility, GravitySectionsMassesAndSizesAreLookedAt) {
  expect_only({{"gravity", "9810"}}, "gravity: found 9810 m/s^2; 9.81 m/s^2 if the number was in mm/s^2");
  expect_only({{"gravity", "0.00981"}}, "gravity: found 0.00981 m/s^2");
  expect_only({{"rod.J", "1e-7"}}, "rod.elastic.J: found J/area^2 = 10");
  expect_only({{"rod.J", "1e-11"}}, "rod.elastic.J: found J/area^2 = 0.001");
  expect_only({{"rod.length", "0.05"}}, "length/sqrt(J/area) = 20.4");
  expect_only({{"rod.mass", "100"}}, "rod.mass: found 100 kg");
  expect_only({{"analysis.rpm", "300000"}}, "analysis.rpm: found a crank whose tip moves at 1257 m/s");
  const std::vector<std::string> in_m =
      parse_scene(
          "crank = { pivot = [0, 0], length = 40 }\n[[dyad]]\non = \"crank\"\ncoupler = { name = \"rod\", length "
          "= 150 }\nslider = { name = \"piston\", mass = 0.4, guide = [0, 0] }\nbranch = 1\n",
          "file.toml")
          .warnings;
  ASSERT_EQ(in_m.size(), 1u);
  EXPECT_NE(in_m[0].find("found rod with a length of 150 m; 150 mm if the numbers were in mm"), std::string::npos)
      << in_m[0];
}

// From pi^2 J/(area l^2) = 0.003, a percent of the deflection.
TEST(Plausibility, ShearLeftOutIsToldFromAPercentOfTheDeflection) {
  EXPECT_TRUE(warnings_with({{"rod.J", "6.83e-10"}}).empty());
  expect_only({{"rod.J", "6.85e-10"}},
              "rod.elastic.J: found length/sqrt(J/area) = 57.3, a thick rod: shear, left out, would add "
              "about 0.93 % to its deflection");
  std::string sheared = good;
  sheared.replace(sheared.find("J = 6e-10"), 9, "J = 2e-9, shear = { G = 80e9, k = 0.85 }");
  EXPECT_TRUE(parse_scene(sheared, "file.toml").warnings.empty());
}

TEST(Plausibility, TheGravestComesFirstAndEachKindOnce) {
  const std::vector<std::string> warnings = warnings_with({{"gravity", "9810"}, {"rod.E", "210"}, {"rod.J", "1e-6"}});
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_NE(warnings[0].find("rod.elastic.E"), std::string::npos);
  EXPECT_NE(warnings[1].find("J/area^2"), std::string::npos);
  EXPECT_NE(warnings[2].find("gravity"), std::string::npos);
  const std::filesystem::path six = std::filesystem::path(HB_SOURCE_DIR) / "tests/scenes/six_link.toml";
  const std::vector<std::string> both = read_scene(six, {{"*.E", "210"}}).warnings;
  ASSERT_EQ(both.size(), 1u);
  EXPECT_NE(both[0].find("(and 1 more of this kind)"), std::string::npos) << both[0];
}
