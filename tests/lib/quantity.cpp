#include "lib/scene/quantity.hpp"

#include <gtest/gtest.h>

#include "lib/constants.hpp"
#include "lib/scene/path_quantity.hpp"

using namespace hb;

namespace {

const Units si, mm{"mm", "kg", "s", "deg", 1e-3, 1, 1}, inch{"in", "lb", "s", "rad", 0.0254, 0.45359237, 1};

double value(const char* text, Dimension dimension, const Units& units) {
  const Quantity quantity = parse_quantity(text, {dimension}, units);
  EXPECT_TRUE(quantity.value) << text << ": " << quantity.problem;
  return quantity.value.value_or(0);
}

std::string problem(const char* text, Dimension dimension) {
  const Quantity quantity = parse_quantity(text, {dimension}, si);
  EXPECT_FALSE(quantity.value) << text;
  return quantity.problem;
}

}  // namespace

TEST(Quantity, PowersOfTenAreExact) {
  EXPECT_EQ(value("55 mm", dimension::length, si), 0.055);
  EXPECT_EQ(value("0.3mm", dimension::length, si), 0.3 / 1000);
  EXPECT_EQ(value("210 GPa", dimension::pressure, si), 210e9);
  EXPECT_EQ(value("210 GPa", dimension::pressure, mm), 21e7);
  EXPECT_EQ(value("7850 kg/m^3", dimension::density, mm), 7850 / 1e9);
  EXPECT_EQ(value("7.85 g/cm^3", dimension::density, si), 7.85 * 1000);
  EXPECT_EQ(value("45 mm^4", dimension::second_moment, mm), 45);
  EXPECT_EQ(value("45 mm^4", dimension::second_moment, si), 45 / 1e12);
  EXPECT_EQ(value("1.2 kN", dimension::force, mm), 1.2e6);
  EXPECT_EQ(value("9.81 m/s^2", dimension::acceleration, mm), 9.81 * 1000);
}

TEST(Quantity, UnitsThatASceneIsWrittenInChangeNothing) {
  EXPECT_EQ(value("3.7 in^4", dimension::second_moment, inch), 3.7);
  EXPECT_EQ(value("0.283 lb/in^3", dimension::density, inch), 0.283);
  EXPECT_EQ(value("33.3 deg", dimension::angle, mm), 33.3);
  EXPECT_EQ(value("0.123 rad", dimension::angle, si), 0.123);
  EXPECT_EQ(*parse_quantity("3000 rpm", {dimension::speed, Measure::Base::rpm}, mm).value, 3000);
}

TEST(Quantity, UnitsOfOtherSystemsHaveTheirDefinedSizes) {
  EXPECT_DOUBLE_EQ(value("1 in", dimension::length, mm), 25.4);
  EXPECT_DOUBLE_EQ(value("1 inch", dimension::length, si), 0.0254);
  EXPECT_DOUBLE_EQ(value("2 ft", dimension::length, si), 0.6096);
  EXPECT_DOUBLE_EQ(value("1 lb", dimension::mass, si), 0.45359237);
  EXPECT_DOUBLE_EQ(value("1 lbf", dimension::force, si), 4.4482216152605);
  EXPECT_DOUBLE_EQ(value("30e6 psi", dimension::pressure, si), 30e6 * 6894.757293168361);
  EXPECT_DOUBLE_EQ(value("1 ksi", dimension::pressure, si), 6894757.293168361);
  // One psi is one lbf/in^2, and g = 386.0886 in/s^2 lb/(in s^2).
  EXPECT_DOUBLE_EQ(value("1 psi", dimension::pressure, inch), 9.80665 / 0.0254);
  EXPECT_DOUBLE_EQ(value("2.5 bar", dimension::pressure, si), 2.5e5);
  EXPECT_DOUBLE_EQ(value("90 deg", dimension::angle, si), pi / 2);
  EXPECT_DOUBLE_EQ(value("180°", dimension::angle, si), pi);
  EXPECT_DOUBLE_EQ(value("0.5 rad", dimension::angle, mm), 0.5 * 180 / pi);
  EXPECT_DOUBLE_EQ(*parse_quantity("50 Hz", {dimension::speed, Measure::Base::rpm}, si).value, 3000);
  EXPECT_DOUBLE_EQ(*parse_quantity("3000 rpm", {dimension::speed, Measure::Base::radian}, mm).value, 100 * pi);
  EXPECT_DOUBLE_EQ(value("1 %", dimension::none, si), 0.01);
}

