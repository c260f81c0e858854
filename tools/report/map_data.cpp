#include "tools/report/map_data.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "tools/output/json.hpp"
#include "tools/report/page_values.hpp"

namespace hb::tools {

Json map_data(Json map, const SceneSource& source, const Units& units, ByteBlock& block) {
  const auto grid = [&](Json& rows) {
    std::vector<double> values;
    for (const Json& row : rows)
      for (const double value : numbers(row)) values.push_back(value);
    return block.floats(values);
  };
  Json own;
  for (const char* name : {"x", "y"}) {
    own[name] = axis_json(map[name]["path"].get<std::string>(), units);
    own[name]["values"] = map[name]["values"];
    const std::string path = map[name]["path"];
    try {
      if (path != "rpm" && path != "omega") own["scene_values"][path] = source.value(path);
    } catch (const SceneError&) {
      // The file leaves the number out.
    }
  }
  own["growth_rate"] = grid(map["growth_rate"]);
  own["growth_error"] = grid(map["growth_error"]);
  for (const Json& row : map["verdict"]) own["verdict"].push_back(letters(row));
  own["boundaries"] = Json::array();
  const auto curve = [&](Json& from) {
    std::vector<double> values;
    for (const Json& point : from["points"]) {
      values.push_back(point[0]);
      values.push_back(point[1]);
    }
    from["count"] = from["points"].size();
    from["points"] = block.doubles(values);
    return std::move(from);
  };
  for (Json& boundary : map["boundaries"]) own["boundaries"].push_back(curve(boundary));
  for (const char* key : {"damping_range", "band"}) {
    if (!map.contains(key)) continue;
    for (Json& range : map[key])
      for (Json& boundary : range["boundaries"]) boundary = curve(boundary);
    own["band"] = std::move(map[key]);
  }
  for (const char* key : {"resonance_lines", "counts"})
    if (map.contains(key)) own[key] = std::move(map[key]);
  std::string words;
  for (const Json& missing : map["missing"])
    words += fmt::format("No system at {} points: {}. ", missing["count"].get<std::size_t>(),
                         missing["reason"].get<std::string>());
  own["words"] = words;
  return own;
}

}  // namespace hb::tools
