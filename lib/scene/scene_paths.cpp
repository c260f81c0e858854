#include "lib/scene/scene_paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <span>
#include <sstream>

#include "lib/scene/scene_keys.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

namespace {

std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t dot = path.find('.');
    parts.push_back(path.substr(0, dot));
    if (dot == std::string_view::npos) return parts;
    path = path.substr(dot + 1);
  }
}

std::optional<std::size_t> index_of(std::string_view text) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

const TableKind& kind_in(const TableKind& kind, std::string_view key) { return *find_key(kind, key)->table; }

// A body's table, under the name that paths use for it.
struct BodyTable {
  std::string name;
  toml::table* table;
  const TableKind* kind;
};

std::vector<BodyTable> bodies_of(toml::table& scene) {
  std::vector<BodyTable> bodies;
  if (toml::table* crank = scene["crank"].as_table()) {
    const TableKind& kind = kind_in(scene_keys(), "crank");
    bodies.push_back({"crank", crank, &kind});
    if (const auto* name = crank->get_as<std::string>("name")) bodies.push_back({name->get(), crank, &kind});
  }
  if (toml::array* dyads = scene["dyad"].as_array()) {
    const TableKind& dyad_kind = kind_in(scene_keys(), "dyad");
    for (toml::node& node : *dyads) {
      toml::table* dyad = node.as_table();
      if (!dyad) continue;
      for (const char* role : {"coupler", "rocker", "slider"}) {
        toml::table* body = (*dyad)[role].as_table();
        if (!body) continue;
        if (const auto* name = body->get_as<std::string>("name")) {
          bodies.push_back({name->get(), body, &kind_in(dyad_kind, role)});
        }
      }
    }
  }
  return bodies;
}

// Follows the parts from a node of the given kind (nullptr: keys not listed, only what is there).
std::optional<Slot> walk(toml::node& start, const TableKind* kind, std::span<const std::string_view> parts) {
  toml::node* node = &start;
  const Key* holder = nullptr;  // of the list
  std::string created;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool last = i + 1 == parts.size();
    const std::string part(parts[i]);
    if (toml::array* list = node->as_array()) {
      const auto index = index_of(part);
      if (!index || *index >= list->size()) return std::nullopt;
      if (last) return Slot{list, part, "", holder ? holder->measure_at(*index) : std::nullopt};
      node = list->get(*index);  // the elements are of the list's kind
      continue;
    }
    toml::table* table = node->as_table();
    if (!table) return std::nullopt;
    const Key* key = kind ? find_key(*kind, part) : nullptr;
    toml::node* found = table->get(part);
    if (last && (found || (key && !kind->any))) {
      return Slot{table, part, created, key ? key->measure : std::nullopt};
    }
    if (!found && kind == &scene_keys() && (part == "analysis" || part == "units")) {
      found = &table->insert_or_assign(part, toml::table{}).first->second;
      created = part;
    }
    if (!found) return std::nullopt;
    kind = key ? key->table : nullptr;
    holder = key;
    node = found;
  }
  return std::nullopt;
}

// A key of a body, or of its `elastic` table, which may be left out of the path.
std::optional<Slot> walk_body(const BodyTable& body, std::span<const std::string_view> parts) {
  if (auto slot = walk(*body.table, body.kind, parts)) return slot;
  toml::table* elastic = (*body.table)["elastic"].as_table();
  const Key* key = find_key(*body.kind, "elastic");
  if (!elastic || !key) return std::nullopt;
  return walk(*elastic, key->table, parts);
}

}  // namespace

toml::node* Slot::value() const {
  if (toml::array* list = parent->as_array()) return list->get(*index_of(key));
  return parent->as_table()->get(key);
}

std::vector<Slot> resolve(toml::table& scene, std::string_view path) {
  const std::vector<std::string_view> parts = parts_of(path);
  const std::span<const std::string_view> inner = std::span(parts).subspan(1);
  std::vector<Slot> slots;
  if (!inner.empty()) {
    const bool all_elastic = parts[0] == "*";
    for (const BodyTable& body : bodies_of(scene)) {
      if (all_elastic ? !body.table->contains("elastic") : body.name != parts[0]) continue;
      if (const auto slot = walk_body(body, inner)) slots.push_back(*slot);
      if (!all_elastic) break;
    }
  }
  if (!slots.empty()) return slots;
  if (const auto slot = walk(scene, &scene_keys(), parts)) slots.push_back(*slot);
  return slots;
}

