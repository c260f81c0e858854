// Scenes written with units, materials and sections mean what the same scenes in plain numbers mean, to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lib/constants.hpp"
#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/wrong_scene.hpp"

using namespace hb;

namespace {

Linkage linkage_of(const std::string& text, const std::vector<Override>& overrides = {}) {
  return std::get<Linkage>(parse_scene(text, "file.toml", overrides).model);
}

// A slider-crank in m, kg, s, rad whose rod has these elastic data.
std::string slider_crank(const std::string& rod, const std::string& slider = "mass = 0.4, guide = [0, 0]") {
  return "[crank]\npivot = [0, 0]\nlength = 0.04\n[[dyad]]\non = \"crank\"\ncoupler = { name = \"rod\", length = "
         "0.15, " +
         rod + " }\nslider = { name = \"piston\", " + slider + " }\nbranch = 1\n";
}

Elastic rod_of(const std::string& elastic, const std::string& before = "") {
  return *linkage_of(slider_crank(before + "elastic = { " + elastic + " }")).dyads[0].coupler.elastic;
}

}  // namespace

TEST(SceneUnits, TextWithUnitsIsThePlainNumber) {
  const std::string plain = R"(gravity = 9.81
[units]
length = "mm"
angle = "deg"
[crank]
pivot = [10, -5]
length = 55
mass = 0.5
com = [12, 180]
inertia = 100
[[dyad]]
on = "crank"
coupler = { name = "AB", length = 259, elastic = { E = 21e7, area = 10, J = 45, density = 7.85e-6, damping_internal = 1e-4, damping_y = 1e-6 } }
slider = { name = "S", mass = 0.3, guide = [0, 50], direction = 30, force = { cos = [1000, 2000], sin = [0, 3000] }, points = { P = [20, 90] } }
branch = 1
[analysis]
rpm = [300, 600, 100]
)";
  const std::string with_units = R"toml(gravity = "9.81 mm/s^2"
[units]
length = "mm"
angle = "deg"
[crank]
pivot = ["1 cm", "-5 mm"]
length = "0.055 m"
mass = "500 g"
com = ["12 mm", "180 deg"]
inertia = "100 kg mm^2"
[[dyad]]
on = "crank"
coupler = { name = "AB", length = "259 mm", elastic = { E = "210 GPa", area = "10 mm^2", J = "45 mm^4", density = "7.85e-6 kg/mm^3", damping_internal = "0.1 ms", damping_y = "1e-6 kg/(mm s)" } }
slider = { name = "S", mass = "300 g", guide = [0, "50 mm"], direction = "30 deg", force = { cos = ["1 N", "2 N"], sin = [0, "3 N"] }, points = { P = ["20 mm", "90 deg"] } }
branch = 1
[analysis]
rpm = ["300 rpm", "10 Hz", 100]
)toml";
  const Linkage a = linkage_of(plain), b = linkage_of(with_units);
  EXPECT_EQ(a.gravity, b.gravity);
  EXPECT_EQ(a.crank.pivot, b.crank.pivot);
  EXPECT_EQ(a.crank.body.length, b.crank.body.length);
  EXPECT_EQ(a.crank.body.mass, b.crank.body.mass);
  EXPECT_EQ(a.crank.body.com, b.crank.body.com);
  EXPECT_EQ(a.crank.body.inertia, b.crank.body.inertia);
  const Body &c = a.dyads[0].coupler, &d = b.dyads[0].coupler;
  EXPECT_EQ(c.length, d.length);
  EXPECT_EQ(c.mass, d.mass);
  EXPECT_EQ(c.elastic->youngs_modulus, d.elastic->youngs_modulus);
  EXPECT_EQ(c.elastic->area, d.elastic->area);
  EXPECT_EQ(c.elastic->second_moment, d.elastic->second_moment);
  EXPECT_EQ(c.elastic->density, d.elastic->density);
  EXPECT_EQ(c.elastic->internal_damping, d.elastic->internal_damping);
  EXPECT_EQ(c.elastic->damping_y, d.elastic->damping_y);
  const Slider &e = std::get<Slider>(a.dyads[0].closing), &f = std::get<Slider>(b.dyads[0].closing);
  EXPECT_EQ(e.mass, f.mass);
  EXPECT_EQ(e.guide, f.guide);
  EXPECT_EQ(e.direction, f.direction);
  EXPECT_EQ(e.force.c, f.force.c);
  EXPECT_EQ(e.points, f.points);
  const Speeds rpm = *parse_scene(with_units, "file.toml").analysis.rpm;
  EXPECT_EQ(rpm.from, 300);
  EXPECT_DOUBLE_EQ(rpm.to, 600);
  EXPECT_EQ(rpm.step, 100);
}

