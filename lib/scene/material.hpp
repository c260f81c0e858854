// Well-known materials by name.
#pragma once

#include <span>
#include <string_view>

namespace hb {

struct Material {
  std::string_view name;
  double youngs_modulus;  // Pa
  double density;  // kg/m^3
  std::string_view source;  // where the two numbers stand
};

[[nodiscard]] std::span<const Material> materials();

// nullptr if the name is unknown; "aluminum" is aluminium.
[[nodiscard]] const Material* find_material(std::string_view name);

}  // namespace hb
