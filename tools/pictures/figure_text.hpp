// What the pictures of a scene share: titles, the axis of a turn, names of their files. Texts are gnuplot's, with
// enhanced markup.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb::tools {

inline constexpr const char* turn_axis = "set xrange [0:360]\nset xtics 0,60,360\n";
// The label of that axis: the crank's angle, or the phase of a [hill] system.
[[nodiscard]] std::string turn_label(const SceneModel& model);

// The scene's name, short enough for a title.
[[nodiscard]] std::string short_name(const Scene& scene);
// Quoted; the first line in bold says scene, rod, speed and verdict, the second what is shown (enhanced markup).
[[nodiscard]] std::string rod_title(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                                    const std::string& shown);
// The same of all rods together; `shown` may be empty.
[[nodiscard]] std::string scene_title(const SceneModel& model, const SpeedResult& result, const std::string& shown);
// A quoted title, the first line in bold and literal; `shown` may have several lines.
[[nodiscard]] std::string two_lines(const std::string& bold, const std::string& shown);

// The same of the scene's short name and what stands behind it (rod, speed, verdict), of which some may be empty.
[[nodiscard]] std::string figure_title(const Scene& scene, const std::vector<std::string>& parts,
                                       const std::string& shown);

// File name of a picture, without extension.
[[nodiscard]] std::string figure_name(const std::string& kind, const std::string& name);

}  // namespace hb::tools
