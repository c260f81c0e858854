#include "hb/analysis/range_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hb {
namespace {

struct Found {
  Remark remark;
  std::size_t place = 0;  // the first that has it
  std::size_t count = 1;  // places with these very words
};

}  // namespace

std::vector<std::string> place_warnings(const SceneFamily& family, const std::vector<RangePlace>& places) {
  std::vector<Found> all;
  std::size_t scenes = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const FamilyMember member = family.at(places[k].numbers);
    if (!member.scene) continue;
    ++scenes;
    for (const Remark& remark : member.scene->remarks) {
      if (remark.concern < places[k].least) continue;
      const auto known = std::ranges::find_if(all, [&](const Found& found) {
        return found.remark.concern == remark.concern && found.remark.subject == remark.subject;
      });
      if (known == all.end())
        all.push_back({remark, k});
      else
        known->count += known->remark.words == remark.words;
    }
  }
  std::vector<Remark> remarks;
  for (Found& found : all) {
    if (found.count < scenes) found.remark.words += fmt::format(" (at {})", places[found.place].name);
    remarks.push_back(std::move(found.remark));
  }
  return warning_lines(std::move(remarks));
}

std::vector<std::string> range_warnings(const SceneFamily& family, const std::vector<const Along*>& axes) {
  std::vector<RangePlace> places(1);
  for (const Along* axis : axes) {
    if (is_speed(axis->path) || axis->values.empty()) continue;
    std::vector<RangePlace> further;
    for (const RangePlace& place : places)
      for (const double end : {axis->values.front(), axis->values.back()}) {
        further.push_back(place);
        further.back().numbers.push_back({axis->path, end});
        further.back().name += fmt::format("{}{} = {:.6g}", place.name.empty() ? "" : ", ", axis->path, end);
      }
    places = std::move(further);
  }
  return place_warnings(family, places);
}

}  // namespace hb
