#include "tools/pictures/figure_text.hpp"

#include <fmt/core.h>

#include "tools/output/output_folder.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

// The mechanism's, whichever rods are shown.
std::string verdict_text(const SpeedResult& result) {
  const std::string verdict = title_verdict(named_verdicts(result.rods));
  return verdict.empty() ? "" : ", " + verdict;
}

}  // namespace

std::string turn_label(const SceneModel& model) {
  return model.linkage() ? "set xlabel 'crank angle [deg]'\n" : "set xlabel 'phase Ωt [deg]'\n";
}

std::string short_name(const Scene& scene) {
  constexpr std::size_t longest = 48;  // bytes
  std::string name = scene_name(scene);
  if (name.size() <= longest) return name;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // not inside a UTF-8 character
  return name.substr(0, end) + "...";
}

// gnuplot reads \n only in double quotes.
std::string two_lines(const std::string& bold, const std::string& shown) {
  const std::string first = "heading('{/:Bold " + literal(bold) + "}'";
  if (shown.empty()) return first + ")";
  std::string title = first + ".\"\\n\".'";
  for (const char c : shown) title += c == '\n' ? "'.\"\\n\".'" : std::string(1, c);
  return title + "')";
}

std::string rod_title(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                      const std::string& shown) {
  const std::string subject = model.linkage() ? ", " + rod.name : "";
  std::string beyond;
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    if (&result.rods[r] == &rod) beyond = beyond_text(result, r);
  constexpr std::size_t longest = 84;  // bytes that a picture is wide
  const char* gap = shown.size() + beyond.size() + 2 > longest ? "\n" : "; ";
  return two_lines(
      short_name(model.scene) + subject + ", " + speed_text(result.speed, model.scene) + verdict_text(result),
      shown + (beyond.empty() ? "" : gap + beyond));
}

std::string scene_title(const SceneModel& model, const SpeedResult& result, const std::string& shown) {
  const std::string beyond = beyond_text(result);
  return two_lines(short_name(model.scene) + ", " + speed_text(result.speed, model.scene) + verdict_text(result),
                   shown + (beyond.empty() ? "" : (shown.empty() ? "" : "\n") + literal(beyond)));
}

std::string figure_title(const Scene& scene, const std::vector<std::string>& parts, const std::string& shown) {
  std::string bold = short_name(scene);
  for (const std::string& part : parts)
    if (!part.empty()) bold += ", " + part;
  return two_lines(bold, shown);
}

std::string figure_name(const std::string& kind, const std::string& name) { return file_name(kind + "_" + name); }

}  // namespace hb::tools
