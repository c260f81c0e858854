// What a sweep or a map goes along: the speed, or another number of a family of scenes, at given values.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/analysis/scene_family.hpp"

namespace hb {

// A number and its values in ascending order: "rpm", "omega" (rad per the scene's unit of time), or one of the family.
struct Along {
  std::string path;
  std::vector<double> values;
};
// The speed, also by its path in a scene ("analysis.rpm").
[[nodiscard]] bool is_speed(const std::string& path);
[[nodiscard]] bool in_rpm(const std::string& path);
// Two paths that name one number: "AB.J" and "*.J" do where AB is elastic.
[[nodiscard]] bool same_number(const SceneFamily& family, const std::string& a, const std::string& b);
// N >= 2 equally spaced values, both ends included.
[[nodiscard]] Along along(std::string path, double from, double to, std::size_t count);

// Some scene of the family with the axes at one of their values, for what does not depend on them. Throws
// ObstructedLinkage where none of them turns through.
[[nodiscard]] Scene some_scene(const SceneFamily& family, const std::vector<const Along*>& axes);

// Throw RequestError, `field`: fewer than two values, not ascending, speeds that are not positive; a speed asked for
// beside an axis that is the speed.
void require_values(const char* field, const Along& along, const Units& units);
void require_no_speed(const Request& request, const char* field, const Along& axis);

}  // namespace hb
