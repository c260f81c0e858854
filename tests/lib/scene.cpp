#include "lib/scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <map>

#include "lib/constants.hpp"

using namespace hb;

namespace {

const std::filesystem::path scenes = std::filesystem::path(HB_SOURCE_DIR) / "tests/scenes";

Linkage linkage_of(const Scene& scene) { return std::get<Linkage>(scene.model); }
HillSystem hill_of(const Scene& scene) { return std::get<HillSystem>(scene.model); }

void expect_near(std::complex<double> a, std::complex<double> b, double scale) {
  EXPECT_LE(std::abs(a - b), 4 * eps * scale) << a << " instead of " << b;
}

const char* const four_bar = R"(
[crank]
pivot = [0, 0]
length = 1
[[dyad]]
on = "crank"
coupler = { name = "K", length = 4, mass = 3 }
rocker = { name = "R", pivot = [4, 0], length = 3 }
branch = 1
)";

Linkage four_bar_with(const std::vector<Override>& overrides) {
  return linkage_of(parse_scene(four_bar, "four_bar", overrides));
}

}  // namespace

TEST(Scene, SixLinkSceneGivesThePapersData) {
  const Scene scene = read_scene(scenes / "six_link.toml");
  const Linkage linkage = linkage_of(scene);
  EXPECT_EQ(scene.title, "Six-link mechanism");
  EXPECT_EQ(scene.units.length, "mm");
  EXPECT_EQ(scene.units.length_in_m, 1e-3);
  EXPECT_EQ(scene.units.mass_in_kg, 1);
  EXPECT_EQ(linkage.gravity, 9810);
  EXPECT_EQ(linkage.crank.body.name, "crank");
  EXPECT_EQ(linkage.crank.body.length, 55);
  EXPECT_EQ(linkage.crank.body.mass, 0);
  ASSERT_EQ(linkage.dyads.size(), 2u);

  const Dyad& first = linkage.dyads[0];
  EXPECT_EQ(first.on.body, 0);
  EXPECT_EQ(first.on.point, 55.0);
  EXPECT_EQ(first.branch, -1);
  EXPECT_EQ(first.coupler.name, "AB");
  EXPECT_EQ(first.coupler.length, 259);
  EXPECT_EQ(first.coupler.mass, 0.165);
  ASSERT_TRUE(first.coupler.elastic);
  EXPECT_EQ(first.coupler.elastic->youngs_modulus, 21e7);
  EXPECT_EQ(first.coupler.elastic->area, 10);
  EXPECT_EQ(first.coupler.elastic->second_moment, 45);
  EXPECT_EQ(first.coupler.elastic->internal_damping, 1e-4);
  EXPECT_EQ(first.coupler.elastic->damping_x, 1e-6);
  EXPECT_EQ(first.coupler.elastic->damping_y, 1e-6);
  const double rho = 0.165 / (259 * 10.0);
  EXPECT_NEAR(first.coupler.elastic->density, rho, 4 * eps * rho);
  expect_near(first.coupler.com, 129.5, 130);
  const double inertia = 0.165 * 259 * 259 / 12 + rho * 45 * 259;
  EXPECT_NEAR(first.coupler.inertia, inertia, 8 * eps * inertia);

  const Rocker& rocker = std::get<Rocker>(first.closing);
  EXPECT_EQ(rocker.body.name, "O2BC");
  EXPECT_EQ(rocker.pivot, std::complex<double>(270, 0));
  EXPECT_EQ(rocker.body.mass, 1.84);
  expect_near(rocker.body.com, std::polar(118.0, -0.15), 118);
  EXPECT_NEAR(rocker.body.inertia + 1.84 * 118 * 118, 18300, 100 * eps * 18300);
  ASSERT_EQ(rocker.body.points.size(), 1u);
  expect_near(rocker.body.points.at("C"), std::polar(200.0, -0.3), 200);

  const Dyad& second = linkage.dyads[1];
  EXPECT_EQ(second.on.body, closing_index(0));
  EXPECT_EQ(second.on.name, "O2BC.C");
  EXPECT_EQ(second.on.point, rocker.body.points.at("C"));
  EXPECT_EQ(std::get<Rocker>(second.closing).pivot, std::complex<double>(570, 0));
  EXPECT_EQ(elastic_links(linkage), (std::vector<int>{1, 3}));

  EXPECT_EQ(std::get<int>(scene.analysis.modes), 5);
  EXPECT_EQ(scene.analysis.rpm->from, 300);
  EXPECT_EQ(scene.analysis.rpm->step, 0);
  EXPECT_EQ(scene.analysis.tolerance, 1e-10);
  // The paper's J_O are below m s^2: kept, and said of each; it changes nothing.
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.notes.size(), 2u);
  EXPECT_NE(
      scene.notes[0].find("six_link.toml:15: O2BC.inertia_pivot: found 18300 kg mm^2, below mass radius^2 of com = "
                          "25620.2 kg mm^2"),
      std::string::npos)
      << scene.notes[0];
  EXPECT_NE(scene.notes[1].find("six_link.toml:21: O3D.inertia_pivot: found 11500 kg mm^2"), std::string::npos)
      << scene.notes[1];
}

