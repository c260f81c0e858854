// What the pictures of a sweep share: title, axis, shaded bands, curves that are grey beyond the linear theory. Texts
// are gnuplot's.
#pragma once

#include <string>

#include "tools/output/sweep_output.hpp"

namespace hb::tools {

inline constexpr int max_curves = 6;  // modes in one picture

inline constexpr const char* frame_clean_up =
    "unset object\nunset arrow\nunset label\nunset logscale\nset xrange [*:*]\nset yrange [*:*]\nset format '%g'\n"
    "unset title\nunset xlabel\nunset ylabel\nset key default\nset rmargin -1\nset lmargin -1\n";

// Lines broken between sentences, at "; ", where they would be longer than the picture is wide.
[[nodiscard]] std::string frame_wrapped(const std::string& shown);
[[nodiscard]] int frame_lines(const std::string& text);

[[nodiscard]] std::string frame_title(const SweepScene& scene, const SweepResult& result, std::size_t rod,
                                      const std::string& shown);
[[nodiscard]] std::string frame_axis(const SweepScene& scene);

[[nodiscard]] std::string frame_shaded(const SweepRod& rod, const char* colour = "#d55e00");
// Bands of this rod, over those of the others: there the mechanism is unstable too.
[[nodiscard]] std::string frame_shaded(const SweepResult& result, std::size_t r);
[[nodiscard]] std::string frame_shaded_note(const SweepResult& result, std::size_t r);

// A curve, grey and dashed where the answer is beyond the linear theory. `style`: what stands behind "with lines".
[[nodiscard]] std::string frame_curve(const std::string& csv, int column, const SweepColumns& columns,
                                      const std::string& style, double width);
// Where some of the picture is beyond.
[[nodiscard]] std::string frame_beyond_note(const CsvFile& csv, const SweepColumns& columns);

}  // namespace hb::tools
