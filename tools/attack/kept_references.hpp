// References of cases, computed once and kept in a file: attacks on another engine take a hundredth of the time.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/attack/families.hpp"
#include "tools/attack/quad_floquet.hpp"

namespace hb::attack {

class KeptReferences {
 public:
  // Reads what the file holds; new ones are written behind it. Empty name: nothing is kept.
  explicit KeptReferences(const std::string& file);

  // Empty where there is no reference.
  [[nodiscard]] std::vector<ReferenceExponent> of(Family family, std::uint64_t number, const Case& what);

 private:
  std::map<std::pair<std::string, std::uint64_t>, std::vector<ReferenceExponent>> known_;
  std::ofstream file_;
};

}  // namespace hb::attack
