// Mistakes that users made at their first attempts, and what they have to be told.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/run_command.hpp"

namespace {

struct Misuse {
  const char* name;
  // Changes of the six-link scene, written as scene.toml: what stands there, what is written instead.
  std::vector<std::pair<const char*, const char*>> edits;
  const char* arguments;
  int status;
  std::vector<const char*> said;  // on either stream, each
  std::vector<const char*> not_said = {};
};

class Misused : public CommandTest, public testing::WithParamInterface<Misuse> {};

TEST_P(Misused, IsToldInTheWordsOfWhatWasWritten) {
  const Misuse& misuse = GetParam();
  std::string text = read(HB_SOURCE_DIR "/tests/scenes/six_link.toml");
  for (const auto& [from, to] : misuse.edits) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, std::string(from).size(), to);
  }
  std::ofstream(folder_ / "scene.toml") << text;
  // Angles, as a table over one turn has them, before three stiffnesses.
  std::ofstream table(folder_ / "table.csv");
  for (int k = 0; k < 36; ++k) table << 10 * k << "," << 1 + 0.01 * k << ",0.1,4\n";
  table.close();
  std::ofstream(folder_ / "hill.toml")
      << "[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { file = \"table.csv\" }\n[analysis]\nomega = 1\n";
  // Angles in degrees that nothing says are degrees: over one turn and over the two of a four-stroke engine.
  for (const auto& [name, first, last] : {std::tuple("degrees", "angle,k11,k12,k22\n", 350), {"cycle", "", 710}}) {
    std::ofstream angles(folder_ / (std::string(name) + ".csv"));
    angles << first;
    for (int k = 0; k <= last; k += 10) angles << k << "," << 1 + 0.001 * (k % 360) << (last < 360 ? ",0.1,4\n" : "\n");
  }
  std::ofstream(folder_ / "degrees.toml")
      << "[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { file = \"degrees.csv\" }\n[analysis]\nomega = 1\n";
  std::ofstream(folder_ / "pressure.csv") << "crank angle [deg],pressure [bar]\n0,1\n90,2\n180,3\n270,2\n";
  std::ofstream(folder_ / "press.toml")
      << "[crank]\npivot = [0, 0]\nlength = \"50 mm\"\n[[dyad]]\non = \"crank\"\nbranch = 1\n"
      << "coupler = { name = \"rod\", length = \"0.3 m\", mass = 1 }\n"
      << "slider = { name = \"piston\", guide = [0, 0], force = { file = \"pressure.csv\" } }\n";
  // Row numbers before the stiffnesses, and numbers as a European spreadsheet writes them.
  std::ofstream rows(folder_ / "rows.csv"), commas(folder_ / "commas.csv");
  for (int k = 1; k <= 36; ++k) rows << k << ",1,0.1,4\n", commas << "1,5;0,1;0,1;4,0\n";
  for (const char* name : {"rows", "commas"})
    std::ofstream(folder_ / (std::string(name) + ".toml"))
        << "[hill]\nmass = [[1, 0], [0, 1]]\nstiffness = { file = \"" << name << ".csv\" }\n[analysis]\nomega = 1\n";
  rows.close(), commas.close();
  const CommandResult result = hb(misuse.arguments);
  const std::string all = result.out + result.err;
  EXPECT_EQ(result.status, misuse.status) << all;
  for (const char* part : misuse.said) EXPECT_NE(all.find(part), std::string::npos) << part << "\n" << all;
  for (const char* part : misuse.not_said) EXPECT_EQ(all.find(part), std::string::npos) << part << "\n" << all;
  if (misuse.status == 2) {
    EXPECT_TRUE(result.out.empty()) << result.out;
    if (*misuse.arguments != '\0') {
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
  }
}