TEST(SceneUnits, OverridesAndPathsTakeUnits) {
  const std::string text = slider_crank("mass = 0.35, elastic = { E = \"210 GPa\", area = 1.1e-4, J = 9e-10 }");
  const SceneSource source(text, "file.toml", ".");
  EXPECT_EQ(source.value("rod.E"), 210e9);
  const std::vector<std::string> paths = source.numeric_paths();
  EXPECT_NE(std::ranges::find(paths, "rod.E"), paths.end());
  const auto stiffness = [&](const std::string& path, const std::string& value) {
    return std::get<Linkage>(source.with({{path, value}}).model).dyads[0].coupler.elastic->youngs_modulus;
  };
  EXPECT_EQ(stiffness("rod.E", "70 GPa"), 70e9);
  EXPECT_EQ(stiffness("rod.E", "70GPa"), 70e9);
  EXPECT_EQ(stiffness("rod.E", "\"70 GPa\""), 70e9);
  EXPECT_EQ(stiffness("*.E", "70e9"), 70e9);
  EXPECT_EQ(std::get<Linkage>(source.with({{"crank.pivot", "[\"10 mm\", 0]"}}).model).crank.pivot, 0.01);
  EXPECT_EQ(std::get<Linkage>(source.with({{"crank.pivot.1", "10 mm"}}).model).crank.pivot,
            std::complex<double>(0, 0.01));
  // Written back, a number replaces the text.
  const std::string changed = source.text_with({number_override("rod.E", 2e11)});
  EXPECT_NE(changed.find("E = 200000000000.0,"), std::string::npos) << changed;
  EXPECT_EQ(SceneSource(source.text_with({{"rod.E", "70 GPa"}}), "file.toml", ".").value("rod.E"), 70e9);
}

TEST(SceneUnits, WrongTextsNameFileLineKeyFoundAndAllowed) {
  const std::string good = slider_crank("mass = 0.35, elastic = { E = 2.1e11, area = 1.1e-4, J = 9e-10 }");
  struct Case {
    std::string path, value, found, allowed;
  };
  for (const Case& c : std::vector<Case>{
           {"rod.E", "\"210\"", "rod.elastic.E: found \"210\", text without a unit", "\"210 GPa\""},
           {"rod.E", "\"210 GPA\"", "found \"210 GPA\", the unknown unit GPA (GPa meant?)", "a number > 0"},
           {"rod.E", "\"210 mm\"", "found \"210 mm\", a length", "a number > 0"},
           {"rod.E", "\"-210 GPa\"", "found \"-210 GPa\"", "a number > 0"},
           {"rod.length", "\"15 inches\"", "found \"15 inches\", the unknown unit inches (in meant?)", "\"55 mm\""},
           {"crank.length", "\"0,04 m\"", "a decimal comma (a decimal point meant?)", "\"55 mm\""},
           {"crank.pivot", "[0, \"3 kg\"]", "crank.pivot.1: found \"3 kg\", a mass", "\"55 mm\""},
           {"piston.direction", "\"3 mm\"", "piston.direction: found \"3 mm\", a length", "\"90 deg\""},
           {"dyad.0.branch", "\"1 mm\"", "dyad.0.branch: found \"1 mm\"", "1 or -1"},
           {"analysis.rpm", "\"3 m\"", "analysis.rpm: found \"3 m\", a length", "\"3000 rpm\""},
           {"analysis.rpm", "\"300 1/s\"", "found \"300 1/s\", a number in s^-1", "\"3000 rpm\""},
       }) {
    const std::string message = message_of(good, {{c.path, c.value}});
    EXPECT_TRUE(message.starts_with(c.path + "=" + c.value + ": ")) << message;
    EXPECT_NE(message.find(c.found), std::string::npos) << message;
    EXPECT_NE(message.find(", allowed "), std::string::npos) << message;
    EXPECT_NE(message.find(c.allowed), std::string::npos) << message;
  }
  const std::string in_file = message_of(slider_crank("mass = \"3 m\""));
  EXPECT_TRUE(in_file.starts_with("file.toml:6: rod.mass: found \"3 m\", a length, allowed")) << in_file;
  const std::string hill = message_of("[hill]\nmass = [[\"1 kg\"]]\nstiffness = [{ harmonic = 0, cos = [[1]] }]\n");
  EXPECT_TRUE(hill.starts_with("file.toml:2: hill.mass.0.0: found \"1 kg\"")) << hill;
  const std::string unit = message_of("units.length = \"inch\"\n" + good);
  EXPECT_NE(unit.find("found \"inch\", an unknown unit (in meant?), allowed m, mm"), std::string::npos) << unit;
}

