#include "lib/scene/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "lib/scene/scene.hpp"
#include "lib/scene/toml_hint.hpp"

namespace hb {

void Problems::add_line(const std::string& line) {
  if (++count_ <= max_shown) lines_ += (lines_.empty() ? "" : "\n") + line;
}

void Problems::add(const toml::node& where, const std::string& key, const std::string& message) {
  if (full()) {
    ++count_;
    return;
  }
  add_line(place(where) + ": " + (key.empty() ? "" : printable(key) + ": ") + message);
}

void Problems::throw_if_any() const {
  if (count_ == 0) return;
  throw SceneError(count_ <= max_shown ? lines_ : fmt::format("{}\n... and {} more", lines_, count_ - max_shown));
}

std::string Problems::place(const toml::node& where) const {
  const toml::source_region& source = where.source();
  if (!source.path) return file_;
  if (*source.path != file_) return *source.path;
  return fmt::format("{}:{}", file_, source.begin.line);
}

std::string printable(std::string_view text, std::size_t most) {
  std::size_t length = std::min(text.size(), most);
  while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0) == 0x80) --length;
  std::string out;
  for (const char c : text.substr(0, length)) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return length < text.size() ? out + "..." : out;
}

std::string describe(const toml::node& node) {
  if (const auto* value = node.as_string()) return fmt::format("\"{}\"", printable(value->get(), 60));
  if (const auto* value = node.as_integer()) return fmt::format("{}", value->get());
  if (const auto* value = node.as_floating_point()) {
    const std::string text = fmt::format("{}", value->get());
    // "1.0" is not the integer 1.
    return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
  }
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (const auto* value = node.as_array()) return fmt::format("a list of {}", value->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::optional<double> read_number(const toml::node& node, const std::string& key, const Limits& limits,
                                  Problems& problems, const std::optional<Measure>& measure, const Units& units) {
  std::optional<double> value;
  std::string what, or_text;  // what is wrong with a text; what it may be
  if (node.is_integer()) value = static_cast<double>(node.as_integer()->get());
  if (node.is_floating_point()) value = node.as_floating_point()->get();
  if (node.is_string() && measure) {
    const Quantity quantity = parse_quantity(node.as_string()->get(), *measure, units);
    value = quantity.value;
    what = quantity.problem.empty() ? "" : ", " + quantity.problem;
    const std::string example = example_of(measure->dimension);
    or_text = example.empty() ? "" : " or " + example;
  }
  if (value && std::isfinite(*value) && *value <= limits.most &&
      (limits.least_allowed ? *value >= limits.least : *value > limits.least)) {
    return value;
  }
  problems.add(node, key, fmt::format("found {}{}, allowed {}{}", describe(node), what, limits.words, or_text));
  return std::nullopt;
}

TableView TableView::inside(const toml::table& table, std::string path, std::string_view key) const {
  const Key* known = kind_ ? find_key(*kind_, key) : nullptr;
  return {table, std::move(path), *problems_, known ? known->table : nullptr, units_};
}

std::optional<Measure> TableView::measure_of(std::string_view key, std::size_t index) const {
  const Key* known = kind_ ? find_key(*kind_, key) : nullptr;
  return known ? known->measure_at(index) : std::nullopt;
}

std::string TableView::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void TableView::problem(std::string_view key, const std::string& message) const {
  const toml::node* at = node(key);
  problems_->add(at ? *at : *table_, path_of(key), message);
}

void TableView::missing(std::string_view key, std::string_view allowed) const {
  problems_->add(*table_, path_of(key), fmt::format("found nothing (the key is missing), allowed {}", allowed));
}

std::optional<double> TableView::number(std::string_view key, const Limits& limits) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  return read_number(*found, path_of(key), limits, *problems_, measure_of(key, 0), units_);
}

std::optional<int> TableView::integer(std::string_view key, int least, int most) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  if (found->is_integer() && found->as_integer()->get() >= least && found->as_integer()->get() <= most) {
    return static_cast<int>(found->as_integer()->get());
  }
  problem(key, fmt::format("found {}, allowed an integer from {} to {}", describe(*found), least, most));
  return std::nullopt;
}

std::optional<std::string> TableView::text(std::string_view key) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  if (found->is_string()) return found->as_string()->get();
  problem(key, fmt::format("found {}, allowed text in quotes", describe(*found)));
  return std::nullopt;
}

std::optional<std::vector<double>> TableView::numbers(std::string_view key, const Limits& limits) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const toml::array* list = found->as_array();
  if (!list) {
    problem(key, fmt::format("found {}, allowed a list of numbers", describe(*found)));
    return std::nullopt;
  }
  std::vector<double> values;
  values.reserve(list->size());
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::optional<double> value = read_number(*list->get(i), fmt::format("{}.{}", path_of(key), i), limits,
                                                    *problems_, measure_of(key, i), units_);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<std::complex<double>> TableView::pair(std::string_view key, const char* words) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const toml::array* list = found->as_array();
  if (!list || list->size() != 2) {
    problem(key, fmt::format("found {}, allowed {}", describe(*found), words));
    return std::nullopt;
  }
  const auto values = numbers(key, any_number);
  if (!values) return std::nullopt;
  return std::complex<double>((*values)[0], (*values)[1]);
}

