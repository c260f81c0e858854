#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/constants.hpp"
#include "lib/rod/section.hpp"
#include "lib/rod/shear.hpp"
#include "lib/scene/material.hpp"
#include "lib/scene/plausibility.hpp"
#include "lib/scene/scene_parts.hpp"

namespace hb {

namespace {

struct Shape {
  std::string_view name;
  std::vector<std::string_view> keys;
};

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> list = {{"rectangle", {"width", "height"}},
                                          {"tube", {"diameter", "wall"}},
                                          {"tube", {"outer", "inner"}},
                                          {"round", {"diameter"}},
                                          {"I", {"width", "height", "web", "flange"}},
                                          {"box", {"width", "height", "wall"}}};
  return list;
}

// The shape that `section` names; of those of one name the one that shares a key with it.
const Shape* shape_of(const TableView& section) {
  constexpr const char* names = "rectangle, tube, round, I, box";
  const std::string name = section.need_text("shape", names);
  const Shape* found = nullptr;
  for (const Shape& shape : shapes()) {
    if (shape.name != name) continue;
    if (!found || std::ranges::any_of(shape.keys, [&](std::string_view key) { return section.has(key); })) {
      if (!found || std::ranges::none_of(found->keys, [&](std::string_view key) { return section.has(key); }))
        found = &shape;
    }
  }
  if (!found && section.has("shape") && section.node("shape")->is_string()) {
    section.problem("shape", fmt::format("found {}, allowed {}", describe(*section.node("shape")), names));
  }
  return found;
}

bool at_most(const TableView& section, std::string_view key, double value, double most, const char* words) {
  if (value <= most) return true;
  section.problem(key, fmt::format("found {}, allowed at most {}, {}", value, words, most));
  return false;
}

// Area and J: given as such, or by the section's shape.
SectionValues read_section(const TableView& elastic) {
  constexpr SectionValues unused{1, 1, 0};
  const auto section = elastic.table("section");
  if (!section) {
    if (elastic.has("section")) return unused;
    if (!elastic.has("area"))
      elastic.missing("area", "area and J, or section = { shape = \"rectangle\", width, height }");
    if (!elastic.has("J")) elastic.missing("J", "area and J, or section = { shape = \"rectangle\", width, height }");
    return {elastic.number("area", positive).value_or(1), elastic.number("J", positive).value_or(1), 0};
  }
  for (const char* key : {"area", "J"}) {
    if (elastic.has(key)) elastic.problem(key, "found beside section, allowed either area and J or section");
  }
  const Shape* shape = shape_of(*section);
  if (!shape) return unused;
  for (const auto& [key, value] : section->table()) {
    if (key.str() == "shape" || std::ranges::find(shape->keys, key.str()) != shape->keys.end()) continue;
    section->problem(key.str(), fmt::format("found on the shape {}, allowed {}", shape->name,
                                            fmt::join(shape->keys, shape->keys.size() == 2 ? " and " : ", ")));
  }
  std::vector<double> size;
  for (const std::string_view key : shape->keys) size.push_back(section->need_number(key, positive));
  if (shape->name == "rectangle") return rectangular_section(size[0], size[1]);
  if (shape->name == "round") return round_section(size[0]);
  if (shape->name == "I") {
    const bool good = at_most(*section, "web", size[2], size[0], "the width") &&
                      at_most(*section, "flange", size[3], size[1] / 2, "half the height");
    return good ? i_section(size[0], size[1], size[2], size[3]) : unused;
  }
  if (shape->name == "box") {
    return at_most(*section, "wall", size[2], std::min(size[0], size[1]) / 2, "half the smaller side")
               ? box_section(size[0], size[1], size[2])
               : unused;
  }
  if (shape->keys[0] == "diameter") {
    return at_most(*section, "wall", size[1], size[0] / 2, "half the diameter") ? tubular_section(size[0], size[1])
                                                                                : unused;
  }
  if (size[1] < size[0]) return tubular_section(size[0], (size[0] - size[1]) / 2);
  section->problem("inner", fmt::format("found {}, allowed less than outer, {}", size[1], size[0]));
  return unused;
}

const Material* read_material(const TableView& elastic) {
  const auto name = elastic.text("material");
  if (!name) return nullptr;
  const Material* material = find_material(*name);
  if (material) return material;
  std::vector<std::string> names;
  for (const Material& one : materials()) names.emplace_back(one.name);
  const std::string near = nearest_name(*name, names);
  elastic.problem("material", fmt::format("found {}, an unknown material{}, allowed {}, or E and density as numbers",
                                          describe(*elastic.node("material")),
                                          near.empty() ? "" : " (" + near + " meant?)", joined(names)));
  return nullptr;
}

// Internal damping by the ratio of one mode at rest, lib/README.md (M9): with zeta_i = alpha_c omega_i/2 and the rod's
// own frequency,
//     omega_i^2 = (i pi/l)^4/((rho/E)(i pi/l)^2 + mu/EJ), or (S5) with shear,     alpha_c = 2 zeta_i/omega_i.
double internal_damping(const TableView& elastic, const Elastic& link, const Body& body) {
  static constexpr Limits ratios{0, 1, true, "a damping ratio from 0 to 1, or { mode = 2, ratio = 0.01 }"};
  if (!elastic.has("damping_ratio")) return elastic.number("damping_internal", not_negative).value_or(0);
  if (elastic.has("damping_internal")) {
    elastic.problem("damping_ratio", "found beside damping_internal, allowed one of the two");
  }
  double ratio = 0;
  int mode = 1;
  if (const toml::node* node = elastic.node("damping_ratio"); node->is_table()) {
    const TableView table = *elastic.table("damping_ratio");
    ratio = table.need_number("ratio", ratios);
    mode = table.integer("mode", 1, max_modes).value_or(1);
  } else {
    ratio = elastic.number("damping_ratio", ratios).value_or(0);
  }
  const double k = mode * pi / body.length, E = link.youngs_modulus;
  const double m = link.density / E * k * k + body.mass / body.length / (E * link.second_moment);
  double omega = k * k / std::sqrt(m);
  if (link.shear) {
    Body whole = body;
    whole.elastic = link;
    const RestModes modes = rest_modes(whole, mode);
    omega = std::sqrt(modes.stiffness[0](mode - 1) / modes.mass[0](mode - 1));
  }
  return 2 * ratio / omega;
}

std::optional<Shear> read_shear(const TableView& elastic) {
  const auto table = elastic.table("shear");
  if (!table) return std::nullopt;
  return Shear{table->need_number("G", positive), table->need_number("k", positive)};
}

Strength read_strength(const TableView& elastic) {
  const auto stress = [&](const char* key) { return elastic.number(key, positive).value_or(0); };
  const Strength strength{stress("yield"), stress("tensile"), stress("endurance")};
  if (strength.tensile > 0) {
    at_most(elastic, "yield", strength.yield, strength.tensile, "the tensile strength");
    at_most(elastic, "endurance", strength.endurance, strength.tensile, "the tensile strength");
  }
  return strength;
}

}  // namespace

