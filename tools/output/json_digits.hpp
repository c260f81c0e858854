// Values of long arrays as JSON, straight into a text.
#pragma once

#include <fmt/compile.h>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace hb::tools {

// The digits of one value.
class Digits {
 public:
  // The fewest that are this number of this type, with a point or an exponent, as in the rest of a document; null where
  // it is not finite.
  template <std::floating_point Number>
  explicit Digits(Number value) {
    if (!std::isfinite(value)) {
      add("null");
      return;
    }
    size_ = static_cast<std::size_t>(fmt::format_to(digits_, FMT_COMPILE("{}"), value) - digits_);
    if (text().find_first_of(".e") == std::string_view::npos) add(".0");
  }
  Digits() = default;
  std::string_view text() const { return {digits_, size_}; }

 private:
  void add(std::string_view more) { size_ += more.copy(digits_ + size_, more.size()); }

  char digits_[32] = {};  // -1.2345678901234567e-308 is the longest
  std::size_t size_ = 0;
};

template <std::floating_point Number>
void append(std::string& text, Number value) {
  text += Digits(value).text();
}

inline void append(std::string& text, const char* word) {
  text += '"';
  text += word;
  text += '"';
}

// 1 or 0.
inline void append(std::string& text, std::same_as<bool> auto yes) { text += yes ? '1' : '0'; }

// Neighbours often have the same number.
class RepeatedDigits {
 public:
  template <class Number>
  void append_to(std::string& text, Number value) {
    if constexpr (std::floating_point<Number>) {
      if (digits_.text().empty() || std::bit_cast<std::uint64_t>(double(value)) != bits_) {
        digits_ = Digits(value);
        bits_ = std::bit_cast<std::uint64_t>(double(value));
      }
      text += digits_.text();
    } else {
      append(text, value);
    }
  }

 private:
  std::uint64_t bits_ = 0;
  Digits digits_;
};

}  // namespace hb::tools