std::optional<TableView> TableView::table(std::string_view key) const {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  if (found->is_table()) return inside(*found->as_table(), path_of(key), key);
  problem(key, fmt::format("found {}, allowed a table", describe(*found)));
  return std::nullopt;
}

double TableView::need_number(std::string_view key, const Limits& limits) const {
  if (!has(key)) missing(key, limits.words);
  return number(key, limits).value_or(1);
}

int TableView::need_integer(std::string_view key, int least, int most) const {
  if (!has(key)) missing(key, fmt::format("an integer from {} to {}", least, most));
  return integer(key, least, most).value_or(least);
}

std::string TableView::need_text(std::string_view key, std::string_view allowed) const {
  if (!has(key)) missing(key, allowed);
  return text(key).value_or("");
}

std::string TableView::need_file(std::string_view key) const {
  const std::string name = need_text(key);
  if (name.empty() && has(key) && node(key)->is_string()) problem(key, "found \"\", allowed the name of a file");
  return name;
}

std::complex<double> TableView::need_pair(std::string_view key, const char* words) const {
  if (!has(key)) missing(key, words);
  return pair(key, words).value_or(0);
}

std::optional<TableView> TableView::need_table(std::string_view key) const {
  if (!has(key)) missing(key, "a table");
  return table(key);
}

namespace {

void check_keys(const toml::node& node, const TableKind& kind, const std::string& path, Problems& problems) {
  if (problems.full()) return;
  if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (list->get(i)->is_table()) check_keys(*list->get(i), kind, fmt::format("{}.{}", path, i), problems);
    }
    return;
  }
  const toml::table* table = node.as_table();
  if (!table || kind.any != nullptr) return;
  for (const auto& [key, value] : *table) {
    const std::string_view name = key.str();
    const std::string full = path.empty() ? printable(name, 100) : fmt::format("{}.{}", path, printable(name, 100));
    if (const Key* known = find_key(kind, name)) {
      if (known->table) check_keys(value, *known->table, full, problems);
      continue;
    }
    if (problems.full()) return;
    const std::string near = nearest_name(name, kind);
    problems.add(
        value, full,
        fmt::format("found an unknown key{}, allowed {}", near.empty() ? "" : " (" + near + " meant?)", joined(kind)));
  }
}

}  // namespace

void check_keys(const toml::table& scene, Problems& problems) { check_keys(scene, scene_keys(), "", problems); }

std::string read_text_file(const std::filesystem::path& file) {
  constexpr std::size_t most = 16u << 20;
  const std::string name = file.string();
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw SceneError(name + ": found no such file, allowed a readable text file");
  }
  if (std::filesystem::is_directory(status)) throw SceneError(name + ": found a folder, allowed a text file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw SceneError(name + ": found a file that cannot be opened, allowed a readable text file");
  std::string text;
  std::vector<char> block(1u << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > most) throw SceneError(name + ": found more than 16 MiB, allowed a text file of at most 16 MiB");
  }
  if (in.bad()) throw SceneError(name + ": found a file that cannot be read, allowed a readable text file");
  return text;
}

namespace {

int line_of(const std::string& text, std::size_t offset) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

// The line of this number, from 1.
std::string_view line_at(const std::string& text, toml::source_index number) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < number && at != std::string::npos; ++line) {
    at = text.find('\n', at);
    if (at != std::string::npos) ++at;
  }
  if (at == std::string::npos) return {};
  return std::string_view(text).substr(at, text.find('\n', at) - at);
}

// Offset of the first byte that is no UTF-8 text (or is zero), or npos.
std::size_t first_binary_byte(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xc2 ? 0
                               : lead < 0xe0 ? 2
                               : lead < 0xf0 ? 3
                               : lead < 0xf5 ? 4
                                             : 0;
    if (lead == 0 || length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return i;
    }
    i += length;
  }
  return std::string::npos;
}

// The TOML library limits nesting but for dotted keys a.b.c..., whose tables it then walks by recursion.
void refuse_endless_keys(const std::string& text, const std::string& name) {
  int dots = 0;
  char previous = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '.') {
      dots = previous == '.' ? 0 : dots + 1;
      if (dots > 100) {
        throw SceneError(fmt::format("{}:{}: found a key of more than 100 parts, allowed the keys of a scene", name,
                                     line_of(text, i)));
      }
    } else if (c == ',' || c == '=' || c == '{' || c == '}' || c == '[' || c == ']' || c == '\n') {
      dots = 0;
    }
    if (c != ' ' && c != '\t') previous = c;
  }
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& name) {
  if (const std::size_t at = first_binary_byte(text); at != std::string::npos) {
    throw SceneError(fmt::format("{}:{}: found a binary file (byte {:#04x}), allowed TOML text in UTF-8", name,
                                 line_of(text, at), static_cast<unsigned char>(text[at])));
  }
  refuse_endless_keys(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    const std::string hint = toml_hint(line_at(text, at.line), at.column);
    throw SceneError(fmt::format("{}:{}: column {}: found broken TOML ({}), allowed TOML 1.0{}", name, at.line,
                                 at.column, printable(error.description()), hint.empty() ? "" : "; " + hint));
  }
}

}  // namespace hb
