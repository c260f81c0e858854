// Numbers with units on the command line, "crank.length=50mm:60mm:x5", into the plain numbers that they stand for.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "lib/scene/path_quantity.hpp"

namespace hb::tools {

// Whether a text is a number with something behind it that may be a unit ("300rpm", "2 mm"; not "300,5", "100-300").
[[nodiscard]] bool has_unit(std::string_view text);

// What a text with a unit stands for.
using UnitReader = std::function<Quantity(std::string_view)>;

// What a bare third number of a range means.
enum class ThirdNumber { step, count };

// The range with its units taken off; a range without units as it is. Units stand at both ends, and at a step, or at
// none of them; 0 needs none. Throws UsageError.
[[nodiscard]] std::string plain_range(const std::string& flag, const std::string& text, ThirdNumber third,
                                      const UnitReader& read);
// Of a number of the scene.
[[nodiscard]] std::string plain_range(const std::string& flag, const std::string& text, ThirdNumber third,
                                      const SceneSource& source, const std::string& path);

}  // namespace hb::tools
