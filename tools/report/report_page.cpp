#include "tools/report/report_page.hpp"

#include <fmt/core.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "tools/output/json.hpp"
#include "tools/report/base64.hpp"
#include "tools/report/page_parts.hpp"

namespace hb::tools {
namespace {

using Values = std::map<std::string, std::string, std::less<>>;

constexpr std::size_t longest_title = 300, longest_text = 200000;

// At most so many bytes, cut between characters.
std::string cut(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return text.substr(0, end) + " … (cut)";
}

// A template's {{key}} (escaped), {{{key}}} (as it is) and {{#rods}} ... {{/rods}} (once for each rod), in one pass:
// what is put in is not looked at again.
std::string filled(std::string_view text, const Values& values, const std::vector<Values>& rods) {
  std::string page;
  for (std::size_t at = 0;;) {
    const std::size_t open = text.find("{{", at);
    page += text.substr(at, open == text.npos ? open : open - at);
    if (open == text.npos) return page;
    const bool raw = text.substr(open).starts_with("{{{");
    const std::string_view end = raw ? "}}}" : "}}";
    const std::size_t begin = open + end.size(), close = text.find(end, begin);
    const std::string_view key = text.substr(begin, close - begin);
    at = close + end.size();
    if (key == "#rods") {
      constexpr std::string_view last = "{{/rods}}";
      const std::size_t stop = text.find(last, at);
      for (const Values& rod : rods) page += filled(text.substr(at, stop - at), rod, {});
      at = stop + last.size();
      continue;
    }
    const auto value = values.find(key);
    if (value != values.end()) page += raw ? value->second : html_escaped(value->second);
  }
}

// JSON that no HTML parser takes for the end of its element.
std::string json_in_html(const Json& data) {
  const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string pictures_html(const std::vector<PageText::Picture>& pictures) {
  if (pictures.empty()) return "<p>This report was written without pictures.</p>";
  std::string html;
  for (const PageText::Picture& picture : pictures)
    html += "<figure><img alt=\"" + html_escaped(picture.words) + "\" src=\"data:image/png;base64," +
            base64(picture.png) + "\"><figcaption>" + html_escaped(picture.words) + "</figcaption></figure>\n";
  return html;
}

}  // namespace

std::string html_escaped(const std::string& text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

PageText page_text(const Provenance& origin, std::vector<PageText::Picture> pictures) {
  PageText text;
  text.origin = origin;
  text.pictures = std::move(pictures);
  return text;
}

std::string report_obstacle() {
  return page::library.empty() ? "this program was built without the plotting library dygraphs: install libjs-dygraphs "
                                 "(Debian) and build again"
                               : "";
}

std::string report_page(const PageText& text, const Json& data) {
  const Provenance& origin = text.origin;
  const std::string provenance = fmt::format("Written by {}: {}. Scene {}, CRC-32 {:08x}.", origin.program,
                                             origin.command, origin.scene_file, crc32(origin.scene_text));
  Values values = {{"version", origin.program},
                   {"title", cut(text.title, longest_title)},
                   {"subtitle", cut(text.subtitle, longest_title)},
                   {"provenance", cut(provenance, longest_text)},
                   {"scene_table", cut(text.scene_table, longest_text)},
                   {"first_rpm", text.first_rpm},
                   {"last_index", std::to_string(text.num_points > 0 ? text.num_points - 1 : 0)},
                   {"speed_disabled", ""},
                   {"pictures", pictures_html(text.pictures)},
                   {"data", json_in_html(data)},
                   {"style", std::string(page::style)},
                   {"script", std::string(page::script)},
                   {"library", std::string(page::library)},
                   {"library_style", std::string(page::library_style)},
                   {"licence", std::string(page::library_licence)}};
  if (text.has_map) values["map_canvas"] = "<canvas id=\"map\"></canvas>";
  if (text.num_points < 2) values["speed_disabled"] = " disabled";
  if (!origin.scene_text.empty())
    values["scene_source"] = "<details><summary>The scene's file</summary><pre tabindex=\"0\">" +
                             html_escaped(cut(origin.scene_text, longest_text)) + "</pre></details>";
  std::vector<Values> rods;
  for (const PageText::Rod& rod : text.rods) rods.push_back({{"name", rod.name}, {"verdict", rod.verdict}});
  return filled(page::html, values, rods);
}

}  // namespace hb::tools