TEST(Scene, TheSceneAsPrintedDiffersInJAlone) {
  const Linkage linkage = linkage_of(read_scene(scenes / "six_link_4500.toml"));
  for (const Dyad& dyad : linkage.dyads) EXPECT_EQ(dyad.coupler.elastic->second_moment, 4500);
  EXPECT_EQ(linkage.dyads[1].coupler.mass, 0.163);
}

TEST(Scene, DensityGivesTheMassOfAnElasticRocker) {
  const Scene scene = read_scene(scenes / "four_bar.toml");
  const Linkage linkage = linkage_of(scene);
  const Body& rocker = std::get<Rocker>(linkage.dyads[0].closing).body;
  EXPECT_NEAR(rocker.mass, 2700 * 6e-5 * 0.3, 4 * eps * rocker.mass);
  EXPECT_EQ(rocker.elastic->density, 2700);
  EXPECT_EQ(rocker.elastic->internal_damping, 0);
  EXPECT_EQ(linkage.gravity, 0);
  EXPECT_EQ(linkage.crank.pivot, std::complex<double>(0.1, -0.05));
  EXPECT_EQ(scene.analysis.rpm->from, 60);
  EXPECT_EQ(scene.analysis.rpm->to, 600);
  EXPECT_EQ(scene.analysis.rpm->step, 30);
  EXPECT_EQ(elastic_links(linkage), (std::vector<int>{1, 2}));
}

TEST(Scene, RigidLinksWithMassAloneAreUniformBars) {
  const Linkage linkage = four_bar_with({{"R.mass", "2"}, {"crank.mass", "5"}});
  const Body& coupler = linkage.dyads[0].coupler;
  expect_near(coupler.com, 2, 2);
  EXPECT_NEAR(coupler.inertia, 3.0 * 16 / 12, 8 * eps * coupler.inertia);
  expect_near(std::get<Rocker>(linkage.dyads[0].closing).body.com, 1.5, 2);
  EXPECT_NEAR(std::get<Rocker>(linkage.dyads[0].closing).body.inertia, 1.5, 8 * eps);
  expect_near(linkage.crank.body.com, 0.5, 1);
}

TEST(Scene, InertiaAboutJointIsMovedToTheCentreOfMass) {
  const Linkage linkage = four_bar_with({{"K.com", "[1.5, 0.2]"}, {"K.inertia_pivot", "10"}});
  expect_near(linkage.dyads[0].coupler.com, std::polar(1.5, 0.2), 2);
  EXPECT_NEAR(linkage.dyads[0].coupler.inertia, 10 - 3 * 1.5 * 1.5, 20 * eps * 10);
  // A point mass: nothing is left over, rounding included.
  const Linkage point = four_bar_with({{"K.com", "[0.3, 0.7]"}, {"K.inertia_pivot", "0.27"}});
  EXPECT_NEAR(point.dyads[0].coupler.inertia, 0, 4 * eps);
  EXPECT_GE(point.dyads[0].coupler.inertia, 0);
}