namespace {

// The numbers of a node that `key` holds (nullptr: a table of that kind itself).
void list_numbers(const toml::node& node, const std::string& path, const Key* key, std::size_t index,
                  std::vector<std::string>& paths) {
  if (node.is_integer() || node.is_floating_point()) {
    paths.push_back(path);
  } else if (const auto* text = node.as_string()) {
    const std::optional<Measure> measure = key ? key->measure_at(index) : std::nullopt;
    if (measure && parse_quantity(text->get(), *measure, Units()).value) paths.push_back(path);
  } else if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i)
      list_numbers(*list->get(i), fmt::format("{}.{}", path, i), key, i, paths);
  } else if (const toml::table* table = node.as_table()) {
    const TableKind* kind = key ? key->table : nullptr;
    for (const auto& [name, value] : *table) {
      const bool elastic = name.str() == "elastic" && value.is_table();
      list_numbers(value, elastic ? path : path + "." + std::string(name.str()),
                   kind ? find_key(*kind, name.str()) : nullptr, 0, paths);
    }
  }
}

}  // namespace

std::optional<double> number_at(const Slot& slot, const Units& units) {
  const toml::node* node = slot.value();
  if (!node) return std::nullopt;
  if (node->is_number()) return node->value<double>();
  const auto* text = node->as_string();
  return text && slot.measure ? parse_quantity(text->get(), *slot.measure, units).value : std::nullopt;
}

std::vector<std::string> numeric_paths(const toml::table& scene) {
  std::vector<std::string> paths;
  for (const auto& [key, value] : scene) {
    const Key* known = find_key(scene_keys(), key.str());
    const toml::array* dyads = key.str() == "dyad" ? value.as_array() : nullptr;
    if (!dyads) {
      list_numbers(value, std::string(key.str()), known, 0, paths);
      continue;
    }
    for (std::size_t d = 0; d < dyads->size(); ++d) {
      const toml::table* dyad = dyads->get(d)->as_table();
      if (!dyad) continue;
      for (const auto& [part, body] : *dyad) {
        const toml::table* table = body.as_table();
        const auto* name = table ? table->get_as<std::string>("name") : nullptr;
        list_numbers(body, name ? name->get() : fmt::format("dyad.{}.{}", d, part.str()),
                     find_key(*known->table, part.str()), 0, paths);
      }
    }
  }
  return paths;
}

namespace {

std::string label(const Override& change) { return printable(change.path, 100) + "=" + printable(change.value, 100); }

// Words ("auto", "stainless steel") and numbers with a unit ("210 GPa") get their quotes.
std::string toml_value(const std::string& value) {
  const bool words = !value.empty() && value != "true" && value != "false" && value != "nan" && value != "inf" &&
                     value.front() != ' ' &&
                     std::ranges::all_of(value, [](unsigned char c) { return std::isalpha(c) || c == ' '; });
  const std::optional<NumberText> number = number_and_unit(value);
  const bool quantity = number && !number->unit.empty() && !number->unit.starts_with('_') &&
                        value.find_first_of("\"'\\=[]{}#\n\r\t") == std::string::npos && parse_unit(number->unit).unit;
  return words || quantity ? "\"" + value + "\"" : value;
}

// The document "value = VALUE", whose source is the override itself.
toml::table parse_value(const Override& change) {
  const std::string text = "value = " + toml_value(change.value);
  const bool one_line = change.value.find_first_of("\n\r") == std::string::npos;
  try {
    if (one_line && text.find('\0') == std::string::npos && change.value.size() < 100000) {
      return toml::parse(text, label(change));
    }
  } catch (const toml::parse_error&) {
    // "70 GPA": what is wrong is said where units are read.
    const std::optional<NumberText> number = number_and_unit(change.value);
    const bool letters =
        number && !number->unit.empty() && std::ranges::all_of(number->unit, [](unsigned char c) {
          return std::isalnum(c) || std::string_view("/^*- ").find(static_cast<char>(c)) != std::string_view::npos;
        });
    if (letters && std::isalpha(static_cast<unsigned char>(number->unit[0])))
      return toml::parse("value = \"" + change.value + "\"", label(change));
  }
  const std::size_t comma = change.value.find(',');
  throw SceneError(
      fmt::format("{}: found {}, allowed a TOML value: a number, \"text\" or a list{}", label(change),
                  change.value.empty() ? "nothing" : fmt::format("\"{}\"", printable(change.value, 100)),
                  comma == std::string::npos || change.value.front() == '[' ? "" : "; the decimal point is a point"));
}

[[noreturn]] void refuse_path(const toml::table& scene, const Override& change) {
  std::vector<std::string> known = numeric_paths(scene);
  const std::string near = nearest_name(change.path, known);
  // Keys of the same link, if it is the key that is wrong; else whatever there is.
  std::string_view first = parts_of(change.path)[0];
  if (const auto name = scene["crank"]["name"].value<std::string_view>(); name == first) first = "crank";
  std::vector<std::string> same;
  for (const std::string& path : known) {
    if (parts_of(path)[0] == first) same.push_back(path);
  }
  throw SceneError(fmt::format("{}: found no such number{}, allowed {}", label(change),
                               near.empty() ? "" : " (" + near + " meant?)", joined(same.empty() ? known : same)));
}

void put(const Slot& slot, toml::node& value) {
  if (toml::array* list = slot.parent->as_array()) {
    const auto at = list->erase(list->cbegin() + static_cast<std::ptrdiff_t>(*index_of(slot.key)));
    list->insert(at, std::move(value));
  } else {
    slot.parent->as_table()->insert_or_assign(slot.key, std::move(value));
  }
}

void apply_one(toml::table& scene, const Override& change) {
  const std::size_t count = resolve(scene, change.path).size();
  if (count == 0) refuse_path(scene, change);
  for (std::size_t i = 0; i < count; ++i) {
    toml::table document = parse_value(change);
    put(resolve(scene, change.path)[i], *document.get("value"));
  }
}

}  // namespace

