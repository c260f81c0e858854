// Values of long arrays as JSON, straight into a text.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

namespace hb::tools {

// As a document has it, as many digits as the type has; null where it is not finite.
template <class Number>
requires std::is_floating_point_v<Number>
void append(std::string& text, Number value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  std::array<char, 64> digits;
  text.append(digits.data(), nlohmann::detail::to_chars(digits.data(), digits.data() + digits.size(), value));
}

inline void append(std::string& text, const char* word) {
  text += '"';
  text += word;
  text += '"';
}

inline void append(std::string& text, int value) { text += value == 0 ? '0' : '1'; }

// Neighbours often have the same number.
class RepeatedDigits {
 public:
  template <class Number>
  void append_to(std::string& text, Number value) {
    if constexpr (std::is_floating_point_v<Number>) {
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
