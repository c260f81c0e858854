// Files that are not scenes, and tables of numbers beside them that cannot be read: refused with the line.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "lib/scene/scene.hpp"
#include "tests/support/wrong_scene.hpp"

using namespace hb;

TEST(SceneErrors, WhatIsNotTomlIsRefusedWithLineAndColumn) {
  for (const auto& [text, place] : std::vector<std::pair<std::string, std::string>>{
           {"a = \n", "file.toml:1: column "},
           {"title = \"x\"\ntitle = \"y\"\n", "file.toml:2: column "},
           {"title = \"x\n", "file.toml:1: column "},
           {"[crank\n", "file.toml:1: column "},
           {"gravity = 1e999\n", "file.toml:1: column "},
           {"\n\n\xff\xfe\n", "file.toml:3: found a binary file"},
           {std::string("title = \"a\0b\"\n", 14), "file.toml:1: found a binary file"},
           {"a = " + std::string(100000, '['), "file.toml:1: column "},
           {"", "file.toml: found an empty file"},
           {"# only a comment\n", "file.toml: found an empty file"},
           {"\n \t\n", "file.toml: found an empty file"},
       }) {
    const std::string message = message_of(text);
    EXPECT_TRUE(message.starts_with(place)) << message;
  }
  // What was meant is said where it shows.
  for (const auto& [text, hint] : std::vector<std::pair<std::string, std::string>>{
           {"length = 0,055\n", "; a decimal comma? The decimal point is a point: length = 0.055"},
           {"crank = { length = -1,5, mass = 2 }\n", "a point: length = -1.5"},
           {"a = { material = steel, area = 3 }\n", "; text needs quotes: material = \"steel\""},
           {"a = { E = 210 GPa, area = 3 }\n", "; text needs quotes: E = \"210 GPa\""},
           {"\nE = 210GPa # steel\n", "; text needs quotes: E = \"210GPa\""},
           {"on = crank\n", "; text needs quotes: on = \"crank\""},
       }) {
    const std::string message = message_of(text);
    EXPECT_NE(message.find("found broken TOML"), std::string::npos) << message;
    EXPECT_TRUE(message.ends_with(hint)) << message;
  }
  EXPECT_TRUE(message_of("a = [1, 2\n").ends_with("allowed TOML 1.0")) << message_of("a = [1, 2\n");
  std::string deep = "\n\na";
  for (int i = 0; i < 300000; ++i) deep += ".a";
  EXPECT_TRUE(message_of(deep + " = 1\n").starts_with("file.toml:3: found a key of more than 100 parts"));
  EXPECT_TRUE(message_of("[" + deep.substr(2) + "]\n").starts_with("file.toml:1: found a key of more than 100 parts"));
}

