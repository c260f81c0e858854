// What is odd about the scenes that ranges of their numbers lead to: a bare number in a unit that was not meant, a
// section that no rod has.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/along.hpp"
#include "hb/analysis/scene_family.hpp"

namespace hb {

struct RangePlace {
  Numbers numbers;
  std::string name;  // "AB.J = 200", "the design found"
  Concern least = Concern::slenderness;  // what is below this does not matter there
};

// As Scene::warnings, of the family's members at all of these places together. What only some of them have, or have
// with other words, says where it was found first: "... (at AB.J = 200)". Places without a scene say nothing.
[[nodiscard]] std::vector<std::string> place_warnings(const SceneFamily& family, const std::vector<RangePlace>& places);

// At the ends of the axes, both of each with both of the others; an axis that is the speed has none.
[[nodiscard]] std::vector<std::string> range_warnings(const SceneFamily& family, const std::vector<const Along*>& axes);

}  // namespace hb
