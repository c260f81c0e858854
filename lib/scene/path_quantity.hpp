// Numbers with units for a place of the scene that is given from outside: "50 mm" for crank.length.
#pragma once

#include <string>
#include <string_view>

#include "lib/scene/quantity.hpp"
#include "lib/scene/scene.hpp"

namespace hb {

// The text as the number that would stand plainly at `path`, or at "rpm" and "omega"; or what is wrong with it and what
// is allowed. Throws SceneError for a path that the scene does not have.
[[nodiscard]] Quantity quantity_at(const SceneSource& source, const std::string& path, std::string_view text);

// The same for a length, and for a speed in turns per minute or in radians per unit of time.
[[nodiscard]] Quantity length_quantity(std::string_view text, const Units& units);
[[nodiscard]] Quantity speed_quantity(std::string_view text, bool in_rpm, const Units& units);

}  // namespace hb
