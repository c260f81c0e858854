#include "hb/analysis/sweep/sweep_scene.hpp"

#include <algorithm>
#include <atomic>

#include "hb/analysis/range_warnings.hpp"

namespace hb {
namespace {

// Addresses come back, these do not.
std::size_t next_id() {
  static std::atomic<std::size_t> next = 1;
  return next++;
}

// The error of the cut is looked at where shapes or joint forces are asked for: these need finer Ritz matrices.
std::shared_ptr<SceneModel> sweep_model(Scene scene, const Settings& settings) {
  auto model = std::make_shared<SceneModel>(make_model(std::move(scene), settings, false));
  if (!model->linkage()) return model;
  for (RodModel& rod : model->rods)
    if (settings.only.reactions || (settings.only.shape && rod.reported))
      rod.finer = ritz_system(*body_at(*model->linkage(), rod.link),
                              model->coefficients.rods[static_cast<std::size_t>(rod.coefficients)],
                              comparison_modes(rod.num_modes));
  return model;
}

}  // namespace

SweepScene::SweepScene(SceneFamily family, Settings settings, Axis axis, double fixed_speed, double fixed_rpm)
    : family_(std::move(family)),
      settings_(std::move(settings)),
      axis_(std::move(axis)),
      fixed_speed_(fixed_speed),
      fixed_rpm_(fixed_rpm),
      id_(next_id()) {
  const bool auto_modes = is_auto(settings_.modes);
  if (axis_.kind != Axis::Kind::parameter) {
    Scene scene = family_.scene();
    units_ = scene.units;
    first_ = sweep_model(std::move(scene), settings_);
  } else {
    for (std::size_t k = 0; k < axis_.values.size() && !first_; ++k) {
      try {
        Scene scene = family_.scene({{axis_.path, axis_.values[k]}});
        units_ = scene.units;
        first_ = sweep_model(std::move(scene), settings_);
      } catch (const ObstructedLinkage&) {
        if (k + 1 == axis_.values.size()) throw;
      }
    }
  }
  if (auto_modes) {
    // As many as the ends and the middle of the sweep need.
    Settings steady = settings_;
    steady.only = {true, false, false, false};
    int modes = 1;
    const std::vector<double>& values = axis_.values;
    for (const double x : {values.front(), values[values.size() / 2], values.back()}) {
      const ScenePlace place = at(x);
      if (!place.model) continue;
      modes = most_modes(analyse(*place.model, place.speed, steady).rods, modes);
    }
    settings_.modes = modes;
    id_ = next_id();  // places looked at so far have other models
    first_ = sweep_model(first_->scene, settings_);
  }
}

double SweepScene::speed_at(double x) const {
  switch (axis_.kind) {
    case Axis::Kind::rpm:
      return speed_from_rpm(x, units_);
    case Axis::Kind::omega:
      return x;
    case Axis::Kind::parameter:
      break;
  }
  return fixed_speed_;
}

LinkagePlace SweepScene::linkage_at(double x) const {
  if (axis_.kind != Axis::Kind::parameter) return {*first_->linkage(), ""};
  FamilyMember member = family_.at({{axis_.path, x}});
  if (!member.scene) return {std::nullopt, std::move(member.why_not)};
  return {std::get<Linkage>(std::move(member.scene->model)), ""};
}

std::vector<std::string> SweepScene::warnings() const {
  if (axis_.kind != Axis::Kind::parameter) return scene().warnings;
  const Along along{axis_.path, axis_.values};
  return range_warnings(family_, {&along});
}

ScenePlace SweepScene::at(double x) const {
  if (axis_.kind != Axis::Kind::parameter) return {first_, speed_at(x), ""};
  // Several questions are asked at one place in a row.
  struct Last {
    std::size_t owner = 0;
    double x = 0;
    ScenePlace place;
  };
  static thread_local Last last;
  if (last.owner == id_ && last.x == x) return last.place;
  ScenePlace place{nullptr, fixed_speed_, ""};
  try {
    place.model = sweep_model(family_.scene({{axis_.path, x}}), settings_);
  } catch (const ObstructedLinkage& obstruction) {
    place.problem = obstruction.what();
  }
  last = {id_, x, place};
  return place;
}

}  // namespace hb
