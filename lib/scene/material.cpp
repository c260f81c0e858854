#include "lib/scene/material.hpp"

#include <algorithm>

namespace hb {

namespace {

// Nominal values at room temperature, as design codes and handbooks give them; a batch differs by some per cent.
constexpr Material known[] = {
    {"steel", 210e9, 7850, "EN 1993-1-1, 3.2.6; EN 1991-1-1, table A.4"},
    {"stainless steel", 200e9, 7900, "EN 10088-1, grade 1.4301"},
    {"aluminium", 70e9, 2700, "EN 1999-1-1, 3.2.5"},
    {"titanium", 114e9, 4430, "Ti-6Al-4V, ASM Handbook, volume 2"},
    {"brass", 110e9, 8440, "CuZn37, EN CW508L, data sheet of the German Copper Institute"},
    {"grey cast iron", 110e9, 7200, "EN 1561, EN-GJL-250 (103 to 118 GPa)"},
    {"ductile cast iron", 169e9, 7100, "EN 1563, EN-GJS-400-15"},
};

}  // namespace

std::span<const Material> materials() { return known; }

const Material* find_material(std::string_view name) {
  if (name == "aluminum") name = "aluminium";
  const auto found = std::ranges::find(known, name, &Material::name);
  return found == std::end(known) ? nullptr : &*found;
}

}  // namespace hb
