#include "lib/scene/scene_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hb {

namespace {

constexpr Key unit_keys[] = {{"length"}, {"mass"}, {"time"}, {"angle"}};
constexpr TableKind units{"units", unit_keys};

constexpr TableKind points{"points", {}};

constexpr Key crank_key_list[] = {{"name"}, {"pivot"},   {"length"},        {"mass"},
                                  {"com"},  {"inertia"}, {"inertia_pivot"}, {"points", &points}};
constexpr TableKind crank{"crank", crank_key_list};

constexpr Key section_keys[] = {{"shape"}, {"width"}, {"height"}, {"diameter"}, {"wall"}};
constexpr TableKind section{"section", section_keys};

constexpr Key elastic_keys[] = {
    {"E"}, {"area"}, {"J"}, {"section", &section}, {"density"}, {"damping_internal"}, {"damping_x"}, {"damping_y"}};
constexpr TableKind elastic{"elastic", elastic_keys};

constexpr Key coupler_keys[] = {{"name"},
                                {"length"},
                                {"mass"},
                                {"com"},
                                {"inertia"},
                                {"inertia_pivot"},
                                {"points", &points},
                                {"elastic", &elastic}};
constexpr TableKind coupler{"coupler", coupler_keys};

constexpr Key rocker_keys[] = {
    {"name"},          {"pivot"},           {"length"},           {"mass"}, {"com"}, {"inertia"},
    {"inertia_pivot"}, {"points", &points}, {"elastic", &elastic}};
constexpr TableKind rocker{"rocker", rocker_keys};

constexpr Key force_keys[] = {{"cos"}, {"sin"}, {"file"}};
constexpr TableKind force{"force", force_keys};

constexpr Key slider_keys[] = {{"name"}, {"mass"}, {"guide"}, {"direction"}, {"force", &force}, {"points", &points}};
constexpr TableKind slider{"slider", slider_keys};

constexpr Key dyad_keys[] = {{"on"}, {"coupler", &coupler}, {"rocker", &rocker}, {"slider", &slider}, {"branch"}};
constexpr TableKind dyad{"dyad", dyad_keys};

constexpr Key term_keys[] = {{"harmonic"}, {"cos"}, {"sin"}, {"omega_power"}, {"file"}};
constexpr TableKind term{"term", term_keys};

constexpr Key hill_keys[] = {{"mass"}, {"damping"}, {"stiffness", &term}, {"load", &term}};
constexpr TableKind hill{"hill", hill_keys};

constexpr Key analysis_keys[] = {{"modes"}, {"rpm"}, {"omega"}, {"tolerance"}};
constexpr TableKind analysis{"analysis", analysis_keys};

constexpr Key top_keys[] = {{"title"},       {"gravity"},     {"units", &units},      {"crank", &crank},
                            {"dyad", &dyad}, {"hill", &hill}, {"analysis", &analysis}};
constexpr TableKind top{"scene", top_keys};

char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

// Twice the Levenshtein distance, a mere change of case counting half.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto exchange = [](char x, char y) -> std::size_t { return x == y ? 0 : lower(x) == lower(y) ? 1 : 2; };
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = 2 * j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = 2 * i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 2, row[j - 1] + 2, diagonal + exchange(a[i - 1], b[j - 1])});
      diagonal = above;
    }
  }
  return row.back();
}

std::vector<std::string> names_of(const TableKind& kind) {
  std::vector<std::string> names;
  for (const Key& key : kind.keys) names.emplace_back(key.name);
  return names;
}

}  // namespace

const TableKind& scene_keys() { return top; }

const Key* find_key(const TableKind& kind, std::string_view name) {
  const auto found = std::ranges::find(kind.keys, name, &Key::name);
  return found == kind.keys.end() ? nullptr : &*found;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  if (name.size() > 200) return "";
  std::string best;
  std::size_t least = std::max<std::size_t>(2, name.size()) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string nearest_name(std::string_view name, const TableKind& kind) { return nearest_name(name, names_of(kind)); }

std::string counted(std::ptrdiff_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i == 20) return text + ", ...";
    text += (i ? ", " : "") + names[i];
  }
  return text;
}

std::string joined(const TableKind& kind) { return joined(names_of(kind)); }

}  // namespace hb