const std::vector<Misuse> misuses = {
    // Scenes
    {"youngs_modulus_in_megapascal",
     {{"21e7", "210000"}},
     "scene scene.toml",
     0,
     {"WARNING", "found 210 MPa; 210 GPa if the number was in MPa"}},
    {"youngs_modulus_in_psi",
     {{"21e7", "30e6"}, {"length = \"mm\"", "length = \"in\"\nmass = \"lb\""}},
     "scene scene.toml",
     0,
     {"WARNING", "206.8 GPa if the number was in psi"}},
    {"gravity_of_another_unit",
     {{"gravity = 9810", "gravity = 9.81"}},
     "scene scene.toml",
     0,
     {"WARNING", "9.81 m/s^2 if the number was in m/s^2"}},
    {"second_moment_of_a_misprint",
     {{"area = 10, J = 45", "area = 10, J = 4500"}},
     "scene scene.toml",
     0,
     {"WARNING", "J/area^2 = 45", "a square 1/12"}},
    {"angles_taken_for_stiffnesses", {}, "steady hill.toml", 2, {"table.csv:1", "angles in the first column", "k11"}},
    {"degrees_that_nothing_says_are_degrees",
     {},
     "scene degrees.toml",
     2,
     {"angles in deg are told by the column's name in a first line: angle [deg]"}},
    {"cycle_of_two_turns_in_degrees",
     {},
     "scene press.toml --set 'piston.force.file=\"cycle.csv\"'",
     2,
     {"angles in deg are told by"}},
    {"pressure_as_force",
     {},
     "scene press.toml",
     2,
     {"in bar, a pressure", "pressure = { file, bore } turns a pressure into a force"}},
    {"text_without_quotes",
     {{"title = \"Six-link mechanism\"", "title = Six-link mechanism"}},
     "scene scene.toml",
     2,
     {"text needs quotes: title = \"Six-link mechanism\""}},
    {"decimal_comma",
     {{"length = 55", "length = 55,5"}},
     "scene scene.toml",
     2,
     {"The decimal point is a point: length = 55.5"}},
    {"damping_ratio_is_a_key",
     {{"damping_internal = 1e-4", "damping_ratio = 0.01"}},
     "scene scene.toml",
     0,
     {"ratio 0.01 of mode 1"},
     {"damping_x meant"}},
    {"damping_ratio_misspelt",
     {{"damping_internal = 1e-4", "damping_ration = 0.01"}},
     "scene scene.toml",
     2,
     {"damping_ratio meant?"}},
    {"branch_left_out",
     {{"branch = -1", "# branch"}},
     "scene scene.toml",
     2,
     {"dyad.0.branch", "counter-clockwise (1) or clockwise (-1)"}},
    {"mass_left_out", {{"mass = 0.165, ", ""}}, "scene scene.toml", 2, {"AB.mass", "density or material"}},
    {"unknown_section",
     {{"area = 10, J = 45", "section = { shape = \"circle\", diameter = 3 }"}},
     "scene scene.toml",
     2,
     {"\"circle\"", "round", "tube"}},
    {"unit_by_its_long_name", {{"length = \"mm\"", "length = \"inch\""}}, "scene scene.toml", 2, {"in meant?"}},
    {"dyads_are_counted_one_way",
     {{"pivot = [570, 0]", "pivot = [5700, 0]"}},
     "scene scene.toml",
     2,
     {"dyad.1", "(CD, O3D)", "does not close"},
     {"dyad 2"}},
    {"inertia_less_than_the_mass_has",
     {},
     "steady scene.toml --rpm 300 --modes 1",
     0,
     {},
     {"inertia_pivot", "allowed"}},
    {"range_without_its_name",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --over 300:400",
     2,
     {"as in rpm=300:400"}},
    {"number_without_its_unit",
     {},
     "steady scene.toml --rpm 300 --set 'AB.length=\"55 kg\"'",
     2,
     {"a mass", "\"55 mm\""}},
    {"gravity_upward", {}, "scene scene.toml --set gravity=-9810", 0, {"WARNING", "points up"}},
    {"section_as_large_as_the_rod",
     {{"area = 10, J = 45", "section = { shape = \"rectangle\", width = 9, height = 500 }"}},
     "scene scene.toml",
     0,
     {"WARNING", "no rod; are section and length in their units?"},
     {"shear, left out"}},
    {"shear_modulus_in_another_unit",
     {{"area = 10, J = 45", "area = 10, J = 45, shear = { G = \"80 MPa\", k = 45 }"}},
     "scene scene.toml",
     0,
     {"found 80 MPa; 80 GPa if the number was in GPa", "found 45 (the share of the section"}},
    {"damping_ratio_as_damping_internal",
     {{"damping_internal = 1e-4", "damping_internal = 0.01"}},
     "scene scene.toml",
     0,
     {"WARNING", "a damping ratio of 2.8", "damping_ratio takes a ratio"}},
    {"mass_in_gram", {{"mass = 1.84", "mass = 1840"}}, "scene scene.toml", 0, {"WARNING", "found O2BC with 1840 kg"}},
    {"row_numbers_before_samples", {}, "scene rows.toml", 2, {"rows.csv:1", "found row numbers in the first column"}},
    {"decimal_commas_in_a_table",
     {},
     "scene commas.toml",
     2,
     {"commas.csv:1", "\"1,5\" between semicolons", "a decimal point"}},
    {"unit_in_other_letters", {}, "scene scene.toml --set 'AB.E=70 GPA'", 2, {"unknown unit GPA (GPa meant?)"}},
    // Speeds and ranges
    {"speed_twice", {}, "steady scene.toml --rpm 300 --rpm 400", 2, {"--rpm: found 2 times, allowed once"}},
    {"flag_without_its_value", {}, "steady scene.toml --rpm", 2, {"--rpm: found nothing behind it"}},
    {"flag_with_one_dash", {}, "steady scene.toml -rpm 300", 2, {"unknown flag -rpm (--rpm meant?)"}},
    {"flag_that_is_like_no_other", {}, "steady scene.toml --verbose", 2, {"unknown flag --verbose"}, {"meant"}},
    {"no_speeds_for_a_sweep", {}, "sweep scene.toml", 2, {"allowed: --rpm FROM:TO:STEP"}},
    {"help_of_a_command", {}, "help steady", 0, {"Usage: hb steady"}},
    {"limit_in_minutes", {}, "steady scene.toml --rpm 300 --modes 1 --time-limit '1 min'", 0, {"stable"}},
    {"limit_in_another_unit",
     {},
     "steady scene.toml --rpm 300 --time-limit 3kg",
     2,
     {"seconds from 0.001", "\"2 min\""}},
    {"misspelt_flag", {}, "steady scene.toml --rmp 300", 2, {"unknown flag --rmp (--rpm meant?)", "--help"}},
    {"misspelt_long_flag", {}, "steady scene.toml --stabilty-method bound", 2, {"(--stability-method meant?)"}},
    {"range_for_one_speed", {}, "steady scene.toml --rpm 200:300:10", 2, {"one speed"}, {"FROM:TO"}},
    {"one_speed_for_a_range", {}, "sweep scene.toml --rpm 300", 2, {"single speed 300", "FROM:TO:STEP"}},
    {"range_with_a_dash", {}, "sweep scene.toml --rpm 100-300", 2, {"a range is 100:300:10"}},
    {"range_without_a_step", {}, "sweep scene.toml --rpm 100:300", 2, {"a step is missing: 100:300:10 or 100:300:x50"}},
    {"speed_in_another_unit", {}, "steady scene.toml --rpm '5 Hz' --modes 1", 0, {"mechanism, 300 rpm"}},
    {"unit_that_is_no_speed", {}, "steady scene.toml --rpm 300kg", 2, {"300kg, a mass", "\"3000 rpm\""}},
    {"unit_behind_a_tolerance", {}, "steady scene.toml --rpm 300 --tol 1e-6m", 2, {"without a unit: 1e-6"}},
    {"range_with_a_dash_for_one_speed",
     {},
     "steady scene.toml --rpm 100-300",
     2,
     {"a range, of hb sweep, is 100:300:10"}},
    {"speed_in_capitals", {}, "sweep scene.toml --x RPM=200:300:50", 2, {"which names RPM (rpm meant?)"}},
    {"number_of_points_with_its_x_behind", {}, "sweep scene.toml --rpm 200:300:5x", 2, {"x5 meant, 5 points?"}},
    {"negative_bound",
     {},
     "tune scene.toml --vary AB.J=30:60 --minimise mass --keep 'mass<=-1' --over rpm=300:600",
     2,
     {"with \"-1\"; allowed: a number > 0"}},
    {"text_without_its_last_quote",
     {{"\"Six-link mechanism\"", "\"Six-link mechanism"}},
     "scene scene.toml",
     2,
     {":2:", "a quote at the end is missing: title = \"Six-link mechanism\""}},
    {"section_without_a_shape",
     {{"area = 10, J = 45", "section = { width = 3, height = 4 }"}},
     "scene scene.toml",
     2,
     {"AB.elastic.section.shape", "allowed rectangle, tube, round, I, box"}},
    {"dyad_on_nothing", {{"on = \"O2BC.C\"", ""}}, "scene scene.toml", 2, {"dyad.1.on", "O2BC.C"}},
    {"range_that_runs_backwards", {}, "sweep scene.toml --rpm 300:100:10", 2, {"this one runs backwards"}},
    {"unit_at_one_end_of_a_range",
     {},
     "sweep scene.toml --rpm 300 --x AB.length=250:260mm:5",
     2,
     {"250 has no unit beside one that has"}},
    {"unit_of_another_kind_in_a_range",
     {},
     "map scene.toml --x rpm=300:400:3 --y AB.E=190kg:210kg:3",
     2,
     {"--y AB.E", "190kg, a mass", "\"210 GPa\""}},
    {"unit_of_a_number_without_one",
     {},
     "tune scene.toml --minimise mass --vary AB.damping_ratio=1mm:2mm",
     2,
     {"1mm, a length; allowed: plain numbers"}},
    {"unit_of_another_kind_in_a_condition",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --keep 'deflection<=2 kg'",
     2,
     {"2 kg, a mass", "a plain number in mm"}},
    {"misspelt_path_of_a_range",
     {},
     "sweep scene.toml --rpm 300 --x AB.lenght=250mm:260mm:x5",
     2,
     {"AB.length meant?"}},
    {"decimal_comma_in_a_speed", {}, "steady scene.toml --rpm 300,5", 2, {"the decimal point is a point: 300.5"}},
    {"decimal_comma_in_a_number_set",
     {},
     "steady scene.toml --rpm 300 --set AB.J=4,5",
     2,
     {"the decimal point is a point"}},
    {"clockwise_speed", {}, "steady scene.toml --rpm -300", 2, {"mirror the scene"}},
    {"too_many_points", {}, "sweep scene.toml --rpm 1:1000001:1", 2, {"1000001 points", "at most 1000000 points"}},
    {"step_in_a_map",
     {},
     "map scene.toml --x rpm=0.5:6:0.1 --y AB.J=30:60:5",
     2,
     {"the number of points is 0.1", "the third number is no step"}},
    {"a_million_speeds_are_announced",
     {},
     "sweep scene.toml --rpm 1:1000000:1 --modes 1 --no-search --time-limit 3",
     3,
     {"hb sweep: the sweep takes about", "--time-limit"}},
    // Words
    {"nothing_asked",
     {},
     "",
     2,
     {"hb new slider-crank", "hb sweep crank.toml", "periodic steady state at one speed", "one HTML page"}},
    {"page_that_is_no_page", {}, "report scene.toml --rpm 300:400:50 --out x.pdf", 2, {".html or .htm", "to PDF"}},
    {"page_without_an_ending", {}, "report scene.toml --rpm 300:400:50 --out page", 2, {".html or .htm"}},
    {"verdict_alone_of_a_map",
     {},
     "map scene.toml --x rpm=300:500:3 --y AB.J=30:60:3 --modes 1 --only verdict --no-boundaries",
     0,
     {"stable at all points"}},
    {"variable_without_a_range",
     {},
     "tune scene.toml --minimise mass --vary AB.J",
     2,
     {"PATH=FROM:TO, as in AB.J=20:200"}},
    {"height_in_a_unit_that_is_no_length",
     {},
     "tune scene.toml --minimise stress --vary AB.J=20:60 --over rpm=300:600 --height '*=8kg'",
     2,
     {"--height", "8kg, a mass", "\"55 mm\""}},
    {"second_moment_alone",
     {},
     "tune scene.toml --minimise deflection --vary AB.J=20:90 --over rpm=300:310 --modes 1 --speeds 2",
     0,
     {"AB.J varies while area and mass stay"}},
    {"resumed_without_parts", {}, "sweep scene.toml --rpm 300:400:50 --resume", 2, {"--out"}},
    {"misspelt_choice", {}, "steady scene.toml --rpm 300 --only stabilty", 2, {"stability meant?"}},
    {"keep_the_wrong_way_round",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --keep 'frequency<=100'",
     2,
     {"frequency is better large", "allowed: frequency>=100"}},
    {"keep_with_an_equals_sign",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --keep 'stable=5'",
     2,
     {"allowed: stable>=5"}},
    {"misspelt_quantity",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --keep 'stres<=2'",
     2,
     {"(stress meant?)"}},
    {"keep_with_less_instead_of_less_or_equal",
     {},
     "tune scene.toml --minimise mass --vary AB.J=20:90 --keep 'deflection<2'",
     2,
     {"allowed: deflection<=2"}},
    {"unknown_number", {}, "steady scene.toml --rpm 300 --set AB.JJ=3", 2, {"AB.J meant?"}},
    {"bounds_alone_are_called_bounds",
     {},
     "steady scene.toml --rpm 300 --modes 1 --only verdict",
     0,
     {"growth rate       between -"},
     {"+/- 1.5e+03", "WARNING"}},
};

INSTANTIATE_TEST_SUITE_P(Each, Misused, testing::ValuesIn(misuses),
                         [](const testing::TestParamInfo<Misuse>& info) { return std::string(info.param.name); });

}  // namespace
