#pragma once

#include <fmt/format.h>

#include <iterator>
#include <utility>

namespace hb::tools {

using Text = fmt::memory_buffer;

template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

}  // namespace hb::tools
