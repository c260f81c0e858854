// Values of long arrays as JSON, straight into a text.
#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace hb::tools {

// The eight digits of n < 10^8, the first in the lowest byte: of halves, then quarters, then digits beside each other.
inline std::uint64_t eight_digits(std::uint64_t n) {
  const std::uint64_t halves = n / 10000 | n % 10000 << 32;
  const std::uint64_t hundreds = halves * 10486 >> 20 & 0x7f0000007f;
  const std::uint64_t quarters = hundreds | (halves - 100 * hundreds) << 16;
  const std::uint64_t tens = quarters * 103 >> 10 & 0xf000f000f000f;
  return (tens | (quarters - 10 * tens) << 8) + 0x3030303030303030;
}

// The text of one value: of a number the fewest digits that are it in its type, with a point or an exponent as in the
// rest of a document, null where it is not finite; of a word at most 30 letters between quotes; 1 or 0 of yes or no.
class ValueText {
 public:
  static constexpr std::size_t longest = 32;  // characters; -1.2345678901234567e-308 has 24

  ValueText() = default;
  template <std::floating_point Number>
  explicit ValueText(Number value) {
    if (!std::isfinite(value)) {
      add("null");
      return;
    }
    if (std::signbit(value)) add("-");
    if (value == 0) {
      add("0.0");
      return;
    }
    const auto decimal = fmt::detail::dragonbox::to_decimal(std::abs(value));
    add(decimal.significand, decimal.exponent);
  }
  explicit ValueText(const char* word) {
    add("\"");
    add(word);
    add("\"");
  }
  explicit ValueText(std::same_as<bool> auto yes) { add(yes ? "1" : "0"); }

  // Copied to `at`, where there is room for the longest; returns its end.
  char* copy(char* at) const {
    std::memcpy(at, text_, longest);
    return at + size_;
  }

 private:
  void add(std::string_view more) { size_ += more.copy(text_ + size_, more.size()); }

  // significand 10^exponent, as d.ddd 10^power where the power is below -4 or above 15.
  void add(std::uint64_t significand, int exponent) {
    constexpr std::uint64_t eight = 100'000'000;
    const int count = fmt::detail::count_digits(significand), power = exponent + count - 1;
    char all[2 * most_digits];
    all[0] = static_cast<char>('0' + significand / (eight * eight));
    put(all + 1, eight_digits(significand / eight % eight));
    put(all + 9, eight_digits(significand % eight));
    const char* digits = all + most_digits - count;
    const bool scientific = power < -4 || power > 15;
    const int before_point = scientific ? 1 : power + 1;
    if (before_point <= 0) {
      put(text_ + size_, std::bit_cast<std::uint64_t>(std::array{'0', '.', '0', '0', '0', '0', '0', '0'}));
      size_ += static_cast<std::size_t>(2 - before_point);
      add_digits(digits, count);
    } else if (before_point < count) {
      add_digits(digits, before_point);
      text_[size_++] = '.';
      add_digits(digits + before_point, count - before_point);
    } else {
      add_digits(digits, count);
      add(std::string_view("000000000000000", static_cast<std::size_t>(before_point - count)));
      if (!scientific) add(".0");
    }
    if (scientific) add_power(power);
  }

  void add_digits(const char* digits, int count) {
    std::memcpy(text_ + size_, digits, most_digits);
    size_ += static_cast<std::size_t>(count);
  }

  void add_power(int power) {
    add(power < 0 ? "e-" : "e+");
    const auto size = static_cast<unsigned>(std::abs(power));
    if (size >= 100) text_[size_++] = static_cast<char>('0' + size / 100);
    text_[size_++] = static_cast<char>('0' + size / 10 % 10);
    text_[size_++] = static_cast<char>('0' + size % 10);
  }

  static constexpr int most_digits = 17;
  static_assert(std::endian::native == std::endian::little);
  static void put(char* at, std::uint64_t eight) { std::memcpy(at, &eight, sizeof eight); }

  char text_[2 * longest] = {};
  std::size_t size_ = 0;
};

// Neighbours often have the same value.
template <class Value>
class RepeatedText {
 public:
  const ValueText& of(Value value) {
    if (value != value_ || value == Value{}) {  // zero has two signs
      text_ = ValueText(value);
      value_ = value;
    }
    return text_;
  }

 private:
  Value value_{};
  ValueText text_;
};

}  // namespace hb::tools
