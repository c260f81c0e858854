// Every kind of wrong scene is refused with the line, the key, what was found and what is allowed.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "lib/scene/scene.hpp"
#include "tests/support/wrong_scene.hpp"

using namespace hb;

namespace {

struct Edit {
  std::string from, to;  // first occurrence in the text
  std::string place;  // start of the message
  std::vector<std::string> parts;
};

void expect_refused(const std::string& good, const std::vector<Edit>& edits) {
  ASSERT_EQ(message_of(good), "");
  for (const Edit& edit : edits) {
    SCOPED_TRACE(edit.from + "  ->  " + edit.to);
    std::string text = good;
    const std::size_t at = text.find(edit.from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, edit.from.size(), edit.to);
    const std::string message = message_of(text);
    EXPECT_TRUE(message.starts_with("file.toml:" + edit.place)) << message;
    for (const std::string& part : edit.parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
    EXPECT_NE(message.find("found"), std::string::npos) << message;
    EXPECT_NE(message.find("allowed"), std::string::npos) << message;
  }
}

}  // namespace

TEST(SceneErrors, UnknownKeysAreNamedWithTheNearestOne) {
  expect_refused(linkage_text, {
                                   {"gravity", "gravitty", "2: gravitty", {"gravity meant?"}},
                                   {"length = \"mm\"", "lenght = \"mm\"", "4: units.lenght", {"length meant?"}},
                                   {"length = 55", "lengt = 55", "8: crank.lengt", {"length meant?"}},
                                   {"area = 10", "are = 10", "11: dyad.0.coupler.elastic.are", {"area meant?"}},
                                   {"pivot = [270", "pivott = [270", "12: dyad.0.rocker.pivott", {"pivot meant?"}},
                                   {"guide", "guid", "17: dyad.1.slider.guid", {"guide meant?"}},
                                   {"branch = 1", "brunch = 1", "18: dyad.1.brunch", {"branch meant?"}},
                                   {"sin = [0, 3]", "sine = [0, 3]", "17: dyad.1.slider.force.sine", {"sin meant?"}},
                                   {"modes", "mode", "20: analysis.mode", {"modes meant?"}},
                                   {"[analysis]", "[analyses]", "19: analyses", {"analysis meant?"}},
                                   {"length = 55", "length = 55\nelastic = { J = 1 }", "9: crank.elastic", {}},
                               });
  expect_refused(hill_text, {{"damping", "dampin", "3: hill.dampin", {"damping meant?"}},
                             {"harmonic = 1, cos", "harmonics = 1, cos", "6: hill.load.0.harmonics", {}}});
}

TEST(SceneErrors, MissingKeysAreNamed) {
  expect_refused(linkage_text,
                 {
                     {"length = 55\n", "", "6: crank.length: found nothing", {}},
                     {"pivot = [0, 0]\n", "", "6: crank.pivot", {"[x, y]"}},
                     {"on = \"crank\"\n", "", "9: dyad.0.on", {}},
                     {"name = \"AB\", ", "", "11: dyad.0.coupler.name", {}},
                     {"length = 259, ", "", "11: AB.length", {}},
                     {"mass = 0.165, ", "", "11: AB.mass", {}},
                     {"E = 21e7, ", "", "11: AB.elastic.E", {}},
                     {"area = 10, ", "", "11: AB.elastic.area", {}},
                     {", J = 45", "", "11: AB.elastic.J", {}},
                     {"pivot = [270, 0], ", "", "12: OB.pivot", {}},
                     {"inertia = 1800, ", "", "12: OB.inertia", {"inertia_pivot"}},
                     {"com = [118, 0], ", "", "12: OB.com", {"[radius, angle]"}},
                     {"branch = -1\n", "", "9: dyad.0.branch", {"1 or -1", "counter-clockwise (1)", "of AB"}},
                     {"branch = 1\n", "", "14: dyad.1.branch", {"1 or -1", "the slider", "of CD"}},
                     {"guide = [0, 50], ", "", "17: S.guide", {}},
                 });
  expect_refused(hill_text,
                 {{"mass = [[1, 0], [0, 1]]\n", "", "1: hill.mass", {}},
                  {"harmonic = 0, ", "", "4: hill.stiffness.0.harmonic", {}},
                  {"load = [{ harmonic = 1, cos = [1, 0] }]", "load = [{ harmonic = 1 }]", "6: hill.load.0.cos", {}}});
}

TEST(SceneErrors, WrongTypesAreNamed) {
  expect_refused(
      linkage_text,
      {
          {"\"Six-link\"", "3", "1: title: found 3", {}},
          {"9810", "\"9810\"", "2: gravity: found \"9810\"", {}},
          {"9810", "true", "2: gravity: found true", {}},
          {"9810", "1979-05-27", "2: gravity: found a date", {}},
          {"[units]\nlength = \"mm\"\nangle = \"rad\"", "units = 3", "3: units: found 3", {}},
          {"pivot = [0, 0]", "pivot = [0, 0, 0]", "7: crank.pivot: found a list of 3", {}},
          {"pivot = [0, 0]", "pivot = 0", "7: crank.pivot: found 0", {}},
          {"pivot = [0, 0]", "pivot = [0, \"x\"]", "7: crank.pivot.1: found \"x\"", {}},
          {"on = \"crank\"", "on = 1", "10: dyad.0.on: found 1", {}},
          {"branch = -1", "branch = -1.0", "13: dyad.0.branch: found -1.0", {"1 or -1"}},
          {"points = { C = [200, 0] }",
           "points = { pivot = [200, 0], C = [200, 0] }",
           "12: OB.points.pivot",
           {"another"}},
          {"branch = -1", "branch = 2", "13: dyad.0.branch: found 2", {}},
          {"branch = -1", "branch = 0", "13: dyad.0.branch: found 0", {}},
          {"modes = 5", "modes = 5.0", "20: analysis.modes: found 5", {"integer", "auto"}},
          {"modes = 5", "modes = \"many\"", "20: analysis.modes: found \"many\"", {}},
          {"elastic = { E = 21e7, area = 10, J = 45 }", "elastic = true", "11: AB.elastic: found true", {"a table"}},
          {"points = { C = [200, 0] }", "points = [200, 0]", "12: OB.points: found a list of 2", {}},
          {"force = { cos = [1, 2], sin = [0, 3] }", "force = \"big\"", "17: S.force: found \"big\"", {"file"}},
          {"[crank]\npivot = [0, 0]\nlength = 55",
           "[[crank]]\npivot = [0, 0]\nlength = 55",
           "6: crank: found a list",
           {}},
      });
  expect_refused(hill_text, {{"[[1, 0], [0, 1]]", "1", "2: hill.mass: found 1", {}},
                             {"[[1, 0], [0, 1]]", "[1, 1]", "2: hill.mass.0: found 1", {}},
                             {"[[1, 0], [0, 1]]", "[[1, 0], [0]]", "2: hill.mass.1: found a list of 1", {}},
                             {"[[1, 0], [0, 1]]", "[]", "2: hill.mass: found a list of 0", {}},
                             {"damping = [[0, 0], [0, 0]]", "damping = [[0]]", "3: hill.damping", {"2 x 2"}},
                             {"cos = [1, 0] }", "cos = [1] }", "6: hill.load.0.cos", {"2 numbers"}},
                             {"harmonic = 0", "harmonic = 0.0", "4: hill.stiffness.0.harmonic", {"integer"}},
                             {"omega_power = 1", "omega_power = 3", "5: hill.stiffness.1.omega_power", {"0 to 2"}},
                             {"load = [{ harmonic = 1, cos = [1, 0] }]", "load = 3", "6: hill.load: found 3", {}},
                             {"load = [{ harmonic = 1, cos = [1, 0] }]", "load = [3]", "6: hill.load.0: found 3", {}}});
  const std::string table_dyad = message_of("crank = { pivot = [0, 0], length = 1 }\n[dyad]\non = \"crank\"\n");
  EXPECT_TRUE(table_dyad.starts_with("file.toml:2: dyad: found a table")) << table_dyad;
}

TEST(SceneErrors, NumbersThatCannotBeAreNamed) {
  std::vector<Edit> edits;
  for (const char* bad : {"nan", "inf", "-inf", "1e300"}) {
    edits.push_back({"9810", bad, "2: gravity", {}});
    edits.push_back({"length = 55", std::string("length = ") + bad, "8: crank.length", {}});
    edits.push_back({"J = 45", std::string("J = ") + bad, "11: AB.elastic.J", {}});
    edits.push_back({"pivot = [270", std::string("pivot = [") + bad, "12: OB.pivot.0", {}});
    edits.push_back({"C = [200", std::string("C = [") + bad, "12: OB.points.C.0", {}});
    edits.push_back({"direction = 0", std::string("direction = ") + bad, "17: S.direction", {}});
    edits.push_back({"cos = [1,", std::string("cos = [") + bad + ",", "17: S.force.cos.0", {}});
    edits.push_back({"rpm = [100", std::string("rpm = [") + bad, "21: analysis.rpm", {}});
    edits.push_back({"1e-9", bad, "22: analysis.tolerance", {}});
  }
  for (const char* bad : {"0", "-1", "0.0"}) {
    edits.push_back({"length = 55", std::string("length = ") + bad, "8: crank.length", {bad[0] == '-' ? "-1" : "0"}});
    edits.push_back({"length = 259", std::string("length = ") + bad, "11: AB.length", {}});
    edits.push_back({"mass = 0.165", std::string("mass = ") + bad, "11: AB.mass", {}});
    edits.push_back({"E = 21e7", std::string("E = ") + bad, "11: AB.elastic.E", {}});
    edits.push_back({"area = 10", std::string("area = ") + bad, "11: AB.elastic.area", {}});
    edits.push_back({"J = 45", std::string("J = ") + bad, "11: AB.elastic.J", {}});
    edits.push_back({"J = 45", std::string("J = 45, density = ") + bad, "11: AB.elastic.density", {}});
    edits.push_back({"rpm = [100, 200, 10]", std::string("rpm = ") + bad, "21: analysis.rpm", {}});
    edits.push_back({"rpm = [100, 200, 10]", std::string("rpm = [100, 200, ") + bad + "]", "21: analysis.rpm", {}});
    edits.push_back({"1e-9", bad, "22: analysis.tolerance", {}});
  }
  edits.push_back({"J = 45", "J = 45, damping_y = -1e-9", "11: AB.elastic.damping_y", {">= 0"}});
  edits.push_back({"J = 45", "J = 45, damping_x = -1e-9", "11: AB.elastic.damping_x", {">= 0"}});
  edits.push_back({"J = 45", "J = 45, damping_internal = -1e-9", "11: AB.elastic.damping_internal", {">= 0"}});
  edits.push_back({"mass = 2", "mass = -2", "12: OB.mass", {">= 0"}});
  edits.push_back({"inertia = 1800", "inertia = -1", "12: OB.inertia", {">= 0"}});
  edits.push_back({"com = [118", "com = [-118", "12: OB.com", {"radius"}});
  edits.push_back({"mass = 0.3", "mass = -0.3", "17: S.mass", {">= 0"}});
  edits.push_back({"sin = [0, 3]", "sin = [1, 3]", "17: S.force.sin", {"harmonic 0"}});
  edits.push_back({"rpm = [100, 200, 10]", "rpm = [200, 100, 10]", "21: analysis.rpm", {"from <= to"}});
  edits.push_back({"rpm = [100, 200, 10]", "rpm = [100, 200]", "21: analysis.rpm", {}});
  edits.push_back({"rpm = [100, 200, 10]", "rpm = [100, 200, 1e-9]", "21: analysis.rpm", {"speeds"}});
  edits.push_back({"rpm = [100, 200, 10]", "rpm = 100\nomega = 3", "22: analysis.omega", {"both"}});
  edits.push_back({"1e-9", "1e-15", "22: analysis.tolerance", {"1e-14"}});
  edits.push_back({"1e-9", "0.5", "22: analysis.tolerance", {"0.1"}});
  expect_refused(linkage_text, edits);

  expect_refused(hill_text, {{"[[1, 0], [0, 1]]", "[[1, 0], [0, nan]]", "2: hill.mass.1.1", {}},
                             {"[[1, 0], [0, 1]]", "[[1, 1], [1, 1]]", "2: hill.mass", {"singular"}},
                             {"[[1, 0], [0, 1]]", "[[0, 0], [0, 0]]", "2: hill.mass", {"singular"}},
                             {"cos = [[1, 0]", "cos = [[inf, 0]", "4: hill.stiffness.0.cos.0.0", {}},
                             {"cos = [1, 0] }", "cos = [1, nan] }", "6: hill.load.0.cos.1", {}},
                             {"harmonic = 1, sin", "harmonic = 0, sin", "5: hill.stiffness.1.sin", {"harmonic 0"}},
                             {"omega = 1.5", "omega = 0", "8: analysis.omega", {"> 0"}},
                             {"omega = 1.5", "omega = 1e13", "8: analysis.omega", {"1e12"}},
                             {"omega = 1.5", "modes = 5", "8: analysis.modes", {"2"}}});
}

TEST(SceneErrors, UnknownUnitsAreNamed) {
  expect_refused(linkage_text, {{"\"mm\"", "\"parsec\"", "4: units.length: found \"parsec\"", {"m, mm, cm"}},
                                {"\"mm\"", "\"MM\"", "4: units.length", {}},
                                {"\"rad\"", "\"grad\"", "5: units.angle", {"rad, deg"}},
                                {"length = \"mm\"", "mass = \"pood\"", "4: units.mass", {"kg"}},
                                {"length = \"mm\"", "time = \"h\"", "4: units.time", {"ms"}}});
}

TEST(SceneErrors, WrongNamesAndAttachmentsAreNamed) {
  expect_refused(linkage_text,
                 {
                     {"name = \"CD\"", "name = \"AB\"", "16: AB.name: found \"AB\"", {"another body"}},
                     {"name = \"S\"", "name = \"crank\"", "17: crank.name", {"another body"}},
                     {"name = \"CD\"", "name = \"\"", "16: dyad.1.coupler.name", {}},
                     {"name = \"CD\"", "name = \"C.D\"", "16: dyad.1.coupler.name: found \"C.D\"", {}},
                     {"name = \"CD\"", "name = \"*\"", "16: dyad.1.coupler.name: found \"*\"", {}},
                     {"name = \"CD\"", "name = \"../CD\"", "16: dyad.1.coupler.name", {}},
                     {"name = \"CD\"", "name = \"C D\"", "16: dyad.1.coupler.name", {}},
                     {"name = \"CD\"", "name = \"C\\nD\"", "16: dyad.1.coupler.name", {}},
                     {"C = [200", "\"C C\" = [200", "12: OB.points.C C", {}},
                     {"\"OB.C\"", "\"OB.X\"", "15: dyad.1.on: found \"OB.X\"", {"crank, OB.C"}},
                     {"\"OB.C\"", "\"OB\"", "15: dyad.1.on: found \"OB\"", {"crank, OB.C"}},
                     {"\"OB.C\"", "\"XY.C\"", "15: dyad.1.on: found \"XY.C\"", {"unknown link", "crank, OB.C"}},
                     {"\"OB.C\"", "\"CD.P\"", "15: dyad.1.on: found \"CD.P\"", {"later"}},
                     {"\"crank\"", "\"CD.P\"", "10: dyad.0.on: found \"CD.P\"", {"later"}},
                     {"\"OB.C\"", "\"AB.C\"", "15: dyad.1.on: found \"AB.C\"", {"elastic link"}},
                     {"\"OB.C\"", "\"\"", "15: dyad.1.on", {"unknown link"}},
                 });
}

TEST(SceneErrors, ContradictionsAreNamed) {
  const std::string rocker = "rocker = { name = \"Q\", pivot = [1, 2], length = 3 }\n";
  expect_refused(linkage_text,
                 {
                     {"inertia = 1800", "inertia = 1800, inertia_pivot = 30000", "12: OB.inertia_pivot", {"both"}},
                     {"mass = 0.2,",
                      "mass = 0.2, com = [200, 0], inertia_pivot = 7999,",
                      "16: CD.inertia_pivot: found 7999",
                      {"8000"}},
                     {"mass = 0.165,", "mass = 0.165, com = [1, 0],", "11: AB.com", {"elastic"}},
                     {"mass = 0.165,", "mass = 0.165, inertia = 3,", "11: AB.inertia", {"elastic"}},
                     {"mass = 0.165,", "mass = 0.165, inertia_pivot = 3,", "11: AB.inertia_pivot", {"elastic"}},
                     {"mass = 0.165,", "mass = 0.165, points = { K = [1, 0] },", "11: AB.points", {"two joints"}},
                     {"slider =", rocker + "slider =", "18: dyad.1.slider", {"both"}},
                     {"slider = {", "# {", "14: dyad.1.rocker", {"neither"}},
                     {"force = { cos = [1, 2], sin = [0, 3] }", "force = {}", "17: S.force", {"empty"}},
                     {"force = { cos = [1, 2], sin = [0, 3] }",
                      "force = { cos = [1], file = \"gas_force.csv\" }",
                      "17: S.force",
                      {"beside"}},
                     {"[analysis]",
                      "[hill]\nmass = [[1]]\nstiffness = [{ harmonic = 0, cos = [[1]] }]\n[analysis]",
                      "6: crank",
                      {"beside [hill]", "gravity"}},
                 });
  const std::string nothing = message_of("title = \"x\"\n");
  EXPECT_NE(nothing.find("neither [crank] nor [hill]"), std::string::npos) << nothing;
  const std::string no_dyad = message_of("crank = { pivot = [0, 0], length = 1 }\n");
  EXPECT_NE(no_dyad.find("dyad: found nothing"), std::string::npos) << no_dyad;
  const std::string neither = message_of("crank = { pivot = [0, 0], length = 1 }\ndyad = []\n");
  EXPECT_TRUE(neither.starts_with("file.toml:2: dyad: found a list of 0")) << neither;
}

TEST(SceneErrors, AbsurdSizesAreRefusedAtOnce) {
  expect_refused(linkage_text, {{"modes = 5", "modes = 0", "20: analysis.modes", {"1 to 60"}},
                                {"modes = 5", "modes = 61", "20: analysis.modes", {"1 to 60"}},
                                {"modes = 5", "modes = 999999999999", "20: analysis.modes", {"1 to 60"}}});
  expect_refused(hill_text, {{"harmonic = 1, cos", "harmonic = 10001, cos", "6: hill.load.0.harmonic", {"10000"}},
                             {"harmonic = 1, cos", "harmonic = -1, cos", "6: hill.load.0.harmonic", {"0 to"}}});

  std::string many = "crank = { pivot = [0, 0], length = 1 }\n";
  for (int d = 0; d < 201; ++d) many += "[[dyad]]\n";
  EXPECT_TRUE(message_of(many).starts_with("file.toml:2: dyad: found a list of 201")) << message_of(many);

  std::string row = "[" + std::string(401, '0');
  std::string zeros = "[";
  for (int i = 0; i < 401; ++i) zeros += "0,";
  zeros += "]";
  std::string big = "[hill]\nmass = [";
  for (int i = 0; i < 401; ++i) big += zeros + ",";
  big += "]\nstiffness = []\n";
  EXPECT_NE(message_of(big).find("file.toml:2: hill.mass: found a list of 401"), std::string::npos);

  std::string identity = "[";
  for (int i = 0; i < 100; ++i) {
    identity += "[";
    for (int k = 0; k < 100; ++k) identity += i == k ? "1," : "0,";
    identity += "],";
  }
  identity += "]";
  const std::string wide =
      "[hill]\nmass = " + identity + "\nstiffness = [{ harmonic = 9000, cos = " + identity + " }]\n";
  EXPECT_NE(message_of(wide).find("coefficients"), std::string::npos);

  const std::string long_file(17u << 20, ' ');
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "hb_scene_errors_long.toml";
  std::ofstream(file) << long_file;
  try {
    (void)read_scene(file);
    ADD_FAILURE() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("16 MiB"), std::string::npos) << error.what();
  }
  std::filesystem::remove(file);
}