TEST(Scene, GravityDefaultsToStandardGravityInTheScenesUnits) {
  EXPECT_EQ(four_bar_with({}).gravity, 9.80665);
  EXPECT_NEAR(four_bar_with({{"units.length", "mm"}}).gravity, 9806.65, 1e-11);
  EXPECT_NEAR(four_bar_with({{"units.length", "\"cm\""}, {"units.time", "\"ms\""}}).gravity, 9.80665e-4, 1e-17);
  EXPECT_EQ(four_bar_with({{"gravity", "-1.5"}}).gravity, -1.5);
}

TEST(Scene, UnitsNameTheirSizes) {
  const auto units_with = [](const std::string& key, const std::string& unit) {
    return parse_scene(four_bar, "four_bar", {{"units." + key, "\"" + unit + "\""}}).units;
  };
  const std::vector<std::pair<std::string, double>> lengths = {
      {"m", 1}, {"mm", 1e-3}, {"cm", 1e-2}, {"dm", 0.1}, {"um", 1e-6}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}};
  for (const auto& [name, size] : lengths) EXPECT_EQ(units_with("length", name).length_in_m, size) << name;
  const std::vector<std::pair<std::string, double>> masses = {
      {"kg", 1}, {"g", 1e-3}, {"mg", 1e-6}, {"t", 1e3}, {"lb", 0.45359237}};
  for (const auto& [name, size] : masses) EXPECT_EQ(units_with("mass", name).mass_in_kg, size) << name;
  const std::vector<std::pair<std::string, double>> times = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}};
  for (const auto& [name, size] : times) EXPECT_EQ(units_with("time", name).time_in_s, size) << name;
  const Units mm = units_with("length", "mm");
  EXPECT_NEAR(mm.force_in_newton(), 1e-3, 1e-18);
  EXPECT_NEAR(mm.torque_in_newton_metre(), 1e-6, 1e-21);
}

TEST(Scene, SpeedIsPerTheScenesUnitOfTime) {
  Units units;
  EXPECT_NEAR(speed_from_rpm(300, units), 10 * pi, 4 * eps * 10 * pi);
  units.time_in_s = 1e-3;
  EXPECT_NEAR(speed_from_rpm(300, units), pi / 100, eps);
  EXPECT_NEAR(rpm_from_speed(speed_from_rpm(1234.5, units), units), 1234.5, 4 * eps * 1234.5);
}

TEST(Scene, AllAnglesFollowTheUnit) {
  const std::string text = R"(
units.angle = "deg"
crank = { pivot = [0, 0], length = 1, points = { P = [2, 90] } }
[[dyad]]
on = "crank.P"
coupler = { name = "K", length = 4, mass = 1, com = [1, 60], inertia = 1 }
slider = { name = "S", guide = [0, 0.5], direction = 30, points = { T = [3, 180] } }
branch = -1
)";
  const Linkage linkage = linkage_of(parse_scene(text, "text"));
  expect_near(linkage.dyads[0].on.point, {0, 2}, 2);
  expect_near(linkage.dyads[0].coupler.com, {0.5, std::sqrt(3.0) / 2}, 1);
  const Slider& slider = std::get<Slider>(linkage.dyads[0].closing);
  EXPECT_NEAR(slider.direction, pi / 6, eps);
  EXPECT_EQ(slider.mass, 0);
  EXPECT_EQ(slider.force.c.size(), 0);
  expect_near(slider.points.at("T"), -3, 3);
}

TEST(Scene, DyadsHangOnPointsOfCouplersAndSliders) {
  const Linkage linkage = linkage_of(read_scene(scenes / "eight_link.toml"));
  ASSERT_EQ(linkage.dyads.size(), 3u);
  EXPECT_EQ(linkage.dyads[1].on.body, coupler_index(0));
  EXPECT_EQ(linkage.dyads[2].on.body, closing_index(1));
  expect_near(linkage.dyads[2].on.point, {0, 4}, 4);
  const FourierSeries& force = std::get<Slider>(linkage.dyads[1].closing).force;
  ASSERT_EQ(force.num_harmonics(), 2);
  for (const double tau : {0.0, 0.7, 3.0}) {
    EXPECT_NEAR(fourier::evaluate(force, tau)(0),
                0.5 + 0.2 * std::cos(tau) - 0.1 * std::sin(tau) + 0.05 * std::sin(2 * tau), 8 * eps);
  }
}

