// Text from outside (names, titles, messages of other programs) on its way to terminals, pictures and file names.
#pragma once

#include <cstddef>
#include <string>

namespace hb::tools {

struct CodePoint {
  char32_t value = 0;
  std::size_t length = 1;  // in bytes
  bool visible = true;  // false: control characters, also those of the direction of writing, and broken UTF-8
};

// `at` < text.size(); a new line counts as visible.
[[nodiscard]] CodePoint code_point_at(const std::string& text, std::size_t at);

// With \uXXXX for what is not visible and U+FFFD for broken UTF-8: what a terminal shows is what is there. JSON stays
// the same JSON.
[[nodiscard]] std::string printable(std::string text);

}  // namespace hb::tools
