#include "tools/output/provenance.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/output/printable.hpp"

namespace hb::tools {
namespace {

std::string one_line(const std::string& text) {
  std::string line = printable(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

std::vector<std::string> sentences(const Provenance& origin) {
  return {one_line(origin.program + ": " + origin.command),
          one_line(fmt::format("scene {}, CRC-32 {:08x}", origin.scene_file, crc32(origin.scene_text)))};
}

std::string commented(const std::string& contents, const Provenance& origin) {
  std::string text;
  for (const std::string& sentence : sentences(origin)) text += "# " + sentence + "\n";
  return text + contents;
}

std::string in_json(const std::string& contents, const Provenance& origin) {
  if (contents.empty() || contents.front() != '{') return contents;
  nlohmann::ordered_json json;
  json["program"] = origin.program;
  json["command"] = origin.command;
  json["scene"] = {{"file", origin.scene_file},
                   {"crc32", fmt::format("{:08x}", crc32(origin.scene_text))},
                   {"text", origin.scene_text}};
  const bool lines = contents.size() > 1 && contents[1] == '\n';
  const std::string value = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const std::string after = contents.find_first_not_of(" \n", 1) == contents.find('}') ? "" : ",";
  return fmt::format("{{{}\"provenance\":{}{}{}", lines ? "\n " : "", printable(value), after, contents.substr(1));
}

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return escaped;
}

std::string in_svg(const std::string& contents, const Provenance& origin) {
  const std::size_t root = contents.find("<svg"), end = contents.find('>', root);
  if (root == std::string::npos || end == std::string::npos) return contents;
  std::string metadata = "\n<metadata>";
  for (const std::string& sentence : sentences(origin)) metadata += xml_text(sentence) + "\n";
  metadata.back() = '<';
  return contents.substr(0, end + 1) + metadata + "/metadata>" + contents.substr(end + 1);
}

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

// An iTXt chunk (UTF-8, not compressed) after the header chunk of 25 bytes. PNG (ISO/IEC 15948), 11.3.4.5.
std::string in_png(const std::string& contents, const Provenance& origin) {
  constexpr std::size_t after_header = 8 + 25;
  if (contents.size() < after_header || !contents.starts_with("\x89PNG")) return contents;
  std::string chunk = "iTXtDescription";
  chunk.append(5, '\0');
  for (const std::string& sentence : sentences(origin)) chunk += sentence + "\n";
  chunk.pop_back();
  return contents.substr(0, after_header) + big_endian(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk +
         big_endian(crc32(chunk)) + contents.substr(after_header);
}

}  // namespace

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t remainder = 0xffffffff;
  for (const char c : bytes) {
    remainder ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) remainder = remainder >> 1 ^ ((remainder & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~remainder;
}

std::string with_provenance(const std::string& name, const std::string& contents, const Provenance& origin) {
  if (origin.program.empty()) return contents;
  for (const char* ending : {".csv", ".gp", ".toml", ".txt"})
    if (name.ends_with(ending)) return commented(contents, origin);
  if (name.ends_with(".json")) return in_json(contents, origin);
  if (name.ends_with(".svg")) return in_svg(contents, origin);
  if (name.ends_with(".png")) return in_png(contents, origin);
  return contents;
}

}  // namespace hb::tools