TEST(Scene, SliderForceFromAFilePassesThroughItsRows) {
  const Scene scene = read_scene(scenes / "slider_crank.toml");
  EXPECT_TRUE(std::holds_alternative<AutoModes>(scene.analysis.modes));
  const Linkage linkage = linkage_of(scene);
  const Slider& piston = std::get<Slider>(linkage.dyads[0].closing);
  for (const int degrees : {0, 5, 90, 355}) {
    const double tau = degrees * pi / 180, force = -2e6 * std::exp(3 * (std::cos(tau - 0.2) - 1));
    EXPECT_NEAR(fourier::evaluate(piston.force, tau)(0), force, 0.01) << degrees;  // the file has 9 digits
  }
}

// F = 100 cos t + 20 sin t + 30 sin 2t on 36 rows, written with few decimals; the first row may stand at the end again.
TEST(Scene, SliderForceFromARoundedTableIsTheFunction) {
  const std::filesystem::path folder = testing::TempDir();
  const auto force = [](double t) { return 100 * std::cos(t) + 20 * std::sin(t) + 30 * std::sin(2 * t); };
  for (const int decimals : {3, 4, 5, 6, 8})
    for (const int rows : {36, 37}) {
      std::ofstream table(folder / "rounded.csv");
      table << std::fixed << std::setprecision(decimals);
      for (int j = 0; j < rows; ++j) table << 2 * pi * j / 36 << ',' << force(2 * pi * j / 36) << '\n';
      table.close();
      std::ofstream(folder / "rounded.toml")
          << "[crank]\npivot = [0, 0]\nlength = 1\n[[dyad]]\non = \"crank\"\ncoupler = { name = \"rod\", length = 3 }\n"
             "slider = { name = \"piston\", mass = 1, guide = [0, 0], direction = 0, force = { file = \"rounded.csv\" "
             "} }\n"
             "branch = 1\n";
      const Linkage linkage = linkage_of(read_scene(folder / "rounded.toml"));
      const FourierSeries& found = std::get<Slider>(linkage.dyads[0].closing).force;
      for (int j = 0; j < 100; ++j) {
        const double tau = 2 * pi * j / 100;
        // Half a unit of the last decimal in every force; 1.3 bounds the interpolation's growth of random errors here.
        EXPECT_NEAR(fourier::evaluate(found, tau)(0), force(tau), 1.3 * std::pow(10, -decimals)) << decimals << rows;
      }
    }
}

TEST(Scene, ConstantSliderForceIsHarmonicZero) {
  const std::vector<Override> twelve = {{"piston.force", "-12.5"}};
  const Linkage linkage = linkage_of(read_scene(scenes / "slider_crank.toml", twelve));
  const FourierSeries& force = std::get<Slider>(linkage.dyads[0].closing).force;
  ASSERT_EQ(force.num_harmonics(), 0);
  EXPECT_EQ(force.c(0, 0), -12.5);
}

TEST(Scene, MathieuSceneGivesItsCoefficients) {
  const Scene scene = read_scene(scenes / "mathieu.toml");
  const HillSystem hill = hill_of(scene);
  EXPECT_EQ(hill.mass(0, 0), 1);
  EXPECT_EQ(hill.damping(0, 0), 0.1);
  for (const double tau : {0.0, 1.0, 4.0}) {
    EXPECT_NEAR(fourier::evaluate(hill.stiffness[0], tau)(0), 1.2 + 0.4 * std::cos(tau), 8 * eps);
    EXPECT_NEAR(fourier::evaluate(hill.load[0], tau)(0), std::cos(tau), 8 * eps);
  }
  EXPECT_EQ(hill.stiffness[1].c.size(), 0);
  EXPECT_EQ(scene.analysis.omega->from, 1.0);
  EXPECT_FALSE(scene.analysis.rpm);
  EXPECT_EQ(std::get<int>(scene.analysis.modes), 1);
}

