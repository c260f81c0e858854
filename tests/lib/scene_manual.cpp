// The manual names every key that a scene may hold, every unit and every material.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "lib/scene/material.hpp"
#include "lib/scene/scene_keys.hpp"

using namespace hb;

namespace {

std::string manual() {
  std::ifstream in(std::filesystem::path(HB_SOURCE_DIR) / "tools/README.md");
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::size_t begin = text.find("## Scene: every key");
  EXPECT_NE(begin, std::string::npos);
  return text.substr(begin, text.find("\n## ", begin + 1) - begin);
}

// As code: `E`, `crank.length`, `{ G, k }`, [analysis].
bool names(const std::string& text, const std::string& key) {
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    const auto part_of_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    const std::size_t line = text.rfind('\n', at) + 1;
    bool in_code = false;
    for (std::size_t i = line; i < at; ++i) in_code = in_code != (text[i] == '`');
    if (in_code && !part_of_name(text[at - 1]) && !part_of_name(text[at + key.size()])) return true;
  }
  return false;
}

void expect_keys(const TableKind& kind, const std::string& text) {
  for (const Key& key : kind.keys) {
    EXPECT_TRUE(names(text, std::string(key.name))) << kind.name << "." << key.name;
    if (key.table) expect_keys(*key.table, text);
  }
}

}  // namespace

TEST(SceneManual, NamesEveryKey) { expect_keys(scene_keys(), manual()); }

TEST(SceneManual, NamesEveryMaterialWithItsNumbers) {
  const std::string text = manual();
  for (const Material& material : materials()) {
    const std::string row = "| `" + std::string(material.name) + "` | " +
                            std::to_string(static_cast<int>(material.youngs_modulus / 1e9)) + " GPa | " +
                            std::to_string(static_cast<int>(material.density)) + " kg/m^3 |";
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}
