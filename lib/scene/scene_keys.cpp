#include "lib/scene/scene_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hb {

namespace {

constexpr Key sub(std::string_view name, const TableKind* kind) { return {name, kind, {}, {}}; }
constexpr Key plain(std::string_view name) { return {name, nullptr, {}, {}}; }
constexpr Key number(std::string_view name, Dimension dimension) { return {name, nullptr, Measure{dimension}, {}}; }
constexpr Key polar(std::string_view name) {
  return {name, nullptr, Measure{dimension::length}, Measure{dimension::angle}};
}
constexpr Key position(std::string_view name) { return number(name, dimension::length); }

constexpr Key unit_keys[] = {plain("length"), plain("mass"), plain("time"), plain("angle")};
constexpr TableKind units{"units", unit_keys};

constexpr Key point_key = polar("");
constexpr TableKind points{"points", {}, &point_key};

constexpr Key name_key = plain("name"), length_key = number("length", dimension::length),
              mass_key = number("mass", dimension::mass), com_key = polar("com"),
              inertia_key = number("inertia", dimension::inertia),
              inertia_pivot_key = number("inertia_pivot", dimension::inertia), points_key = sub("points", &points),
              pivot_key = position("pivot");

constexpr Key crank_key_list[] = {name_key, pivot_key,   length_key,        mass_key,
                                  com_key,  inertia_key, inertia_pivot_key, points_key};
constexpr TableKind crank{"crank", crank_key_list};

constexpr Key section_keys[] = {plain("shape"),
                                number("width", dimension::length),
                                number("height", dimension::length),
                                number("diameter", dimension::length),
                                number("wall", dimension::length),
                                number("outer", dimension::length),
                                number("inner", dimension::length),
                                number("web", dimension::length),
                                number("flange", dimension::length)};
constexpr TableKind section{"section", section_keys};

constexpr Key shear_keys[] = {number("G", dimension::pressure), number("k", dimension::none)};
constexpr TableKind shear{"shear", shear_keys};

constexpr Key ratio_keys[] = {plain("mode"), number("ratio", dimension::none)};
constexpr TableKind damping_ratio{"damping_ratio", ratio_keys};

constexpr Key elastic_keys[] = {plain("material"),
                                number("E", dimension::pressure),
                                number("area", dimension::area),
                                number("J", dimension::second_moment),
                                sub("section", &section),
                                number("density", dimension::density),
                                number("damping_internal", dimension::time),
                                {"damping_ratio", &damping_ratio, Measure{dimension::none}, {}},
                                number("damping_x", dimension::damping_per_length),
                                number("damping_y", dimension::damping_per_length),
                                sub("shear", &shear),
                                number("yield", dimension::pressure),
                                number("tensile", dimension::pressure),
                                number("endurance", dimension::pressure)};
constexpr TableKind elastic{"elastic", elastic_keys};

constexpr Key coupler_keys[] = {name_key,    length_key,        mass_key,   com_key,
                                inertia_key, inertia_pivot_key, points_key, sub("elastic", &elastic)};
constexpr TableKind coupler{"coupler", coupler_keys};

constexpr Key rocker_keys[] = {name_key,          pivot_key,  length_key,
                               mass_key,          com_key,    inertia_key,
                               inertia_pivot_key, points_key, sub("elastic", &elastic)};
constexpr TableKind rocker{"rocker", rocker_keys};

constexpr Key file_key = plain("file"), column_key = plain("column"), unit_key = plain("unit"),
              scale_key = number("scale", dimension::none);

constexpr Key force_keys[] = {
    number("cos", dimension::force), number("sin", dimension::force), file_key, column_key, unit_key, scale_key};
constexpr TableKind force{"force", force_keys};

constexpr Key pressure_keys[] = {
    file_key, column_key, unit_key, scale_key, number("bore", dimension::length), number("mean", dimension::pressure)};
constexpr TableKind pressure{"pressure", pressure_keys};

constexpr Key slider_keys[] = {name_key,
                               mass_key,
                               position("guide"),
                               number("direction", dimension::angle),
                               {"force", &force, Measure{dimension::force}, {}},
                               sub("pressure", &pressure),
                               points_key};
constexpr TableKind slider{"slider", slider_keys};

constexpr Key dyad_keys[] = {plain("on"), sub("coupler", &coupler), sub("rocker", &rocker), sub("slider", &slider),
                             plain("branch")};
constexpr TableKind dyad{"dyad", dyad_keys};

constexpr Key term_keys[] = {plain("harmonic"), plain("cos"), plain("sin"), plain("omega_power"), file_key, scale_key};
constexpr TableKind term{"term", term_keys};

constexpr Key hill_keys[] = {plain("mass"), plain("damping"), sub("stiffness", &term), sub("load", &term)};
constexpr TableKind hill{"hill", hill_keys};

constexpr Key analysis_keys[] = {plain("modes"),
                                 {"rpm", nullptr, Measure{dimension::speed, Measure::Base::rpm}, {}},
                                 {"omega", nullptr, Measure{dimension::speed, Measure::Base::radian}, {}},
                                 plain("tolerance")};
constexpr TableKind analysis{"analysis", analysis_keys};

constexpr Key top_keys[] = {plain("title"),
                            number("gravity", dimension::acceleration),
                            sub("units", &units),
                            sub("crank", &crank),
                            sub("dyad", &dyad),
                            sub("hill", &hill),
                            sub("analysis", &analysis)};
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
  if (kind.any != nullptr) return kind.any;
  const auto found = std::ranges::find(kind.keys, name, &Key::name);
  return found == kind.keys.end() ? nullptr : &*found;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  if (name.size() > 200) return "";
  std::string best;
  // In halves of a letter: a third of the letters may differ, or two of a short name, but not half of them.
  std::size_t least =
      std::min(std::max<std::size_t>(4, 2 * name.size() / 3) + 1, std::max<std::size_t>(3, name.size()));
  for (const std::string& candidate : candidates) {
    if (std::ranges::equal(name, candidate, {}, lower, lower)) return candidate;
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
