// Which keys a scene may hold, table by table: one list for reading, for overrides and for proposing the nearest name.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/quantity.hpp"

namespace hb {

struct TableKind;

struct Key {
  std::string_view name;
  const TableKind* table = nullptr;  // what is inside, if the value is a table or a list of tables
  // Of a number or of a list's numbers; in a pair [radius, angle] of the first and of the second. Without: no number,
  // or one that has no unit (counts, [hill] matrices).
  std::optional<Measure> measure, second;

  // Of the number itself (index 0) or of an element of its list.
  const std::optional<Measure>& measure_at(std::size_t index) const { return index == 1 && second ? second : measure; }
};

struct TableKind {
  std::string_view name;
  std::span<const Key> keys;  // empty: any key
  const Key* any = nullptr;  // then: what stands behind each
};

// The whole scene; the other kinds hang below it.
[[nodiscard]] const TableKind& scene_keys();

// The key of this name (in a table of any keys: what each of them holds), or nullptr.
[[nodiscard]] const Key* find_key(const TableKind& kind, std::string_view name);

// The candidate with the smallest edit distance to `name`, or "" if none is near (more than half the letters differ).
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);
[[nodiscard]] std::string nearest_name(std::string_view name, const TableKind& kind);

// "1 row", "2 rows".
[[nodiscard]] std::string counted(std::ptrdiff_t count, std::string_view noun);

// "a, b, c", cut after some twenty names.
[[nodiscard]] std::string joined(const std::vector<std::string>& names);
[[nodiscard]] std::string joined(const TableKind& kind);

}  // namespace hb