TEST(SceneErrors, WhatIsNotAReadableFileIsRefused) {
  const auto message = [](const std::filesystem::path& file) -> std::string {
    try {
      (void)read_scene(file);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("/no/such/scene.toml"), "/no/such/scene.toml: found no such file, allowed a readable text file");
  EXPECT_NE(message(scene_folder).find("found a folder"), std::string::npos);
  EXPECT_NE(message("/dev/zero").find("allowed"), std::string::npos);
  EXPECT_NE(message(std::string(5000, 'x')).find("found"), std::string::npos);
  const std::filesystem::path binary = std::filesystem::path(testing::TempDir()) / "hb_scene_errors_binary.toml";
  std::ofstream(binary, std::ios::binary) << "\x7f"
                                          << "ELF" << '\x02' << '\0' << '\xff';
  EXPECT_NE(message(binary).find("binary"), std::string::npos) << message(binary);
  std::filesystem::remove(binary);
}

TEST(SceneErrors, WrongTablesOfNumbersAreNamedWithTheirLine) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "hb_scene_errors";
  std::filesystem::create_directories(folder);
  const auto message = [&](const std::string& csv, const char* units) -> std::string {
    std::ofstream(folder / "force.csv") << csv;
    std::string text = linkage_text;
    const std::string force = "{ cos = [1, 2], sin = [0, 3] }";
    text.replace(text.find(force), force.size(), "{ file = \"force.csv\" }");
    text.replace(text.find("\"rad\""), 5, units);
    try {
      (void)parse_scene(text, "file.toml", {}, folder);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  const char *deg = "\"deg\"", *rad = "\"rad\"";
  EXPECT_EQ(message("# comment\nangle, force\n0, 1\n90, 2\n180, 3\n270, 4\n360, 1\n", deg), "");
  EXPECT_EQ(message("0 1\n80 2\n180 3\n270 4\n", deg), "");
  struct Case {
    std::string csv, line;
    std::vector<std::string> parts;
    const char* units;
  };
  for (const Case& c : std::vector<Case>{
           {"0, 1\n90, 2\n90, 3\n270, 4\n", "force.csv:3: ", {"90", "increasing"}, deg},
           {"0, 1\n90, 2\n80, 3\n270, 4\n", "force.csv:3: ", {"80", "increasing"}, deg},
           {"0, 1\n90, 2\n180, x\n270, 4\n", "force.csv:3: ", {"\"x\""}, deg},
           {"0, 1\n90, 2\n180, nan\n270, 4\n", "force.csv:3: ", {"nan"}, deg},
           {"0, 1\n90, 2\n180, inf\n270, 4\n", "force.csv:3: ", {"inf"}, deg},
           {"0, 1\n90\n180, 3\n270, 4\n", "force.csv:2: ", {"1 field,", "2 numbers"}, deg},
           {"0, 1, 5\n90, 2\n", "force.csv:1: ", {"3 fields"}, deg},
           {"0, 1\n90, \n", "force.csv:2: ", {"\"\""}, deg},
           {"a, b\nc, d\n0, 1\n", "force.csv:2: ", {"\"c\""}, deg},
           {"0, 1\n180, 2\n", "force.csv: ", {"2 rows", "at least 3"}, deg},
           {"", "force.csv: ", {"0 rows"}, deg},
           {"0, 1\n90, 2\n180, 3\n270, 4\n360, 7\n", "force.csv:5: ", {"7", "same force"}, deg},
           {"0, 1\n90, 2\n180, 3\n270, 4\n365, 7\n", "force.csv:5: ", {"365", "one turn"}, deg},
           {"0, 1\n90, 2\n180, 3\n270, 4\n", "force.csv:4: ", {"one turn"}, rad},  // degrees given for radians
           {"0, 1\n1, 2\n2, 3\n3, 4\n", "force.csv:4: ", {"half a turn"}, deg},  // radians given for degrees
           {std::string("0, 1\n\0, 2\n", 11), "force.csv", {}, deg},
       }) {
    const std::string text = message(c.csv, c.units);
    EXPECT_TRUE(text.starts_with("file.toml:17: S.force.file: found \"force.csv\"")) << c.csv << text;
    EXPECT_NE(text.find(c.line), std::string::npos) << text;
    for (const std::string& part : c.parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  std::filesystem::remove_all(folder);

  std::string missing = linkage_text;
  missing.replace(missing.find("{ cos = [1, 2], sin = [0, 3] }"), 30, "{ file = \"no_such.csv\" }");
  EXPECT_NE(message_of(missing).find("no such file"), std::string::npos);
  std::string is_folder = linkage_text;
  is_folder.replace(is_folder.find("{ cos = [1, 2], sin = [0, 3] }"), 30, "{ file = \".\" }");
  EXPECT_NE(message_of(is_folder).find("a folder"), std::string::npos);
  std::string columns = hill_text;
  columns.replace(columns.find("load = [{ harmonic = 1, cos = [1, 0] }]"), 39, "load = { file = \"stiffness.csv\" }");
  EXPECT_NE(message_of(columns).find("stiffness.csv:2: found 4 fields, allowed 2"), std::string::npos)
      << message_of(columns);
}
