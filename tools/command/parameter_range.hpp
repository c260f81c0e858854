// Ranges of a parameter as written on the command line: "A:B:xN" (N points) everywhere, "A:B:STEP" or "A:B:N" where a
// bare third number means the one or the other, with "PATH=" in front where the parameter is named. Every refusal is a
// UsageError that names the flag, what was found and what is allowed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hb::tools {

inline constexpr std::size_t max_range_points = 1000000;

// "PATH=RANGE" at its first '='.
struct NamedRange {
  std::string path;
  std::string range;
};
[[nodiscard]] NamedRange named_range(const std::string& flag, const std::string& text,
                                     const std::string& allowed = "PATH=FROM:TO:..., as in AB.J=30:60:1");

// N of "xN", 2 or more and at most max_range_points; nothing if the text does not begin with x.
[[nodiscard]] std::optional<std::size_t> point_count(const std::string& flag, const std::string& range,
                                                     const std::string& third);

// A, A + STEP, ... up to B (B itself where the steps meet it within rounding); at least two points.
[[nodiscard]] std::vector<double> range_by_step(const std::string& flag, const std::string& text);
[[nodiscard]] std::vector<double> range_by_step(const std::string& flag, double from, double to, double step);

// N >= 2 equally spaced points from A to B, both included.
[[nodiscard]] std::vector<double> range_by_count(const std::string& flag, const std::string& text);
[[nodiscard]] std::vector<double> range_by_count(const std::string& flag, double from, double to, std::size_t count);

}  // namespace hb::tools
