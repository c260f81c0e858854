// Work that ends before it is done gives what is there, in the shape that it would have had.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hb/analysis/analyses.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/run_command.hpp"
#include "tools/output/check_json.hpp"
#include "tools/output/check_report.hpp"
#include "tools/report/report_page.hpp"

namespace {

namespace fs = std::filesystem;

class EarlyEnds : public CommandTest {};

// Nothing was printed: the signal ended the program as soon as branches were followed.
TEST_F(EarlyEnds, CtrlCPrintsTheBranchesThatAreThere) {
  std::ofstream(folder_ / "run.sh") << "cd '" << folder_.string() << "'\n'" HB_COMMAND "' sweep " << scene("six_link")
                                    << " --theory nonlinear --rpm 300:1440:20 --modes 6 --no-search >out.txt 2>err.txt "
                                       "</dev/null &\nchild=$!\nsleep 1.5\nkill -INT $child\nwait $child\n";
  const int status = std::system(("bash -m '" + (folder_ / "run.sh").string() + "' 2>/dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string out = read(folder_ / "out.txt");
  EXPECT_NE(out.find("NOT REACHED: stopped before all branches were followed to their ends"), std::string::npos) << out;
  EXPECT_EQ(out.find("--time-limit"), std::string::npos) << out;
}

TEST_F(EarlyEnds, ACheckWithoutAnAnswerSaysSoInJson) {
  const CommandResult cut = hb("check " + scene("six_link") + " --rpm 300 --json --time-limit 0.002");
  EXPECT_EQ(cut.status, 3);
  const auto found = nlohmann::json::parse(cut.out, nullptr, false);
  ASSERT_FALSE(found.is_discarded()) << cut.out;
  EXPECT_EQ(found["status"], "tolerance not reached");
  EXPECT_NE(found["notes"][0].get<std::string>().find("before there was an answer"), std::string::npos);
}

class OnePart : public hb::Work {
 public:
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task) const override {
    for (std::size_t k = 0; k < count; ++k) {
      task(k);
      ended_ = true;
    }
  }
  [[nodiscard]] bool ends_early() const override { return ended_; }

 private:
  mutable bool ended_ = false;
};

// A range of which one speed was computed had numbers instead of arrays.
TEST_F(EarlyEnds, ARangeOfCheckKeepsItsShape) {
  hb::CheckRequest request;
  request.omegas = {1, 1.5, 2};
  const hb::Scene mathieu = hb::read_scene(HB_SOURCE_DIR "/tests/scenes/mathieu.toml");
  const hb::Check cut = hb::check(mathieu, request, OnePart());
  ASSERT_EQ(cut.speeds.size(), 1u);
  const nlohmann::ordered_json found = hb::tools::check_json(cut);
  EXPECT_TRUE(found["omega"].is_array());
  EXPECT_TRUE(found["verdict"].is_array());
  EXPECT_TRUE(found["rods"]["system"]["q_difference"].is_array());
  EXPECT_EQ(found["status"], "tolerance not reached");
  EXPECT_NE(hb::tools::check_report(cut, false).find("2 of 3 speeds were not computed"), std::string::npos);
  request.omegas = {1};
  EXPECT_TRUE(hb::tools::check_json(hb::check(mathieu, request))["omega"].is_number());
}

// Every place was computed in full after the end: five seconds later there was no page.
TEST_F(EarlyEnds, AReportIsAPageWithWhatIsThere) {
  if (!hb::tools::report_obstacle().empty()) GTEST_SKIP() << hb::tools::report_obstacle();
  const CommandResult cut =
      hb("report " + scene("six_link") + " --rpm 200:6000:10 --modes 5 --no-plots --time-limit 1 --out page.html");
  EXPECT_EQ(cut.status, 3) << cut.err;
  EXPECT_NE(cut.err.find("NOT REACHED: ended before the answer was complete"), std::string::npos) << cut.err;
  ASSERT_TRUE(fs::exists(folder_ / "page.html"));
  const std::string page = read(folder_ / "page.html");
  EXPECT_NE(page.find("not computed before the end"), std::string::npos);
  EXPECT_NE(page.find("</html>"), std::string::npos);
}

}  // namespace