TEST(Scene, HillMatricesStandColumnByColumn) {
  const std::string text = R"(
[hill]
mass = [[1, 0], [0, 2]]
stiffness = [ { harmonic = 0, cos = [[3, 1], [2, 5]] }, { harmonic = 2, sin = [[0, 7], [8, 0]], omega_power = 2 },
              { harmonic = 2, cos = [[0, 1], [0, 0]], omega_power = 2 } ]
)";
  const HillSystem hill = hill_of(parse_scene(text, "text"));
  EXPECT_TRUE(hill.damping.isZero(0));
  EXPECT_EQ(hill.stiffness[0].c.col(0).real(), Eigen::Vector4d(3, 2, 1, 5));
  const double tau = 0.4;
  const Eigen::VectorXd at = fourier::evaluate(hill.stiffness[2], tau);
  EXPECT_NEAR(at(1), 8 * std::sin(2 * tau), 20 * eps);
  EXPECT_NEAR(at(2), 7 * std::sin(2 * tau) + std::cos(2 * tau), 20 * eps);
  EXPECT_EQ(hill.load[0].c.size(), 0);
}

TEST(Scene, SampledStiffnessAndLoadAreInterpolated) {
  const HillSystem hill = hill_of(read_scene(scenes / "sampled_stiffness.toml"));
  for (const double tau : {0.0, 0.9, 5.0}) {
    const Eigen::VectorXd C = fourier::evaluate(hill.stiffness[0], tau);
    EXPECT_NEAR(C(0), 3 + std::cos(tau), 100 * eps);
    EXPECT_NEAR(C(2), 0.25 * std::sin(2 * tau), 100 * eps);  // row 0, column 1
    EXPECT_NEAR(C(1), 0.5 * std::cos(3 * tau), 100 * eps);
    EXPECT_NEAR(C(3), 5, 100 * eps);
    const Eigen::VectorXd h2 = fourier::evaluate(hill.load[2], tau), h0 = fourier::evaluate(hill.load[0], tau);
    EXPECT_NEAR(h2(0), 1 + std::cos(tau), 100 * eps);
    EXPECT_NEAR(h2(1), std::sin(2 * tau), 100 * eps);
    EXPECT_NEAR(h0(0), std::cos(3 * tau), 100 * eps);
    EXPECT_NEAR(h0(1), -2 * std::sin(3 * tau), 100 * eps);
  }
}

TEST(SceneOverrides, EveryNumericPathReadsAndWritesItsOwnNumberOnly) {
  for (const char* file : {"six_link.toml", "four_bar.toml", "eight_link.toml", "slider_crank.toml", "mathieu.toml",
                           "two_oscillators.toml", "sampled_stiffness.toml"}) {
    const SceneSource source(scenes / file);
    const std::vector<std::string> paths = source.numeric_paths();
    ASSERT_FALSE(paths.empty());
    std::map<std::string, double> values;
    for (const std::string& path : paths) values[path] = source.value(path);
    for (const std::string& path : paths) {
      const double old = values[path];
      const Override change = number_override(path, old + 0.125);
      const SceneSource changed(source.text_with({change}), file, scenes);
      for (const std::string& other : paths) {
        EXPECT_EQ(changed.value(other), other == path ? old + 0.125 : values[other]) << file << " " << path;
      }
    }
  }
}

