#include "tools/report/sweep_band_data.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/output/json.hpp"
#include "tools/output/sweep_bands.hpp"
#include "tools/report/page_values.hpp"

namespace hb::tools {
namespace {

// Component i of an array of lists, one list for each point.
std::vector<double> component(const Json& lists, std::size_t i) {
  Json column = Json::array();
  for (const Json& list : lists) column.push_back(list.is_array() && i < list.size() ? list[i] : Json());
  return numbers(column);
}

// As many components as the page draws.
std::size_t drawn_components(const Json& lists) {
  constexpr std::size_t most = 3;
  std::size_t count = 0;
  for (const Json& list : lists) count = std::max(count, list.is_array() ? list.size() : 0);
  return std::min(count, most);
}

}  // namespace

Json sweep_band_data(const Json& sweep, ByteBlock& block) {
  Json list = Json::array();
  for (const Json& band : sweep.at("bands")) {
    Json own = {{"parameter", band["parameter"]}, {"from", band["from"]}, {"to", band["to"]}};
    for (const auto& [name, low] : band["at_from"]["rods"].items()) {
      const Json& high = band["at_to"]["rods"][name];
      Json& rod = own["rods"][name];
      if (low.contains("max_abs") && high.contains("max_abs"))
        for (std::size_t i = 0; i < drawn_components(low["max_abs"]); ++i)
          rod["max_abs"].push_back(
              {block.floats(component(low["max_abs"], i)), block.floats(component(high["max_abs"], i))});
      if (low.contains("growth_rate") && high.contains("growth_rate"))
        rod["growth_rate"] = {block.floats(numbers(low["growth_rate"])), block.floats(numbers(high["growth_rate"]))};
    }
    for (const BandExtreme& extreme : band_extremes(sweep, band))
      own["largest"].push_back({{"name", extreme.name},
                                {"from", number(extreme.low)},
                                {"given", number(extreme.given)},
                                {"to", number(extreme.high)}});
    list.push_back(std::move(own));
  }
  return list;
}

}  // namespace hb::tools
