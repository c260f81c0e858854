// The report's page without a browser: bytes, packed numbers, text in HTML.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/report/base64.hpp"
#include "tools/report/byte_block.hpp"
#include "tools/report/packed_numbers.hpp"
#include "tools/report/report_page.hpp"
#include "tools/report/report_places.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

TEST(Base64, AgreesWithTheVectorsOfRfc4648) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(ByteBlock, ColumnsBeginAtWholeDoublesWhateverStandsBefore) {
  ByteBlock block;
  EXPECT_EQ(block.floats(std::vector{1.0}), Json({0, 1}));
  EXPECT_EQ(block.doubles(std::vector{1.0, 2.0}), Json({8, 2}));
  // 1 as a float, 4 bytes of nothing, 1 and 2 as doubles, little endian.
  EXPECT_EQ(block.base64(), "AACAPwAAAAAAAAAAAADwPwAAAAAAAABA");
}

TEST(ByteBlock, SeriesAreKeptAsFarAsEachComponentNeeds) {
  FourierSeries series(2, 4);
  series.c(0, 0) = 1;
  series.c(0, 3) = 2e-5;
  series.c(0, 4) = 0.5e-5;
  series.c(1, 1) = 1e-9;  // small, and the largest of its component
  ByteBlock block;
  EXPECT_EQ(block.series(series), Json({0, {3, 1}}));
}

TEST(ByteBlock, NumbersBeyondAFloatAreNoNumbersRatherThanInfinite) {
  ByteBlock block;
  (void)block.floats(std::vector{1e300});
  EXPECT_EQ(block.base64(), "AADAfw==");  // quiet NaN
}

TEST(PackedNumbers, DocumentsOfOneKindShareAShapeAndTheirTexts) {
  PackedNumbers packed;
  const auto first = packed.add({{"rpm", 300.0}, {"verdict", "stable"}, {"exponents", {{1.0, 2.0}}}, {"ok", true}});
  const auto second = packed.add({{"rpm", nullptr}, {"verdict", "stable"}, {"exponents", {{3.0, 4.0}}}, {"ok", false}});
  const auto longer = packed.add({{"rpm", 1.0}, {"verdict", "unstable"}, {"exponents", Json::array()}, {"ok", true}});
  EXPECT_EQ(first.shape, second.shape);
  EXPECT_NE(first.shape, longer.shape);
  EXPECT_EQ(packed.shapes()[first.shape].dump(), R"({"rpm":0,"verdict":1,"exponents":[[0,0]],"ok":2})");
  EXPECT_EQ(packed.words(), (std::vector<std::string>{"stable", "unstable"}));
  ASSERT_EQ(second.first, 5u);
  EXPECT_EQ(packed.numbers()[0], 300);
  EXPECT_TRUE(std::isnan(packed.numbers()[second.first]));
  EXPECT_EQ(packed.numbers()[second.first + 3], 4);
}

TEST(ReportPlaces, AllPointsAreKeptUpToFourHundredAndOfMoreTheLastToo) {
  EXPECT_TRUE(kept_points(0).empty());
  EXPECT_EQ(kept_points(1).size(), 1u);
  EXPECT_EQ(kept_points(most_places).size(), most_places);
  for (const std::size_t count : {401u, 1000u, 1001u, 123457u}) {
    const std::vector<std::size_t> kept = kept_points(count);
    EXPECT_LE(kept.size(), most_places + 1);
    EXPECT_EQ(kept.front(), 0u);
    EXPECT_EQ(kept.back(), count - 1);
  }
}

TEST(ReportPage, NoTextLeavesItsPlace) {
  PageText text;
  text.title = "</title><script>x</script>{{data}}{{{script}}}";
  text.rods = {{"<b>&\"'{{#rods}}", "stable"}};
  text.origin.scene_text = "</pre>";
  text.num_points = 2;
  const std::string page = report_page(text, {{"words", "</script><!--"}});
  EXPECT_NE(page.find("<title>&lt;/title&gt;&lt;script&gt;x&lt;/script&gt;{{data}}{{{script}}}</title>"), page.npos);
  EXPECT_NE(page.find("id=\"verdict-&lt;b&gt;&amp;&quot;&#39;{{#rods}}\""), page.npos);
  EXPECT_NE(page.find("{\"words\":\"\\u003c/script>\\u003c!--\"}"), page.npos);
  EXPECT_NE(page.find("&lt;/pre&gt;"), page.npos);
  EXPECT_EQ(page.find("<script>x"), page.npos);
}

TEST(ReportPage, LongTextIsCutBetweenCharacters) {
  PageText text;
  for (int k = 0; k < 1000; ++k) text.title += "Ω";
  const std::string page = report_page(text, Json::object());
  const std::size_t begin = page.find("<title>") + 7, end = page.find(" … (cut)</title>");
  ASSERT_NE(end, page.npos);
  EXPECT_LE(end - begin, 300u);
  EXPECT_EQ((end - begin) % std::string("Ω").size(), 0u);
}

}  // namespace
}  // namespace hb::tools
