#include "lib/scene/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "lib/constants.hpp"
#include "lib/scene/characters.hpp"
#include "lib/scene/scene_keys.hpp"
#include "lib/scene/scene_reader.hpp"

namespace hb {

namespace {

struct Symbol {
  std::string_view name;
  Unit unit;
  bool prefixes = false;  // takes G, M, k, h, d, c, m, u, n
};

// Exact by definition: in, ft (international), lb (avoirdupois), standard gravity in lbf and kgf, atm.
constexpr double lbf_in_1e14_newton = 45359237.0 * 980665.0;  // 0.45359237 kg * 9.80665 m/s^2, 13 decimals
constexpr Symbol symbols[] = {
    {"m", {1, 0, dimension::length}, true},
    {"in", {254, -4, dimension::length}},
    {"inch", {254, -4, dimension::length}},
    {"ft", {3048, -4, dimension::length}},
    {"g", {1, -3, dimension::mass}, true},
    {"t", {1, 3, dimension::mass}},
    {"lb", {45359237, -8, dimension::mass}},
    {"lbm", {45359237, -8, dimension::mass}},
    {"s", {1, 0, dimension::time}, true},
    {"min", {60, 0, dimension::time}},
    {"h", {3600, 0, dimension::time}},
    {"rad", {1, 0, dimension::angle}, true},
    {"deg", {pi / 180, 0, dimension::angle}},
    {"°", {pi / 180, 0, dimension::angle}},
    {"rev", {2 * pi, 0, dimension::angle}},
    {"turn", {2 * pi, 0, dimension::angle}},
    {"rpm", {2 * pi / 60, 0, dimension::speed}},
    {"Hz", {2 * pi, 0, dimension::speed}, true},
    {"N", {1, 0, dimension::force}, true},
    {"lbf", {lbf_in_1e14_newton, -13, dimension::force}},
    {"kgf", {980665, -5, dimension::force}},
    {"Pa", {1, 0, dimension::pressure}, true},
    {"bar", {1, 5, dimension::pressure}, true},
    {"atm", {101325, 0, dimension::pressure}},
    {"psi", {lbf_in_1e14_newton / (254.0 * 254.0), -5, dimension::pressure}},
    {"ksi", {lbf_in_1e14_newton / (254.0 * 254.0), -2, dimension::pressure}},
    {"%", {1, -2, dimension::none}},
};

struct Prefix {
  std::string_view name;
  int ten;
};
constexpr Prefix prefixes[] = {{"G", 9},  {"M", 6},  {"k", 3},  {"h", 2},  {"d", -1}, {"c", -2},
                               {"m", -3}, {"u", -6}, {"µ", -6}, {"μ", -6}, {"n", -9}};

// What people write for a unit, beside what differs from one by a letter.
struct Alias {
  std::string_view written, meant;
};
constexpr Alias aliases[] = {
    {"inch", "in"},     {"inches", "in"},     {"foot", "ft"},       {"feet", "ft"},       {"metre", "m"},
    {"meter", "m"},     {"millimetre", "mm"}, {"millimeter", "mm"}, {"centimetre", "cm"}, {"centimeter", "cm"},
    {"kilogram", "kg"}, {"gram", "g"},        {"tonne", "t"},       {"ton", "t"},         {"pound", "lb"},
    {"pounds", "lb"},   {"lbs", "lb"},        {"second", "s"},      {"seconds", "s"},     {"sec", "s"},
    {"minute", "min"},  {"degree", "deg"},    {"degrees", "deg"},   {"radian", "rad"},    {"radians", "rad"},
    {"newton", "N"},    {"pascal", "Pa"},     {"kp", "kgf"},        {"U/min", "rpm"},     {"1/min", "rpm"}};
constexpr std::string_view usual[] = {"m",   "mm",  "cm",  "um",  "in",   "ft",  "kg",  "g",   "mg", "t",   "lb",
                                      "s",   "ms",  "us",  "rad", "deg",  "N",   "kN",  "mN",  "MN", "lbf", "Pa",
                                      "kPa", "MPa", "GPa", "bar", "mbar", "psi", "ksi", "rpm", "Hz"};

Unit times(const Unit& a, const Unit& b, int power) {
  Unit c = a;
  const bool divide = power < 0;
  for (int i = 0; i < std::abs(power); ++i) c.factor = divide ? c.factor / b.factor : c.factor * b.factor;
  c.ten += power * b.ten;
  c.dimension.length += power * b.dimension.length;
  c.dimension.mass += power * b.dimension.mass;
  c.dimension.time += power * b.dimension.time;
  c.dimension.angle += power * b.dimension.angle;
  return c;
}

// value * 10^ten, correctly rounded for |ten| <= 22.
double scaled(double value, int ten) {
  static constexpr std::array<double, 23> powers = [] {
    std::array<double, 23> p{1};
    for (std::size_t k = 1; k < p.size(); ++k) p[k] = 10 * p[k - 1];
    return p;
  }();
  for (; ten > 22; ten -= 22) value *= powers[22];
  for (; ten < -22; ten += 22) value /= powers[22];
  return ten >= 0 ? value * powers[static_cast<std::size_t>(ten)] : value / powers[static_cast<std::size_t>(-ten)];
}

bool is_unit_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || static_cast<unsigned char>(c) >= 0x80;
}

constexpr std::string_view raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
constexpr std::string_view raised_minus = "⁻", middle_dot = "·", dot_operator = "⋅";

class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : rest_(text) {}