void apply(toml::table& scene, const std::vector<Override>& overrides) {
  for (const Override& change : overrides) apply_one(scene, change);
}

namespace {

// Byte offset of a position of the TOML library: lines and columns from 1, columns in code points.
std::size_t offset_of(const std::string& text, toml::source_position position) {
  std::size_t at = 0;
  if (text.starts_with("\xef\xbb\xbf")) at = 3;
  for (toml::source_index line = 1; line < position.line; ++line) at = text.find('\n', at) + 1;
  for (toml::source_index column = 1; column < position.column && at < text.size(); ++column) {
    ++at;
    while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80) ++at;
  }
  return at;
}

// One value replaced or inserted in the text; nothing if the text gives no place for it.
std::optional<std::string> with_one(const std::string& text, const Slot& slot, const std::string& value) {
  std::string changed = text;
  if (const toml::node* old = slot.value()) {
    const toml::source_region& region = old->source();
    if (region.begin.line == 0) return std::nullopt;
    const std::size_t begin = offset_of(text, region.begin), end = offset_of(text, region.end);
    if (begin > end || end > text.size()) return std::nullopt;
    return changed.replace(begin, end - begin, value);
  }
  const toml::table* table = slot.parent->as_table();
  const std::string entry = slot.key + " = " + value;
  if (!slot.created.empty()) return changed + "\n\n[" + slot.created + "]\n" + entry + "\n";
  if (!table || table->source().begin.line == 0) return std::nullopt;
  std::size_t at = offset_of(text, table->source().begin);
  if (at >= text.size()) return std::nullopt;
  if (text[at] == '{') return changed.insert(at + 1, table->empty() ? " " + entry : " " + entry + ",");
  if (text[at] == '[') {
    at = text.find('\n', at);
    return at == std::string::npos ? changed + "\n" + entry + "\n" : changed.insert(at + 1, entry + "\n");
  }
  return changed.insert(text.starts_with("\xef\xbb\xbf") ? 3 : 0, entry + "\n");  // the scene itself
}

}  // namespace

std::string replaced_text(const std::string& text, const std::string& name, const std::vector<Override>& overrides) {
  std::string current = text;
  for (const Override& change : overrides) {
    toml::table wanted = parse_toml(current, name);
    apply_one(wanted, change);
    const std::size_t count = [&] {
      toml::table scene = parse_toml(current, name);
      return resolve(scene, change.path).size();
    }();
    std::string next = current;
    bool in_place = true;
    for (std::size_t i = 0; i < count && in_place; ++i) {
      toml::table scene = parse_toml(next, name);
      const std::vector<Slot> slots = resolve(scene, change.path);
      const auto changed = i < slots.size() ? with_one(next, slots[i], toml_value(change.value)) : std::nullopt;
      in_place = changed.has_value();
      if (in_place) next = *changed;
    }
    try {
      in_place = in_place && parse_toml(next, name) == wanted;
    } catch (const SceneError&) {
      in_place = false;
    }
    if (!in_place) {
      std::ostringstream whole;
      whole << wanted << '\n';
      next = whole.str();
    }
    current = next;
  }
  return current;
}

}  // namespace hb
