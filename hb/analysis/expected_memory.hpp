// How much memory an answer takes beyond its model, before it is begun.
#pragma once

#include <cstddef>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb {

// Bytes that one speed of a model takes while it is computed and printed: an estimate, by fits to measured peaks, for
// what goes with harmonics and modes. Megabytes that every run takes are not counted. With modes = "auto" it is that of
// the number of modes that the choice starts from.
[[nodiscard]] double expected_bytes(const SceneModel& model, const Settings& settings);

// Bytes that the points of a sweep keep until the end, an estimate; `documents`: with what JSON says of them. What is
// found between the points comes on top.
[[nodiscard]] double expected_bytes_of_points(const SceneModel& model, const Settings& settings, std::size_t points,
                                              bool documents);

// Bytes that the rods' systems of a model hold.
[[nodiscard]] double bytes_of(const SceneModel& model);

}  // namespace hb
