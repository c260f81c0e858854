// Whether the verdict may change between two places where the leading exponents are apart from all others, which decay
// faster: then nothing but them counts. hb/engine/README.md, "A pair apart from the others".
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/place.hpp"

namespace hb {

// What is apart: a pair, or the leading exponent of a lock where it grows.
enum class Apart { pair, alone };

// All other exponents, computed or not, decay faster at this place.
[[nodiscard]] bool is_apart(const Place& place, Apart what);
[[nodiscard]] bool is_apart(const StabilitySample& sample);
[[nodiscard]] inline bool is_apart(const Place& place) {
  return is_apart(place, Apart::pair) || is_apart(place, Apart::alone);
}

// NaN where the verdict does not change between the first two of these places, by a growth of more than `least`; else
// where to look. The two have one verdict, those beside them follow, nearest first; `what` is apart at all of them,
// alone with multipliers of one sign. Empty if it may not stay apart.
[[nodiscard]] std::optional<double> doubtful_while_apart(const std::vector<const Place*>& places, Apart what,
                                                         double least);

// What is apart stays so between the first two places even where all exponents change as much again as from one to the
// other; not told of multipliers that change their sign, nor of a leading one alone whose growth may have a notch
// there.
[[nodiscard]] bool stays_leading(const std::vector<const Place*>& places, Apart what);

// Whether the growth that these places foretell at one between the first two holds there.
[[nodiscard]] bool foretold(const std::vector<const Place*>& places, Apart what, const Place& between);

// Two places, ascending, between which one of the changes of verdict between the first two should be; empty: not told.
[[nodiscard]] std::optional<std::array<double, 2>> expected_change(const std::vector<const Place*>& places);

}  // namespace hb