TEST(SceneMaterials, GiveYoungsModulusAndDensity) {
  const std::string section = ", area = 1e-4, J = 1e-9";
  const Elastic steel = rod_of("material = \"steel\"" + section);
  EXPECT_EQ(steel.youngs_modulus, 210e9);
  EXPECT_EQ(steel.density, 7850);
  const Body rod = linkage_of(slider_crank("elastic = { material = \"steel\"" + section + " }")).dyads[0].coupler;
  EXPECT_EQ(rod.mass, 7850 * (1e-4 * 0.15));
  EXPECT_EQ(rod_of("material = \"aluminum\"" + section).youngs_modulus, 70e9);
  const Elastic softer = rod_of("material = \"steel\", E = \"200 GPa\", density = 7800" + section);
  EXPECT_EQ(softer.youngs_modulus, 200e9);
  EXPECT_EQ(softer.density, 7800);
  EXPECT_EQ(rod_of("material = \"steel\"" + section, "mass = 0.2, ").density, 7850);
  const std::string in_mm =
      "units.length = \"mm\"\n" + slider_crank("elastic = { material = \"steel\"" + section + " }");
  EXPECT_EQ(linkage_of(in_mm).dyads[0].coupler.elastic->youngs_modulus, 21e7);
  const std::string wrong = message_of(slider_crank("elastic = { material = \"steal\"" + section + " }"));
  EXPECT_NE(
      wrong.find("file.toml:6: rod.elastic.material: found \"steal\", an unknown material (steel meant?), allowed "
                 "steel, stainless steel"),
      std::string::npos)
      << wrong;
}

