// Values of long arrays are written as fmt writes the fewest digits, with a point or an exponent.
#include "tools/output/json_digits.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace {

using hb::tools::ValueText;

template <class Value>
std::string written(Value value) {
  char text[ValueText::longest];
  return {text, ValueText(value).copy(text)};
}

template <class Number>
void expect_fewest_digits(Number value) {
  std::string fewest = fmt::format("{}", value);
  if (fewest.find_first_of(".e") == std::string::npos) fewest += ".0";
  ASSERT_EQ(written(value), fewest);
}

TEST(JsonDigits, AreTheFewestOfTheNumber) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200000; ++i) {
    const std::uint64_t bits = random();
    const auto any = std::bit_cast<double>(bits);
    const auto any_float = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    if (std::isfinite(any)) expect_fewest_digits(any);
    if (std::isfinite(any_float)) expect_fewest_digits(any_float);
    const double short_one = std::round(std::ldexp(static_cast<double>(bits >> 30), -20));
    for (const double power : {1e-12, 1e-4, 1.0, 1e4, 1e12}) expect_fewest_digits(short_one * power);
  }
  for (const double value : {0.0, -0.0, 1.0, 0.1, 1e-4, 1e-5, 1e15, 1e16, 123456789012345678.0, 5e-324,
                             -2.2250738585072014e-308, 1.7976931348623157e308}) {
    expect_fewest_digits(value);
    if (std::abs(value) < 1e38) expect_fewest_digits(static_cast<float>(value));
  }
}

TEST(JsonDigits, WordsHaveQuotesAndWhatIsNotFiniteIsNull) {
  EXPECT_EQ(written("undecided"), "\"undecided\"");
  EXPECT_EQ(written(true), "1");
  EXPECT_EQ(written(false), "0");
  EXPECT_EQ(written(HUGE_VAL), "null");
  EXPECT_EQ(written(std::nan("")), "null");
}

}  // namespace