  UnitText parse() {
    Unit unit;
    if (rest_.size() > 200 || !product(unit, 0) || !problem_.empty()) return failed();
    if (!rest_.empty()) {
      wrong();
      return failed();
    }
    return {unit, ""};
  }

 private:
  UnitText failed() const { return {std::nullopt, problem_.empty() ? "no unit" : problem_}; }

  bool wrong() {
    if (problem_.empty()) problem_ = fmt::format("no unit at \"{}\"", printable(rest_, 30));
    return false;
  }

  void skip_blanks() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
  }

  bool take(std::string_view token) {
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  bool product(Unit& unit, int depth) {
    if (depth > 8) return wrong();
    skip_blanks();
    if (!factor(unit, 1, depth)) return false;
    bool divided = false;
    while (true) {
      skip_blanks();
      if (rest_.empty() || rest_.front() == ')') return true;
      if (take("/")) {
        divided = true;
        skip_blanks();
        if (!factor(unit, -1, depth)) return false;
        continue;
      }
      (void)(take("*") || take(middle_dot) || take(dot_operator));
      if (divided) {
        problem_ = "a product after /, which may be meant either way: brackets tell, as in kg/(m s^2)";
        return false;
      }
      skip_blanks();
      if (!factor(unit, 1, depth)) return false;
    }
  }

  bool factor(Unit& unit, int sign, int depth) {
    Unit base;
    if (take("(")) {
      if (!product(base, depth + 1) || !take(")")) return wrong();
    } else if (take("1")) {
      if (!rest_.empty() && (is_digit(rest_.front()) || rest_.front() == '.')) return wrong();
    } else if (!symbol(base)) {
      return false;
    }
    int power = 1;
    if (!exponent(power)) return false;
    unit = times(unit, base, sign * power);
    return std::isnormal(unit.factor) && std::abs(unit.ten) < 200 ? true : wrong();
  }

  bool symbol(Unit& unit) {
    std::size_t end = 0;
    while (end < rest_.size() && is_unit_letter(rest_[end]) && !at_mark(end)) ++end;
    if (end == 0) return wrong();
    const std::string_view name = rest_.substr(0, end);
    const std::optional<Unit> found = unit_of_symbol(name);
    if (!found) {
      const std::string meant = unit_meant(name);
      problem_ = fmt::format("the unknown unit {}{}", printable(name, 30),
                             meant.empty() ? "" : fmt::format(" ({} meant?)", meant));
      return false;
    }
    rest_.remove_prefix(end);
    unit = *found;
    return true;
  }

  // Raised digits, raised minus and middle dots end a symbol.
  bool at_mark(std::size_t at) const {
    const std::string_view here = rest_.substr(at);
    return here.starts_with(middle_dot) || here.starts_with(dot_operator) || here.starts_with(raised_minus) ||
           std::ranges::any_of(raised, [&](std::string_view digit) { return here.starts_with(digit); });
  }

  bool exponent(int& power) {
    if (take(raised_minus)) power = -1;
    int value = 0, digits = 0;
    for (bool more = true; more;) {
      more = false;
      for (std::size_t d = 0; d < std::size(raised); ++d) {
        if (take(raised[d])) value = 10 * value + static_cast<int>(d), ++digits, more = digits < 3;
      }
    }
    if (digits > 0) {
      power *= value;
      return value <= 12 ? true : wrong();
    }
    if (power < 0) return wrong();
    const bool marked = take("^") || take("**");
    if (marked && take("-")) power = -1;
    while (!rest_.empty() && is_digit(rest_.front()) && digits < 3) {
      value = 10 * value + (rest_.front() - '0');
      rest_.remove_prefix(1);
      ++digits;
    }
    if (digits == 0) return marked ? wrong() : true;
    power *= value;
    return value <= 12 ? true : wrong();
  }

  std::string_view rest_;
  std::string problem_;
};