TEST(SceneSections, OfEveryShapeGiveAreaAndSecondMoment) {
  const auto section = [](const std::string& text) {
    return rod_of("E = 2e11, section = { " + text + " }", "mass = 1, ");
  };
  const Elastic tube = section("shape = \"tube\", outer = \"20 mm\", inner = \"16 mm\"");
  EXPECT_DOUBLE_EQ(tube.area, pi / 4 * (4e-4 - 2.56e-4));
  EXPECT_DOUBLE_EQ(tube.second_moment, pi / 64 * (1.6e-7 - 0.65536e-7));
  EXPECT_EQ(tube.section_height, 0.02);
  const Elastic beam = section("shape = \"I\", width = 0.02, height = 0.03, web = 0.004, flange = 0.005");
  EXPECT_DOUBLE_EQ(beam.area, 2 * 0.02 * 0.005 + 0.02 * 0.004);
  EXPECT_DOUBLE_EQ(beam.second_moment, (0.02 * std::pow(0.03, 3) - 0.016 * std::pow(0.02, 3)) / 12);
  EXPECT_EQ(beam.section_height, 0.03);
  const Elastic box = section("shape = \"box\", width = 0.02, height = 0.03, wall = 0.002");
  EXPECT_DOUBLE_EQ(box.area, 0.02 * 0.03 - 0.016 * 0.026);
  EXPECT_DOUBLE_EQ(box.second_moment, (0.02 * std::pow(0.03, 3) - 0.016 * std::pow(0.026, 3)) / 12);
  EXPECT_EQ(section("shape = \"round\", diameter = 0.01").section_height, 0.01);
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"shape = \"tube\", outer = 0.02, inner = 0.02", "section.inner: found 0.02, allowed less than outer"},
           {"shape = \"tube\", outer = 0.02, wall = 0.001",
            "section.outer: found on the shape tube, allowed diameter and wall"},
           {"shape = \"I\", width = 0.02, height = 0.03, web = 0.03, flange = 0.005", "allowed at most the width"},
           {"shape = \"I\", width = 0.02, height = 0.03, web = 0.003, flange = 0.05", "at most half the height"},
           {"shape = \"box\", width = 0.02, height = 0.03, wall = 0.011", "at most half the smaller side"},
           {"shape = \"I\", width = 0.02, height = 0.03", "section.web: found nothing"},
           {"shape = \"H\", width = 0.02", "allowed rectangle, tube, round, I, box"},
       }) {
    const std::string message =
        message_of(slider_crank("mass = 1, elastic = { E = 2e11, section = { " + text + " } }"));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

// At rest mode i decays as exp(-zeta_i omega_i t): b_ii/(2 m_ii) of the equations that are solved.
TEST(SceneDamping, RatioIsThatOfTheModeItNames) {
  const auto damping = [](const std::string& ratio, int mode) {
    const Body rod =
        linkage_of(
            slider_crank("elastic = { material = \"steel\", area = 1e-4, J = 1e-9, damping_ratio = " + ratio + " }"))
            .dyads[0]
            .coupler;
    const Elastic& e = *rod.elastic;
    const double k = mode * pi / rod.length, mu = rod.mass / rod.length, EJ = e.youngs_modulus * e.second_moment;
    const double m = e.density / e.youngs_modulus * k * k + mu / EJ, b = e.internal_damping * std::pow(k, 4);
    return b / (2 * m) / std::sqrt(std::pow(k, 4) / m);
  };
  EXPECT_NEAR(damping("0.01", 1), 0.01, 1e-16);
  EXPECT_NEAR(damping("\"1 %\"", 1), 0.01, 1e-16);
  EXPECT_NEAR(damping("{ mode = 2, ratio = 0.03 }", 2), 0.03, 1e-16);
  EXPECT_NEAR(damping("{ ratio = 0.03 }", 1), 0.03, 1e-16);
  const std::string base = "mass = 1, elastic = { E = 2e11, area = 1e-4, J = 1e-9, ";
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"damping_ratio = 0.01, damping_internal = 1e-5", "damping_ratio: found beside damping_internal"},
           {"damping_ratio = -0.01", "damping_ratio: found -0.01, allowed a damping ratio from 0 to 1"},
           {"damping_ratio = 2", "damping_ratio: found 2"},
           {"damping_ratio = { mode = 0, ratio = 0.1 }", "damping_ratio.mode: found 0"},
           {"damping_ratio = { mode = 1 }", "damping_ratio.ratio: found nothing"},
           {"damping_ratio = { mod = 1, ratio = 0.1 }", "mode meant?"},
           {"damping_ratio = \"1 mm\"", "found \"1 mm\", a length"},
       }) {
    const std::string message = message_of(slider_crank(base + text + " }"));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST(SceneShear, IsReadAndChecked) {
  const std::string base = "E = 2e11, area = 1e-4, J = 1e-9, shear = ";
  const Elastic rod = rod_of(base + "{ G = \"80 GPa\", k = 0.85 }", "mass = 1, ");
  ASSERT_TRUE(rod.shear);
  EXPECT_EQ(rod.shear->modulus, 80e9);
  EXPECT_EQ(rod.shear->coefficient, 0.85);
  EXPECT_FALSE(rod_of("E = 2e11, area = 1e-4, J = 1e-9", "mass = 1, ").shear);
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"{ G = 0, k = 0.85 }", "rod.elastic.shear.G: found 0"},
           {"{ G = 8e10, k = -1 }", "rod.elastic.shear.k: found -1"},
           {"{ G = 8e10 }", "rod.elastic.shear.k: found nothing"},
           {"{ G = 8e10, kappa = 0.85 }", "found an unknown key"},
           {"3", "rod.elastic.shear: found 3, allowed a table"},
       }) {
    const std::string message = message_of(slider_crank("mass = 1, elastic = { " + base + text + " }"));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}