TEST(SceneErrors, AllProblemsOfASceneAreToldAtOnce) {
  std::string text = linkage_text;
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{{"9810", "nan"},
                                                                                 {"length = 259", "length = -1"},
                                                                                 {"branch = 1\n", "branch = 3\n"},
                                                                                 {"modes = 5", "modes = 0"}}) {
    text.replace(text.find(from), from.size(), to);
  }
  const std::string message = message_of(text);
  for (const char* part : {"file.toml:2: gravity", "file.toml:11: AB.length", "file.toml:18: dyad.1.branch",
                           "file.toml:20: analysis.modes"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "key" + std::to_string(i) + " = 1\n";
  const std::string cut = message_of(many);
  EXPECT_NE(cut.find("more"), std::string::npos);
  EXPECT_LT(std::count(cut.begin(), cut.end(), '\n'), 25);
}

TEST(SceneErrors, LinkagesThatDoNotTurnThroughSayWhere) {
  std::string open = linkage_text;
  open.replace(open.find("length = 55"), 11, "length = 500");
  const std::string message = message_of(open);
  EXPECT_TRUE(message.starts_with("file.toml:9: dyad.0: found ")) << message;
  EXPECT_NE(message.find("deg"), std::string::npos) << message;

  std::string second = linkage_text;
  second.replace(second.find("length = 400"), 12, "length = 40");
  EXPECT_TRUE(message_of(second).starts_with("file.toml:14: dyad.1: found the dyad (CD, S) ")) << message_of(second);

  // A parallelogram passes its dead centres at 0 and 180 degrees.
  const std::string parallelogram = message_of(R"(crank = { pivot = [0, 0], length = 1 }
[[dyad]]
on = "crank"
coupler = { name = "K", length = 4 }
rocker = { name = "R", pivot = [4, 0], length = 1 }
branch = 1
)");
  EXPECT_TRUE(parallelogram.starts_with("file.toml:2: dyad.0: found ")) << parallelogram;
  EXPECT_NE(parallelogram.find("dead centre"), std::string::npos) << parallelogram;
}

TEST(SceneErrors, OverridesAreNamedInPlaceOfTheLine) {
  const auto expect = [](const std::string& path, const std::string& value, const std::string& start) {
    const std::string message = message_of(linkage_text, {{path, value}});
    EXPECT_TRUE(message.starts_with(start)) << message;
    EXPECT_NE(message.find("allowed"), std::string::npos) << message;
  };
  expect("AB.J", "-3", "AB.J=-3: AB.elastic.J: found -3");
  expect("AB.J", "nan", "AB.J=nan: AB.elastic.J: found nan");
  expect("AB.J", "", "AB.J=: found nothing");
  expect("AB.J", "1 2", "AB.J=1 2: found \"1 2\"");
  expect("AB.J", "1\nx = 2", "AB.J=1?x = 2: found");
  expect("AB.j", "1", "AB.j=1: found no such number (AB.J meant?)");
  expect("CD.J", "1", "CD.J=1: found no such number");  // rigid
  expect("*.gravity", "1", "*.gravity=1: found no such number");
  expect("OB.pivot.2", "1", "OB.pivot.2=1: found no such number (OB.pivot.0 meant?)");
  expect("OB.pivot.-1", "1", "OB.pivot.-1=1: found no such number");
  expect("OB.pivot.x", "1", "OB.pivot.x=1: found no such number");
  expect("", "1", "=1: found no such number");
  expect("...", "1", "...=1: found no such number");
  expect("AB", "1", "AB=1: found no such number");
  expect("dyad.7.branch", "1", "dyad.7.branch=1: found no such number");
  expect("analysis.modes", "2.5", "analysis.modes=2.5: analysis.modes: found 2.5");
  expect("units.length", "furlong", "units.length=furlong: units.length: found \"furlong\"");

  const SceneSource source(linkage_text, "file.toml", scene_folder);
  EXPECT_THROW((void)source.value("AB.damping_x"), SceneError);  // not given
  EXPECT_THROW((void)source.value("AB.name"), SceneError);
  EXPECT_THROW((void)source.value("nothing"), SceneError);
  EXPECT_THROW((void)source.text_with({{"nothing", "1"}}), SceneError);
}
