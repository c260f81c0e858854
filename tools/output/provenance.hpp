// Where a file comes from: program, command and scene, written into the file itself. No dates, and no flags that leave
// the numbers as they are: files of equal numbers have equal bytes.
#pragma once

#include <cstdint>
#include <string>

namespace hb::tools {

struct Provenance {
  std::string program;  // "hb 1.0.0"; empty: nothing is written into files
  std::string command;  // "hb steady six_link.toml --rpm 300"
  std::string scene_file, scene_text;
};

// CRC-32 as in PNG, gzip and the program crc32.
[[nodiscard]] std::uint32_t crc32(const std::string& bytes);

// The file `name` with its provenance: comment lines in CSV, gnuplot, TOML and text, the key "provenance" in JSON (with
// the scene's text), metadata in SVG and a text chunk in PNG. Other kinds as they are.
[[nodiscard]] std::string with_provenance(const std::string& name, const std::string& contents,
                                          const Provenance& origin);

}  // namespace hb::tools
