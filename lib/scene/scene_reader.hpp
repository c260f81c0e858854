// Typed, checked access to the TOML tree of a scene. A problem is noted with its place and reading goes on, so that one
// run shows them all; the value handed back after a problem is harmless and never used.
#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene_keys.hpp"

namespace hb {

// Problems found so far, each "place: key: message".
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}

  // `message` says "found ..., allowed ...". Problems past the twentieth are only counted.
  void add(const toml::node& where, const std::string& key, const std::string& message);
  void add_line(const std::string& line);
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ > max_shown; }
  // Throws SceneError if there are any.
  void throw_if_any() const;

  const std::string& file() const { return file_; }
  // "file:line" of a node, or "PATH=VALUE" if an override put it there.
  std::string place(const toml::node& where) const;

 private:
  static constexpr int max_shown = 20;
  std::string file_, lines_;
  int count_ = 0;
};

// Numbers allowed for a key.
struct Limits {
  double least, most;
  bool least_allowed;
  std::string_view words;
};

// Sizes far beyond any unit's use: keeps products of a few of them finite.
inline constexpr double largest_number = 1e40;
inline constexpr Limits any_number{-largest_number, largest_number, true, "a number, at most 1e40 in size"};
inline constexpr Limits positive{1e-40, largest_number, true, "a number > 0 (1e-40 to 1e40)"};
inline constexpr Limits not_negative{0, largest_number, true, "a number >= 0 (at most 1e40)"};
inline constexpr Limits finite_number{-1.7e308, 1.7e308, true, "a finite number"};

// Text as it may stand in a message: control characters as '?', at most `most` bytes of it.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = 300);

// What was found, in words: 3.5, "text", a table, a list of 3.
[[nodiscard]] std::string describe(const toml::node& node);

// A finite number within the limits from an integer or floating-point node or, where a measure is given, from a text
// with a unit; notes the problem otherwise.
[[nodiscard]] std::optional<double> read_number(const toml::node& node, const std::string& key, const Limits& limits,
                                                Problems& problems, const std::optional<Measure>& measure = {},
                                                const Units& units = {});

// A table of the scene, its path ("AB.elastic"), the keys it may hold, the units that its numbers are written in, and
// where to note problems. Readers return nothing if the key is missing or wrong; `need_...` note a missing key as a
// problem.
class TableView {
 public:
  TableView(const toml::table& table, std::string path, Problems& problems, const TableKind* kind = nullptr,
            Units units = {})
      : table_(&table), path_(std::move(path)), problems_(&problems), kind_(kind), units_(std::move(units)) {}
  // The same table under another path, or one inside that `key` holds.
  TableView renamed(std::string path) const { return {*table_, std::move(path), *problems_, kind_, units_}; }
  TableView inside(const toml::table& table, std::string path, std::string_view key) const;

  bool has(std::string_view key) const { return table_->contains(key); }
  const toml::node* node(std::string_view key) const { return table_->get(key); }
  const toml::table& table() const { return *table_; }
  const std::string& path() const { return path_; }
  Problems& problems() const { return *problems_; }
  std::string path_of(std::string_view key) const;

  std::optional<double> number(std::string_view key, const Limits& limits) const;
  std::optional<int> integer(std::string_view key, int least, int most) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key, const Limits& limits) const;
  std::optional<std::complex<double>> pair(std::string_view key, const char* words) const;  // [a, b] as a + i b
  std::optional<TableView> table(std::string_view key) const;

  double need_number(std::string_view key, const Limits& limits) const;
  int need_integer(std::string_view key, int least, int most) const;
  std::string need_text(std::string_view key, std::string_view allowed = "text in quotes") const;
  std::string need_file(std::string_view key) const;  // a name that is not empty
  std::complex<double> need_pair(std::string_view key, const char* words) const;
  std::optional<TableView> need_table(std::string_view key) const;

  // Notes a problem at a key, or at the table if the key is absent.
  void problem(std::string_view key, const std::string& message) const;
  void missing(std::string_view key, std::string_view allowed) const;

 private:
  std::optional<Measure> measure_of(std::string_view key, std::size_t index) const;

  const toml::table* table_;
  std::string path_;
  Problems* problems_;
  const TableKind* kind_;  // nullptr: no key has a unit
  Units units_;
};

// Notes every key of the tree that the scene's key lists do not know.
void check_keys(const toml::table& scene, Problems& problems);

// Bytes of a file of text, at most 16 MiB; throws SceneError if it is missing, a folder, unreadable, binary or too
// large.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

// Parses; throws SceneError with line and column if it is not TOML or nests absurdly deep.
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& name);

}  // namespace hb
