// A grid over two numbers of a scene line by line, each a sweep of equal scenes where one axis is the speed.
#pragma once

#include <cstddef>
#include <vector>

#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/scene_plane.hpp"
#include "hb/analysis/sweep/sweep_scene.hpp"

namespace hb {

class MapLines {
 public:
  // Keeps references to all but the settings.
  MapLines(const SceneFamily& family, const PlaneAxis& x_axis, const std::vector<double>& x, const PlaneAxis& y_axis,
           const std::vector<double>& y, Settings settings, double speed)
      : family_(family),
        settings_(std::move(settings)),
        speed_(speed),
        columns_(y_axis.role != PlaneAxis::Role::scene_number),
        along_(columns_ ? y_axis : x_axis),
        fixed_(columns_ ? x_axis : y_axis),
        values_(columns_ ? y : x),
        lines_(columns_ ? x : y) {}

  std::size_t count() const { return lines_.size(); }
  const std::vector<double>& values() const { return values_; }
  // Of the i-th value on the k-th line.
  std::size_t x_index(std::size_t k, std::size_t i) const { return columns_ ? k : i; }
  std::size_t y_index(std::size_t k, std::size_t i) const { return columns_ ? i : k; }
  // Throws SceneError where there is none along the line.
  SweepScene scene(std::size_t k) const {
    const Axis::Kind kind = along_.role == PlaneAxis::Role::rpm     ? Axis::Kind::rpm
                            : along_.role == PlaneAxis::Role::omega ? Axis::Kind::omega
                                                                    : Axis::Kind::parameter;
    return {family_.with({{fixed_.path, lines_[k]}}), settings_, {kind, along_.path, values_}, speed_, 0};
  }

 private:
  const SceneFamily& family_;
  Settings settings_;
  double speed_;
  bool columns_;  // along the speed the linkage is the same
  const PlaneAxis &along_, &fixed_;
  const std::vector<double>&values_, &lines_;
};

}  // namespace hb
