// Pictures as they are asked for: kinds, size, titles.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/run_command.hpp"

namespace {

namespace fs = std::filesystem;

class Pictures : public CommandTest {
 protected:
  // A big-endian number of the header.
  static int from_header(const std::string& png, std::size_t at) {
    int value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = 256 * value + static_cast<unsigned char>(png.at(at + k));
    return value;
  }
  std::string steady(const std::string& flags) const {
    return "steady " + scene("slider_crank") + " --rpm 1500 --modes 1 --out " + flags;
  }
};

TEST_F(Pictures, AreOfTheKindsAndTheSizeAskedFor) {
  const CommandResult result = hb(steady("some --format pdf,png --size 640x400"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "some/torque.svg"));
  const std::string png = read(folder_ / "some/torque.png");
  EXPECT_EQ(from_header(png, 16), 2 * 640);
  EXPECT_EQ(from_header(png, 20), 2 * 400);
  const std::string pdf = read(folder_ / "some/torque.pdf");
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_NE(pdf.find("MediaBox [ 0 0 640 400 ]"), std::string::npos);
}

TEST_F(Pictures, InPdfAreTheSameBytesWheneverTheyAreDrawn) {
  ASSERT_EQ(hb(steady("first --format pdf")).status, 0);
  ASSERT_EQ(hb(steady("second --format pdf")).status, 0);
  const std::string first = read(folder_ / "first/torque.pdf");
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first, read(folder_ / "second/torque.pdf"));
}

TEST_F(Pictures, HaveNoTitlesWhereNoneAreWanted) {
  ASSERT_EQ(hb(steady("with --format svg")).status, 0);
  ASSERT_EQ(hb(steady("without --format svg --no-titles")).status, 0);
  const std::string words = "driving torque on the crank", title = "rpm";  // of an axis; of the title's first line
  EXPECT_NE(read(folder_ / "without/torque.svg").find(words), std::string::npos);
  const auto drawn = [&](const std::string& folder) {  // without what says where the picture comes from
    const std::string svg = read(folder_ / folder / "torque.svg");
    return svg.substr(svg.find("<path"));
  };
  EXPECT_NE(drawn("with").find(title), std::string::npos);
  EXPECT_EQ(drawn("without").find(title), std::string::npos);
}

TEST_F(Pictures, OfOtherKindsAndSizesAreRefused) {
  const auto refusal = [&](const std::string& flags) {
    const CommandResult result = hb(steady("out " + flags));
    EXPECT_EQ(result.status, 2);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    return result.err;
  };
  EXPECT_NE(refusal("--format gif").find("--format: found \"gif\", allowed: svg, png, pdf"), std::string::npos);
  EXPECT_NE(refusal("--size 640").find("--size: found \"640\", allowed: WIDTHxHEIGHT in points"), std::string::npos);
  EXPECT_NE(refusal("--size 20x9000").find("each 200 to 4000"), std::string::npos);
}

}  // namespace
