#include "tools/report/page_pictures.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tools/work/errors.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most_bytes = 500000;  // of all pictures of a page

// Places in this order; what has none here stays away.
const std::vector<std::pair<std::string, std::string>> shown = {{"mechanism", "The mechanism"},
                                                                {"map", "Stability map"},
                                                                {"campbell", "Campbell diagram"},
                                                                {"growth", "Growth rate along the speed"},
                                                                {"branches", "Motion without linearisation"},
                                                                {"peaks", "Largest response"},
                                                                {"before_after", "Before and after"},
                                                                {"response", "Response"},
                                                                {"deflection", "Deflection along the link"},
                                                                {"torque", "Driving torque"}};

std::size_t place_of(const Figure& figure) {
  const auto at = std::find_if(shown.begin(), shown.end(), [&](const auto& kind) {
    return figure.name == kind.first || figure.name.starts_with(kind.first + "_");
  });
  return static_cast<std::size_t>(at - shown.begin());
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::vector<PageText::Picture> page_pictures(const std::vector<Figure>& figures, OutputFolder& folder) {
  std::vector<Figure> chosen;
  for (std::size_t k = 0; k < shown.size(); ++k)
    for (const Figure& figure : figures)
      if (place_of(figure) == k) chosen.push_back(figure);
  if (chosen.empty()) return {};
  const std::string script = "page.gp";
  folder.write(script, plot_script(chosen, {.kinds = page_kinds}));
  const fs::path place = folder.scratch_with_links();
  const PlotOutcome outcome = run_gnuplot(place, script, chosen, std::chrono::seconds(30), page_kinds);
  std::vector<PageText::Picture> pictures;
  std::size_t bytes = 0;
  for (const Figure& figure : chosen) {
    const std::string file = figure.name + "." + page_kinds.front();
    const bool whole = std::find(outcome.missing.begin(), outcome.missing.end(), figure.name) == outcome.missing.end();
    std::string png = whole ? contents(place / file) : "";
    folder.drop(file);
    if (png.empty() || bytes + png.size() > most_bytes) continue;
    bytes += png.size();
    const auto& [prefix, words] = shown[place_of(figure)];
    const std::string subject = figure.name.size() > prefix.size() ? figure.name.substr(prefix.size() + 1) : "";
    pictures.push_back({subject.empty() ? words : fmt::format("{}: {}", words, subject), std::move(png)});
  }
  folder.drop(script);
  return pictures;
}

std::vector<PageText::Picture> page_pictures(const std::function<std::vector<Figure>(OutputFolder&)>& write) {
  std::string name = (fs::temp_directory_path() / "hb-report-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) return {};
  const Unfinished removed_on_signal(name, Unfinished::Kind::tree);
  std::vector<PageText::Picture> pictures;
  try {
    OutputFolder folder(fs::path(name) / "pictures", "report");
    const std::vector<Figure> figures = write(folder);
    pictures = page_pictures(figures, folder);
  } catch (const OutputError&) {  // the page does without
  }
  std::error_code ignored;
  fs::remove_all(name, ignored);
  return pictures;
}

}  // namespace hb::tools
