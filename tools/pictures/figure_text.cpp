#include "tools/pictures/figure_text.hpp"

#include <fmt/core.h>

#include "tools/pictures/gnuplot.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

std::string verdict_text(const RodResult& rod) {
  if (!rod.stability) return "";
  switch (rod.stability->verdict) {
    case Verdict::stable:
      return ", stable";
    case Verdict::unstable:
      return ", UNSTABLE: would not be seen in a machine";
    case Verdict::bounded:
      return ", bounded";
    case Verdict::undecided:
      break;
  }
  return ", stability undecided";
}

std::string verdicts_text(const SpeedResult& result) {
  std::string text;
  bool same = true;
  const RodResult* first = nullptr;
  for (const RodResult& rod : result.rods) {
    if (!rod.stability) continue;
    if (!first) first = &rod;
    same = same && rod.stability->verdict == first->stability->verdict;
    text += ", " + rod.name + " " + to_string(rod.stability->verdict);
  }
  return first && same ? std::string(", ") + to_string(first->stability->verdict) : text;
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
  const std::string first = "'{/:Bold " + literal(bold) + "}'";
  if (shown.empty()) return first;
  std::string title = first + ".\"\\n\".'";
  for (const char c : shown) title += c == '\n' ? "'.\"\\n\".'" : std::string(1, c);
  return title + "'";
}

std::string rod_title(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                      const std::string& shown) {
  const std::string subject = model.linkage() ? ", " + rod.name : "";
  std::string beyond;
  for (std::size_t r = 0; result.theory && r < result.rods.size(); ++r)
    if (&result.rods[r] == &rod) beyond = beyond_text(*result.theory, r);
  return two_lines(short_name(model.scene) + subject + ", " + speed_text(result.speed, model.scene) + verdict_text(rod),
                   shown + (beyond.empty() ? "" : "; " + beyond));
}

std::string scene_title(const SceneModel& model, const SpeedResult& result, const std::string& shown) {
  const std::string beyond = beyond_text(result);
  return two_lines(short_name(model.scene) + ", " + speed_text(result.speed, model.scene) + verdicts_text(result),
                   shown + (beyond.empty() ? "" : (shown.empty() ? "" : "\n") + literal(beyond)));
}

std::string figure_name(const std::string& kind, const std::string& name) { return file_name(kind + "_" + name); }

}  // namespace hb::tools
