// What was probably meant where a scene is not TOML.
#pragma once

#include <string>
#include <string_view>

namespace hb {

// Of the line that could not be read, up to `column` (from 1): text without quotes, a decimal comma. "" if it shows
// neither, else a sentence such as `text needs quotes: material = "steel"`.
[[nodiscard]] std::string toml_hint(std::string_view line, std::size_t column);

}  // namespace hb
