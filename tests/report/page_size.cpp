// What a page weighs, without a browser: numbers and curves of many speeds beside a large map.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/report/report_data.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

const std::string six_link = std::string(HB_SOURCE_DIR) + "/tests/scenes/six_link.toml";

// A map of n x n points as map_json has it, with curves of as many points as real ones have.
Json map_of(std::size_t n, std::size_t curves, std::size_t points) {
  Json map;
  map["x"]["path"] = "rpm";
  map["y"]["path"] = "*.J";
  for (std::size_t k = 0; k < n; ++k) {
    map["x"]["values"].push_back(200 + 14.07 * static_cast<double>(k));
    map["y"]["values"].push_back(20 + 0.503 * static_cast<double>(k));
    Json growth = Json::array(), error = Json::array(), verdict = Json::array();
    for (std::size_t i = 0; i < n; ++i) {
      growth.push_back(std::sin(static_cast<double>(i * k)));
      error.push_back(1e-9);
      verdict.push_back(growth.back() > 0 ? "unstable" : "stable");
    }
    map["growth_rate"].push_back(growth);
    map["growth_error"].push_back(error);
    map["verdict"].push_back(verdict);
  }
  map["boundaries"] = Json::array();
  for (std::size_t c = 0; c < curves; ++c) {
    Json line = {{"rod", "AB"}, {"kind", "-1"}, {"closed", false}, {"error", 1e-11}, {"points", Json::array()}};
    for (std::size_t p = 0; p < points; ++p)
      line["points"].push_back({200 + std::sqrt(static_cast<double>(p)), 20 + std::cbrt(static_cast<double>(p))});
    map["boundaries"].push_back(line);
  }
  map["missing"] = Json::array();
  return map;
}

// With sections of the same area and second moment: the page draws their stress too.
SceneSource six_link_with_sections() {
  std::ifstream file(six_link);
  std::string text(std::istreambuf_iterator<char>(file), {});
  for (const auto& [given, section] : {std::pair("area = 10, J = 45", "width = 1.361, height = 7.348"),
                                       {"area = 9, J = 45", "width = 1.162, height = 7.746"}}) {
    const std::size_t at = text.find(given);
    EXPECT_NE(at, std::string::npos);
    text.replace(at, std::string(given).size(), fmt::format("section = {{ shape = \"rectangle\", {} }}", section));
  }
  return SceneSource(text, six_link, std::filesystem::path(six_link).parent_path());
}

std::size_t page_bytes(int num_speeds, const Json& map) {
  const SceneSource source = six_link_with_sections();
  Axis axis;
  for (int k = 0; k < num_speeds; ++k) axis.values.push_back(300 + 2700.0 * k / (num_speeds - 1));
  Settings settings;
  settings.search = false;  // adds some rows to the charts, not to the speeds
  const SweepScene scene(source, {}, settings, axis, 1, 300);
  Work work;
  ReportData data(scene.scene());
  data.add_sweep(scene, run_sweep(scene, work), places_along(scene, work));
  if (!map.is_null()) data.add_map(map, source);
  return data.page({}).size();
}

TEST(ReportSize, TwoHundredSpeedsOfTwoRodsStayBelowThreeMegabytes) { EXPECT_LT(page_bytes(200, nullptr), 3'000'000u); }

TEST(ReportSize, FourHundredSpeedsBesideAMapOfFortyThousandPointsStayBelowSix) {
  EXPECT_LT(page_bytes(400, map_of(200, 40, 400)), 6'000'000u);
}

}  // namespace
}  // namespace hb::tools
