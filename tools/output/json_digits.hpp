// Values of long arrays as JSON, straight into a text.
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <string>

namespace hb::tools {

// The fewest digits that are this number of this type, with a point or an exponent, as in the rest of a document; null
// where it is not finite.
template <std::floating_point Number>
void append(std::string& text, Number value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{}", value);
  if (text.find_first_of(".e", begin) == std::string::npos) text += ".0";
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
      if (digits_.empty() || std::bit_cast<std::uint64_t>(double(value)) != bits_) {
        digits_.clear();
        append(digits_, value);
        bits_ = std::bit_cast<std::uint64_t>(double(value));
      }
      text += digits_;
    } else {
      append(text, value);
    }
  }

 private:
  std::uint64_t bits_ = 0;
  std::string digits_;
};

}  // namespace hb::tools