TEST(Quantity, CompoundUnitsAreProductsPowersAndQuotients) {
  for (const char* text : {"3 N/mm^2", "3 MPa", "3N/mm2", "3 N/mm²", "3 N mm^-2", "3 N*mm**-2", "3 N·mm⁻²", "3 N/mm/mm",
                           "3 N/(mm mm)", "3e6 kg/(m s^2)", "3000 mN m^-2 1000 "}) {
    if (std::string_view(text).ends_with("1000 ")) {
      EXPECT_FALSE(parse_quantity(text, {dimension::pressure}, si).value) << text;
    } else {
      EXPECT_DOUBLE_EQ(value(text, dimension::pressure, si), 3e6) << text;
    }
  }
  EXPECT_DOUBLE_EQ(value("0.1 N s/m^2", dimension::damping_per_length, si), 0.1);
  EXPECT_DOUBLE_EQ(value("2 kg m^2", dimension::inertia, mm), 2e6);
}

TEST(Quantity, WrongTextsSayWhatIsWrong) {
  EXPECT_EQ(problem("210", dimension::pressure), "text without a unit");
  EXPECT_EQ(problem("55 kg", dimension::length), "a mass");
  EXPECT_EQ(problem("55 s/s", dimension::length), "a number without unit");
  EXPECT_EQ(problem("nan m", dimension::length), "text that does not begin with a number");
  EXPECT_EQ(problem("inf m", dimension::length), "text that does not begin with a number");
  EXPECT_EQ(problem("mm", dimension::length), "text that does not begin with a number");
  EXPECT_NE(problem("1,2 kN", dimension::force).find("decimal comma"), std::string::npos);
  EXPECT_EQ(problem("12 inches", dimension::length), "the unknown unit inches (in meant?)");
  EXPECT_EQ(problem("210 Mpa", dimension::pressure), "the unknown unit Mpa (MPa meant?)");
  EXPECT_EQ(problem("3 sec", dimension::time), "the unknown unit sec (s meant?)");
  EXPECT_EQ(problem("3 parsec", dimension::length).substr(0, 23), "the unknown unit parsec");
  EXPECT_NE(problem("3 kg/m s^2", dimension::pressure).find("brackets"), std::string::npos);
  for (const char* text : {"3 m^", "3 m^99", "3 (m", "3 m)", "3 /m/", "3 m//s", "3 1.5", "3 m^2^2",
                           "3 ((((((((((m))))))))))", "3 2", "1 2", "3 m^1000000000000", "3 ⁻ m", "3 *m", "1e999 m"}) {
    EXPECT_FALSE(parse_quantity(text, {dimension::length}, si).value) << text;
  }
}

// Numbers given from outside for a place of the scene, as "--x AB.length=250mm:260mm:x5" does.
TEST(PathQuantity, IsTheNumberThatStandsPlainlyAtThePath) {
  const SceneSource six_link(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  EXPECT_EQ(quantity_at(six_link, "AB.length", "0.26 m").value, 260);
  EXPECT_EQ(quantity_at(six_link, "*.E", "210 GPa").value, 21e7);
  EXPECT_EQ(quantity_at(six_link, "CD.elastic.J", "45mm^4").value, 45);
  EXPECT_EQ(quantity_at(six_link, "O2BC.points.C.1", "180 deg").value, pi);
  EXPECT_EQ(quantity_at(six_link, "rpm", "5 Hz").value, 300);
  EXPECT_NEAR(*quantity_at(six_link, "omega", "300 rpm").value, 10 * pi, 1e-14);
}

TEST(PathQuantity, SaysWhatIsWrong) {
  const SceneSource mathieu(HB_SOURCE_DIR "/tests/scenes/mathieu.toml");
  const SceneSource six_link(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  EXPECT_EQ(quantity_at(six_link, "AB.length", "2 kg").problem,
            "a mass; allowed: plain numbers or text with a unit as in \"55 mm\"");
  EXPECT_EQ(quantity_at(mathieu, "hill.mass.0.0", "2 kg").problem,
            "a number with a unit; allowed: plain numbers, this one has no unit");
  EXPECT_THROW((void)quantity_at(six_link, "AB.lenght", "2 mm"), SceneError);
}
