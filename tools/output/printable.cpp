#include "tools/output/printable.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>

namespace hb::tools {
namespace {

struct CodeRange {
  char32_t first, last;
};

// Unicode's control characters and those that change the direction of writing, end lines or are never shown.
constexpr CodeRange hidden[] = {{0x00, 0x09},     {0x0b, 0x1f},     {0x7f, 0x9f},      {0x61c, 0x61c},
                                {0x200e, 0x200f}, {0x2028, 0x202e}, {0x2066, 0x2069},  {0xfeff, 0xfeff},
                                {0xfff9, 0xfffb}, {0xd800, 0xdfff}, {0xe0000, 0xe007f}};

constexpr char32_t least_of_length[] = {0, 0, 0x80, 0x800, 0x10000};

bool needs_no_escape(char c) { return (c >= 0x20 && c < 0x7f) || c == '\n'; }

// Eight bytes at once where none of them is below 0x20 or above 0x7e: x - 0x20 borrows, x + 1 carries into the eighth
// bit.
bool needs_no_escapes(const std::string& text) {
  constexpr std::uint64_t ones = 0x0101010101010101, eighth_bits = 0x80 * ones;
  std::size_t at = 0;
  for (; at + 8 <= text.size(); at += 8) {
    std::uint64_t x = 0;
    std::memcpy(&x, text.data() + at, 8);
    if (((x | (x - 0x20 * ones) | (x + ones)) & eighth_bits) == 0) continue;
    for (std::size_t k = at; k < at + 8; ++k)
      if (!needs_no_escape(text[k])) return false;
  }
  return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), needs_no_escape);
}

}  // namespace

CodePoint code_point_at(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(at);
  const std::size_t length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
  constexpr CodePoint broken{0xfffd, 1, false};
  if (length == 0 || at + length > text.size()) return broken;
  char32_t value = length == 1 ? lead : lead & (0x7f >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if (byte(at + k) >> 6 != 2) return broken;
    value = value << 6 | (byte(at + k) & 0x3f);
  }
  if (value < least_of_length[length] || value > 0x10ffff) return broken;
  const bool is_hidden = std::any_of(std::begin(hidden), std::end(hidden),
                                     [&](const CodeRange& r) { return value >= r.first && value <= r.last; });
  return {value, length, !is_hidden};
}

std::string printable(std::string text) {
  if (needs_no_escapes(text)) return text;
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t plain = at;
    while (at < text.size() && needs_no_escape(text[at])) ++at;
    result.append(text, plain, at - plain);
    if (at == text.size()) break;
    const CodePoint point = code_point_at(text, at);
    if (point.visible) {
      result.append(text, at, point.length);
    } else if (point.value == 0xfffd) {
      result += "\ufffd";
    } else if (point.value < 0x10000) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(point.value));
    } else {  // as JSON writes it
      const auto over = static_cast<unsigned>(point.value) - 0x10000;
      result += fmt::format("\\u{:04x}\\u{:04x}", 0xd800 + (over >> 10), 0xdc00 + (over & 0x3ff));
    }
    at += point.length;
  }
  return result;
}

}  // namespace hb::tools
