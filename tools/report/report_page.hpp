// One self-contained HTML page from a document of data: template, style, script and plotting library are part of the
// program.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/output/provenance.hpp"

namespace hb::tools {

// What stands in the page before any script runs.
struct PageText {
  Provenance origin;  // with the scene's file
  std::string title, subtitle;
  std::string scene_table;  // as `hb scene` prints it
  struct Rod {
    std::string name, verdict;  // at the first speed; may be empty
  };
  std::vector<Rod> rods;
  std::size_t num_points = 0;  // speeds that can be chosen
  std::string first_rpm;  // as in JSON
  bool has_map = false;
  struct Picture {
    std::string words, png;
  };
  std::vector<Picture> pictures;  // for readers without script
};

// The text that only the caller knows, from where the page comes from.
[[nodiscard]] PageText page_text(const Provenance& origin, std::vector<PageText::Picture> pictures);

// Empty if the program can write reports; else a sentence that says what was missing when it was built.
[[nodiscard]] std::string report_obstacle();

// `data` as report_data.hpp makes it.
[[nodiscard]] std::string report_page(const PageText& text, const nlohmann::ordered_json& data);

// Text inside HTML, quotes included.
[[nodiscard]] std::string html_escaped(const std::string& text);

}  // namespace hb::tools
