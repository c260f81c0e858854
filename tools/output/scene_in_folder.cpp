#include "tools/output/scene_in_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace hb::tools {

std::string in_folder(const std::string& text, const std::filesystem::path& from, const std::filesystem::path& to) {
  namespace fs = std::filesystem;
  std::string changed;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t key = std::min(text.find("file", at), text.size());
    changed.append(text, at, key - at);
    const auto in_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    };
    std::size_t value = std::min(key + 4, text.size());
    const bool whole = key == 0 || !in_name(text[key - 1]);
    while (value < text.size() && (text[value] == ' ' || text[value] == '\t')) ++value;
    const bool assigned = value < text.size() && text[value] == '=';
    value += assigned ? 1 : 0;
    while (value < text.size() && (text[value] == ' ' || text[value] == '\t')) ++value;
    const char quote = value < text.size() ? text[value] : '\0';
    const std::size_t end = text.find_first_of(std::string{quote, '\n'}, value + 1);
    if (whole && assigned && (quote == '"' || quote == '\'') && end != std::string::npos && text[end] == quote) {
      const fs::path file = text.substr(value + 1, end - value - 1);
      const bool stays = file.is_absolute() || file.empty();
      changed.append(text, key, value - key);
      changed += stays ? text.substr(value, end + 1 - value)
                       : fmt::format("\"{}\"", (from / file).lexically_relative(to).string());
      at = end + 1;
    } else {
      const std::size_t next = std::min(key + 4, text.size());
      changed.append(text, key, next - key);
      at = next;
    }
  }
  return changed;
}

}  // namespace hb::tools