struct DimensionWords {
  Dimension dimension;
  std::string_view words, example;
};
constexpr DimensionWords dimension_words[] = {
    {dimension::none, "a number without unit", ""},
    {dimension::length, "a length", "55 mm"},
    {dimension::mass, "a mass", "0.2 kg"},
    {dimension::time, "a time", "0.1 ms"},
    {dimension::angle, "an angle", "90 deg"},
    {dimension::area, "an area", "320 mm^2"},
    {dimension::second_moment, "a second moment of area", "45 mm^4"},
    {dimension::acceleration, "an acceleration", "9.81 m/s^2"},
    {dimension::inertia, "a moment of inertia", "0.018 kg m^2"},
    {dimension::density, "a density", "7850 kg/m^3"},
    {dimension::force, "a force", "1.2 kN"},
    {dimension::pressure, "a pressure", "210 GPa"},
    {dimension::damping_per_length, "a damping per length", "0.1 N s/m^2"},
    {dimension::speed, "a speed of turning", "3000 rpm"},
};

const DimensionWords* find_words(const Dimension& wanted) {
  const auto found = std::ranges::find(dimension_words, wanted, &DimensionWords::dimension);
  return found == std::end(dimension_words) ? nullptr : &*found;
}

}  // namespace

std::optional<Unit> unit_of_symbol(std::string_view symbol) {
  const auto exact = std::ranges::find(symbols, symbol, &Symbol::name);
  if (exact != std::end(symbols)) return exact->unit;
  for (const Prefix& prefix : prefixes) {
    if (!symbol.starts_with(prefix.name)) continue;
    const auto found = std::ranges::find(symbols, symbol.substr(prefix.name.size()), &Symbol::name);
    if (found == std::end(symbols) || !found->prefixes) continue;
    Unit unit = found->unit;
    unit.ten += prefix.ten;
    return unit;
  }
  return std::nullopt;
}

double size_of(const Unit& unit) { return scaled(unit.factor, unit.ten); }

UnitText parse_unit(std::string_view text) { return UnitParser(text).parse(); }

std::optional<NumberText> number_and_unit(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const std::size_t first = text.starts_with('-') ? 1 : 0;  // neither "nan m" nor "inf m"
  if (text.size() <= first || !(is_digit(text[first]) || text[first] == '.')) return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return NumberText{value, text};
}

Unit base_unit(const Measure& measure, const Units& units) {
  if (measure.base == Measure::Base::rpm) return *unit_of_symbol("rpm");
  const Dimension& d = measure.dimension;
  Unit base;
  base = times(base, *unit_of_symbol(units.length), d.length);
  base = times(base, *unit_of_symbol(units.mass), d.mass);
  base = times(base, *unit_of_symbol(units.time), d.time);
  return times(base, *unit_of_symbol(measure.base == Measure::Base::radian ? "rad" : units.angle), d.angle);
}

double converted(double value, const Unit& from, const Unit& to) {
  return scaled(from.factor == to.factor ? value : value * (from.factor / to.factor), from.ten - to.ten);
}

Quantity parse_quantity(std::string_view text, const Measure& measure, const Units& units) {
  const std::optional<NumberText> number = number_and_unit(text);
  if (!number) return {std::nullopt, "text that does not begin with a number"};
  if (number->unit.empty()) return {std::nullopt, "text without a unit"};
  if (number->unit.size() > 1 && number->unit[0] == ',' && is_digit(number->unit[1])) {
    return {std::nullopt, "a decimal comma (a decimal point meant?)"};
  }
  const UnitText unit = parse_unit(number->unit);
  if (!unit.unit) return {std::nullopt, unit.problem};
  if (!(unit.unit->dimension == measure.dimension)) return {std::nullopt, words_of(unit.unit->dimension)};
  return {converted(number->value, *unit.unit, base_unit(measure, units)), ""};
}

std::string words_of(const Dimension& dimension) {
  const DimensionWords* words = find_words(dimension);
  if (words != nullptr) return std::string(words->words);
  std::string text = "a number in";
  const auto add = [&](const char* unit, int power) {
    if (power != 0) text += fmt::format(" {}{}", unit, power == 1 ? "" : fmt::format("^{}", power));
  };
  add("kg", dimension.mass);
  add("m", dimension.length);
  add("s", dimension.time);
  add("rad", dimension.angle);
  return text;
}

std::string example_of(const Dimension& dimension) {
  const DimensionWords* words = find_words(dimension);
  return words == nullptr || words->example.empty() ? "" : fmt::format("text with a unit as in \"{}\"", words->example);
}

std::string unit_meant(std::string_view symbol, const std::vector<std::string>& allowed) {
  std::vector<std::string> names = allowed;
  if (names.empty()) names.assign(std::begin(usual), std::end(usual));
  const auto known = std::ranges::find(aliases, symbol, &Alias::written);
  if (known != std::end(aliases) && std::ranges::find(names, known->meant) != names.end())
    return std::string(known->meant);
  const auto same_letters = [&](const std::string& name) {
    return std::ranges::equal(name, symbol, [](unsigned char a, unsigned char b) { return (a | 0x20) == (b | 0x20); });
  };
  const auto found = std::ranges::find_if(names, same_letters);
  if (found != names.end()) return *found;
  return symbol.size() < 3 ? "" : nearest_name(symbol, names);  // every letter is near to every other
}

}  // namespace hb