void read_elastic(const TableView& table, const TableView& elastic, const SceneContext& context, Body& body) {
  for (const char* key : {"com", "inertia", "inertia_pivot", "points"}) {
    if (!table.has(key)) continue;
    table.problem(key, std::string(key) == "points"
                           ? "found points on an elastic link, allowed exactly two joints"
                           : "found beside elastic, allowed on rigid links only (an elastic link is uniform)");
  }
  const Material* material = read_material(elastic);
  const auto in_scene = [&](double value, Dimension dimension) {
    return converted(value, Unit{1, 0, dimension}, base_unit({dimension}, context.units));
  };
  Elastic link;
  if (!elastic.has("E") && !elastic.has("material")) {
    elastic.missing("E", "Young's modulus as a number > 0, text as in \"210 GPa\", or material = \"steel\"");
  }
  link.youngs_modulus =
      elastic.number("E", positive).value_or(material ? in_scene(material->youngs_modulus, dimension::pressure) : 1);
  const SectionValues section = read_section(elastic);
  link.area = section.area;
  link.second_moment = section.second_moment;
  link.section_height = section.height;
  link.damping_x = elastic.number("damping_x", not_negative).value_or(0);
  link.damping_y = elastic.number("damping_y", not_negative).value_or(0);
  link.shear = read_shear(elastic);
  link.strength = read_strength(elastic);

  const double volume = link.area * body.length;
  std::optional<double> density = elastic.number("density", positive);
  if (!density && material) density = in_scene(material->density, dimension::density);
  if (!table.has("mass") && !elastic.has("density") && !elastic.has("material")) {
    table.missing("mass", "the link's mass, or density or material in its elastic table");
  }
  body.mass = table.number("mass", positive).value_or(density.value_or(1) * volume);
  link.density = density.value_or(body.mass / volume);
  body.com = body.length / 2;
  body.inertia = body.mass * body.length * body.length / 12 + link.density * link.second_moment * body.length;
  link.internal_damping = internal_damping(elastic, link, body);
  body.elastic = link;
  remark_on_elastic(table, elastic, body, context);
}

}  // namespace hb
