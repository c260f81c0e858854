// Paths of scene numbers ("AB.J", "*.J", "O2BC.pivot.0", "hill.damping.0.0") in the TOML tree.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/quantity.hpp"
#include "lib/scene/scene.hpp"

namespace hb {

// A place in the tree: a key of a table, or an index of an array. The key may be absent where it is allowed.
struct Slot {
  toml::node* parent = nullptr;  // table or array
  std::string key;  // key, or index in digits
  std::string created;  // name of the parent if it was made on the way, see resolve
  std::optional<Measure> measure;  // of the number there, if it has one
  toml::node* value() const;  // nullptr if absent
};

// What is there as a number, a text with a unit converted; nothing if it is no number.
[[nodiscard]] std::optional<double> number_at(const Slot& slot, const Units& units);

// Where a path leads: one place, several for '*', none if the path is unknown. May create the empty tables `analysis`
// and `units` on the way.
[[nodiscard]] std::vector<Slot> resolve(toml::table& scene, std::string_view path);

// Replaces (or inserts) the values, in order. Throws SceneError for an unknown path, with the nearest ones, and for a
// value that is not TOML. Replaced nodes have "PATH=VALUE" as their source.
void apply(toml::table& scene, const std::vector<Override>& overrides);

// All numbers of the tree, texts with units among them; those of elastic links as "AB.J".
[[nodiscard]] std::vector<std::string> numeric_paths(const toml::table& scene);

// `text`, whose tree is `scene` (as parsed, positions included), with the values replaced in place; the result, once
// parsed, equals the tree with the overrides applied.
[[nodiscard]] std::string replaced_text(const std::string& text, const std::string& name,
                                        const std::vector<Override>& overrides);

}  // namespace hb
