// Numbers with units: "210 GPa", "55 mm", "7850 kg/m^3" into the units that a scene is written in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb {

// Exponents of length, mass, time and angle. Angles count as a dimension of their own: a speed in rad/s is no 1/s.
struct Dimension {
  int length = 0, mass = 0, time = 0, angle = 0;
  bool operator==(const Dimension&) const = default;
};

namespace dimension {
inline constexpr Dimension none{}, length{1}, mass{0, 1}, time{0, 0, 1}, angle{0, 0, 0, 1}, area{2}, second_moment{4},
    acceleration{1, 0, -2}, inertia{2, 1}, density{-3, 1}, force{1, 1, -2}, pressure{-1, 1, -2},
    damping_per_length{-1, 1, -1}, speed{0, 0, -1, 1};
}

// What a number of a scene measures, and what a plain number is written in: the units of the scene; for `rpm` turns per
// minute; for `omega` radians per unit of time, whatever the unit of angle.
struct Measure {
  enum class Base { scene, rpm, radian };
  Dimension dimension;
  Base base = Base::scene;
};

// A unit's size is factor * 10^ten in m, kg, s, rad: kept apart so that "55 mm" is 0.055 m to the last bit.
struct Unit {
  double factor = 1;
  int ten = 0;
  Dimension dimension;
};

// A unit by its symbol ("mm", "psi", "rpm"); nothing if it is unknown.
[[nodiscard]] std::optional<Unit> unit_of_symbol(std::string_view symbol);
// factor * 10^ten.
[[nodiscard]] double size_of(const Unit& unit);

// A unit as written: products by blank, * or a middle dot, quotients by /, powers as ^2, 2 or a raised 2, brackets.
// What is wrong is `problem` ("unknown unit inch: in meant?").
struct UnitText {
  std::optional<Unit> unit;
  std::string problem;
};
[[nodiscard]] UnitText parse_unit(std::string_view text);

// A text that begins with a number; `unit` is what follows it (empty: nothing). Empty if it begins otherwise.
struct NumberText {
  double value;
  std::string_view unit;
};
[[nodiscard]] std::optional<NumberText> number_and_unit(std::string_view text);

// The number in what a plain number of this measure is written in, or what is wrong with the text.
struct Quantity {
  std::optional<double> value;
  std::string problem;
};
[[nodiscard]] Quantity parse_quantity(std::string_view text, const Measure& measure, const Units& units);

// One unit in which a plain number of this measure is written: conversion of a file's numbers.
[[nodiscard]] Unit base_unit(const Measure& measure, const Units& units);
// value * from / to, exact where the two differ by a power of ten.
[[nodiscard]] double converted(double value, const Unit& from, const Unit& to);

// "a length", "a pressure".
[[nodiscard]] std::string words_of(const Dimension& dimension);
// "text with a unit as in \"55 mm\"".
[[nodiscard]] std::string example_of(const Dimension& dimension);

// The usual unit that is meant by a name that is none ("inch", "Mpa", "sec"), or "".
[[nodiscard]] std::string unit_meant(std::string_view symbol, const std::vector<std::string>& allowed = {});

}  // namespace hb
