// Random mutations of good scenes: bytes, lines, numbers, words of the language. Bounded in number; fixed seed.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"
#include "tests/fuzz/scene_mutations.hpp"

namespace {

const std::filesystem::path folder = std::filesystem::path(HB_SOURCE_DIR) / "tests/scenes";

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> good_scenes() {
  std::vector<std::string> texts;
  for (const char* name : {"six_link", "four_bar", "slider_crank", "eight_link", "mathieu", "two_oscillators",
                           "sampled_stiffness", "slider_crank_units"}) {
    texts.push_back(text_of(folder / (std::string(name) + ".toml")));
  }
  return texts;
}

constexpr std::array words = {"nan",
                              "inf",
                              "-inf",
                              "0",
                              "-1",
                              "1e308",
                              "-1e-320",
                              "1e-300",
                              "9223372036854775807",
                              "true",
                              "\"x\"",
                              "[]",
                              "{}",
                              "[[1]]",
                              "[1, 2]",
                              "\"\"",
                              "1979-05-27",
                              "crank",
                              "\"crank\"",
                              "[hill]\n",
                              "[[dyad]]\n",
                              "elastic = {}",
                              "mass = 1",
                              "mass = [[1]]",
                              "force = { file = \"gas_force.csv\" }",
                              "file = \"stiffness.csv\"",
                              "file = \"/\"",
                              "file = \"..\"",
                              "points = { P = [1, 0] }",
                              "on = \"AB.P\"",
                              "branch = 1",
                              "\n",
                              ",",
                              "=",
                              "#",
                              "\"",
                              "'",
                              "{",
                              "}",
                              "[",
                              "]",
                              ".",
                              "0x10",
                              "1_000",
                              "+1",
                              "\\u0000",
                              "\xff",
                              "\xc3\xa9",
                              "\r\n",
                              "gravity = 1\n",
                              "name = \"AB\"",
                              "com = [1, 1]",
                              "inertia_pivot = 1",
                              "density = 1",
                              "omega_power = 2",
                              "harmonic = 9999",
                              "\"210 GPa\"",
                              "\"55 mm\"",
                              "\"1,5 m\"",
                              "\"3 kg/(m s^2)\"",
                              "\"-1e400 mm^2\"",
                              "\"((((1 m\"",
                              "\"90 deg\"",
                              "\"3000 rpm\"",
                              "\"1 %\"",
                              " mm",
                              "/",
                              "^",
                              "material = \"steel\"",
                              "material = \"cheese\"",
                              "damping_ratio = 0.01",
                              "damping_ratio = { mode = 2, ratio = 0.1 }",
                              "section = { shape = \"I\", width = 3, height = 4, web = 1, flange = 1 }",
                              "section = { shape = \"tube\", outer = 4, inner = 2 }",
                              "shear = { G = 1, k = 0.8 }",
                              "force = { file = \"gas_force.csv\", column = 2, unit = \"kN\", scale = -1 }",
                              "pressure = { file = \"gas_force.csv\", unit = \"bar\", bore = 3, mean = 1 }",
                              "column = \"force\"",
                              "unit = \"N\"",
                              "scale = 2"};

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string mutate(std::string text, const std::vector<std::string>& others) {
    for (std::size_t i = 0, n = 1 + below(4); i < n; ++i) one(text, others);
    return text;
  }

  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

 private:
  void one(std::string& text, const std::vector<std::string>& others) {
    const std::size_t at = below(text.size() + 1), length = below(1 + std::min<std::size_t>(20, text.size() - at));
    switch (below(9)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(below(text.size() + 1), length));
        break;
      case 3:
        text.insert(at, words[below(words.size())]);
        break;
      case 4:
        replace_value(text);
        break;
      case 5:
        replace_value(text);
        break;
      case 6:
        swap_lines(text);
        break;
      case 7:
        text.resize(at);
        break;
      default: {
        const std::string& other = others[below(others.size())];
        const std::size_t from = below(other.size() + 1);
        text.insert(at, other.substr(from, below(200)));
      }
    }
  }

  // A run of digits (a number, more or less) or a quoted word becomes something else.
  void replace_value(std::string& text) {
    const std::size_t start = text.find_first_of("0123456789\"", below(text.size() + 1));
    if (start == std::string::npos) return;
    const std::size_t end =
        text[start] == '"' ? text.find('"', start + 1) : text.find_first_not_of("0123456789.e-", start);
    if (end == std::string::npos) return;
    const std::string with =
        below(3) ? std::string(words[below(words.size())]) : std::to_string(int(below(2000)) - 500);
    text.replace(start, end - start + (text[start] == '"' ? 1 : 0), with);
  }

  void swap_lines(std::string& text) {
    const std::size_t a = text.find('\n', below(text.size() + 1));
    if (a == std::string::npos) return;
    const std::size_t b = text.find('\n', a + 1);
    if (b == std::string::npos) return;
    const std::string line = text.substr(a, b - a);
    text.erase(a, b - a);
    text.insert(std::min(text.size(), text.find('\n', below(text.size() + 1))), line);
  }

  std::mt19937 random_;
};

}  // namespace

TEST(MutatedScenes, AreRefusedInWordsOrSound) {
  const std::vector<std::string> scenes = good_scenes();
  Mutator mutator(20240611);
  int accepted = 0;
  for (int i = 0; i < 12000; ++i) {
    const std::string text = mutator.mutate(scenes[mutator.below(scenes.size())], scenes);
    bool good = false;
    const std::string wrong = hb::fuzz::check_scene_text(text, folder.string(), good);
    ASSERT_EQ(wrong, "") << "mutation " << i << ":\n" << text;
    accepted += good;
  }
  // Comments and harmless numbers change too; but a reader that takes everything, or nothing, would be of no use.
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 8000);
  RecordProperty("accepted", accepted);
}

TEST(MutatedScenes, OverridesAreRefusedInWordsOrSound) {
  Mutator mutator(7);
  const hb::SceneSource source(folder / "eight_link.toml");
  const std::vector<std::string> paths = source.numeric_paths();
  int accepted = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string path = paths[mutator.below(paths.size())];
    if (mutator.below(2)) path = mutator.mutate(path, paths);
    std::string value = words[mutator.below(words.size())];
    if (mutator.below(2)) value = mutator.mutate("1.5", paths);
    try {
      (void)source.with({{path, value}});
      ++accepted;
    } catch (const hb::SceneError& error) {
      ASSERT_NE(std::string(error.what()).find("allowed"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_LT(accepted, 3000);
}