TEST(SceneOverrides, ReachElasticDataWithAndWithoutTheTablesName) {
  const SceneSource source(scenes / "six_link.toml");
  EXPECT_EQ(source.value("AB.J"), 45);
  EXPECT_EQ(source.value("AB.elastic.J"), 45);
  EXPECT_EQ(source.value("*.J"), 45);
  EXPECT_EQ(linkage_of(source.with({{"AB.elastic.J", "50"}})).dyads[0].coupler.elastic->second_moment, 50);
  const Linkage both = linkage_of(source.with({{"*.J", "60"}, {"CD.J", "70"}}));
  EXPECT_EQ(both.dyads[0].coupler.elastic->second_moment, 60);
  EXPECT_EQ(both.dyads[1].coupler.elastic->second_moment, 70);
  const Linkage length = linkage_of(source.with({{"O2BC.pivot.0", "271.5"}, {"O2BC.com.1", "0"}}));
  EXPECT_EQ(std::get<Rocker>(length.dyads[0].closing).pivot, std::complex<double>(271.5, 0));
  EXPECT_EQ(std::get<Rocker>(length.dyads[0].closing).body.com, 118.0);
}

TEST(SceneOverrides, MaySetAnAllowedKeyThatTheSceneLeavesOut) {
  const SceneSource source(four_bar, "four_bar", ".");
  EXPECT_EQ(source.with({{"analysis.tolerance", "1e-6"}}).analysis.tolerance, 1e-6);
  EXPECT_EQ(std::get<int>(source.with({{"analysis.modes", "7"}}).analysis.modes), 7);
  EXPECT_TRUE(std::holds_alternative<AutoModes>(source.with({{"analysis.modes", "auto"}}).analysis.modes));
  EXPECT_EQ(linkage_of(source.with({{"dyad.0.branch", "-1"}})).dyads[0].branch, -1);
  EXPECT_EQ(linkage_of(source.with({{"crank.mass", "2"}})).crank.body.mass, 2);
}

TEST(SceneOverrides, NumbersKeepAllTheirDigits) {
  const SceneSource source(four_bar, "four_bar", ".");
  for (const double value : {1.0 / 3, 1e-30, 2.0, 1.7976931348623157e30, 0.1 + 0.2}) {
    EXPECT_EQ(linkage_of(source.with({number_override("K.mass", value)})).dyads[0].coupler.mass, value);
  }
}

TEST(SceneOverrides, TextKeepsCommentsAndOrder) {
  std::ifstream in(scenes / "six_link.toml");
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const SceneSource source(scenes / "six_link.toml");
  std::string expected = text;
  for (std::size_t at = 0; (at = expected.find("J = 45,", at)) != std::string::npos; ++at) {
    expected.replace(at, 7, "J = 61.5,");
  }
  EXPECT_EQ(source.text_with({{"*.J", "61.5"}}), expected);
  EXPECT_EQ(source.text_with({}), text);
}

TEST(SceneOverrides, TextTakesNewKeysAndTables) {
  const SceneSource source("# é comment first\n" + std::string(four_bar), "four_bar", ".");
  const std::string text = source.text_with({{"gravity", "3"},
                                             {"analysis.modes", "4"},
                                             {"analysis.tolerance", "1e-5"},
                                             {"crank.mass", "2"},
                                             {"R.mass", "6"}});
  const Scene scene = parse_scene(text, "changed");
  EXPECT_EQ(linkage_of(scene).gravity, 3);
  EXPECT_EQ(linkage_of(scene).crank.body.mass, 2);
  EXPECT_EQ(std::get<Rocker>(linkage_of(scene).dyads[0].closing).body.mass, 6);
  EXPECT_EQ(std::get<int>(scene.analysis.modes), 4);
  EXPECT_EQ(scene.analysis.tolerance, 1e-5);
  EXPECT_NE(text.find("# é comment first"), std::string::npos);
}

TEST(SceneOverrides, ALinkageThatStopsClosingSaysWhereAndWith) {
  const SceneSource source(four_bar, "four_bar", ".");
  try {
    (void)source.with({{"crank.length", "5"}});
    FAIL() << "accepted";
  } catch (const ObstructedLinkage& error) {
    EXPECT_EQ(error.dyad, 0);
    EXPECT_GE(error.crank_angle, 0);
    EXPECT_LT(error.crank_angle, 2 * pi);
    EXPECT_NE(std::string(error.what()).find("four_bar:5: dyad.0 with crank.length=5: "), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("deg"), std::string::npos) << error.what();
  }
}
