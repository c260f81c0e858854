#include "tools/command/tune_heights.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/range_units.hpp"

namespace hb::tools {

std::map<std::string, double> heights_flag(const std::vector<std::string>& texts, const Units& units) {
  std::map<std::string, double> heights;
  const auto read = [&](std::string_view part) { return length_quantity(part, units); };
  for (const std::string& text : texts) {
    const NamedRange height = named_range("--height", text, "ROD=H, as in AB=12");
    heights[height.path] = number_flag("--height", plain_range("--height", height.range, ThirdNumber::step, read),
                                       std::numeric_limits<double>::min(), largest_number, "ROD=H with H > 0");
  }
  return heights;
}

void require_heights(const TuneTask& task, const Scene& scene) {
  const std::map<std::string, double>& heights = task.heights;
  if (heights.empty()) return;
  const std::vector<std::string> paths = task.family.paths();
  std::vector<std::string> without, with;  // a section
  if (const auto* linkage = std::get_if<Linkage>(&scene.model)) {
    for (const int link : elastic_links(*linkage)) {
      const std::string name = body_name(*linkage, link);
      const bool section = std::ranges::any_of(paths, [&](const std::string& path) {
        return path.starts_with(name + ".section.") || path.starts_with(name + ".elastic.section.");
      });
      (section ? with : without).push_back(name);
    }
  }
  std::vector<std::string> allowed = without;
  if (!without.empty()) allowed.insert(allowed.begin(), "*");
  const std::string list = allowed.empty() ? "no --height" : fmt::format("{}", fmt::join(allowed, ", "));
  for (const auto& [name, height] : heights) {
    if (std::ranges::find(allowed, name) != allowed.end()) continue;
    if (name == "*" || std::ranges::find(with, name) != with.end())
      throw UsageError(fmt::format(
          "--height: found {}={:g}, where the section in the scene gives the height; allowed: {}", name, height, list));
    throw UsageError(fmt::format("--height: found {}, no elastic link of the scene; allowed: {}", name, list));
  }
  if (heights.contains("*") && heights.size() > 1)
    throw UsageError("--height: found * beside a rod's name, allowed: * alone, or one for each rod");
  const auto is_stress = [](const Metric& metric) {
    return metric.kind == MetricKind::stress || is_whole_stress(metric);
  };
  if (std::ranges::none_of(task.goal.terms, is_stress, &GoalTerm::metric) &&
      std::ranges::none_of(task.keeps, is_stress, &Keep::metric))
    throw UsageError(
        fmt::format("--height: found {}={:g}, allowed: with stress, total-stress or safety as goal or condition",
                    heights.begin()->first, heights.begin()->second));
}

}  // namespace hb::tools
