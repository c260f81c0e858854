// Sentences and short texts that tables, pictures and notes share.
#pragma once

#include <string>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/scene/scene.hpp"

namespace hb::tools {

// The scene's title, or its file's name.
[[nodiscard]] std::string scene_name(const Scene& scene);
// The speed in rpm; of the numbers that mean this speed the one with the fewest digits, as someone would have given it.
[[nodiscard]] double rpm_of(double speed, const Units& units);
// "300 rpm", or "omega = 2.05 rad/s" for a [hill] scene.
[[nodiscard]] std::string speed_text(double speed, const Scene& scene, int digits = 10);
// In tables of numbers: 1 unstable, 0 undecided, -1 stable, -2 bounded.
[[nodiscard]] int verdict_number(Verdict verdict);
inline constexpr const char* verdict_numbers = "verdict: 1 unstable, 0 undecided, -1 stable, -2 bounded";
inline constexpr const char* bounds_among_growth =
    "growth: where a closed-form bound proves stability that bound, its error the width of what it leaves";
// The growth rate with its error, both halves apart where they differ much: "115.02 +4.9e+03 -3.1e-01"; of
// closed-form bounds "between -16.4 and -11.2".
[[nodiscard]] std::string growth_text(const Stability& stability, const std::string& unit);
// "-16.045448 +/- 1.2e-11": digits as far as the error allows.
[[nodiscard]] std::string with_error(double value, double error);
// A place along an axis with no more digits than are known, 3 to 9.
[[nodiscard]] std::string located(double x, double error);
// Significant digits of a value that an error leaves, 3 to 10.
[[nodiscard]] int trusted_digits(double value, double error);
// Along and across what the components x and y of joint forces are; elastic rockers have joints in frames of their own.
[[nodiscard]] std::string force_frames(const std::vector<std::string>& elastic_rockers);
[[nodiscard]] std::vector<std::string> elastic_rockers(const Linkage& linkage);
[[nodiscard]] const char* status_text(SteadyStatus status);
// Of `count` points those that a table shows: every so many, at most 17, and the last.
[[nodiscard]] std::vector<std::size_t> shown_rows(std::size_t count);

// "1st", "2nd", "3rd", "11th", "23rd".
[[nodiscard]] std::string ordinal(std::size_t number);

}  // namespace hb::tools
