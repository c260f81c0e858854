// What may be measured along a sweep.
#include <fmt/core.h>

#include <algorithm>

#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/pictures/sweep_frame.hpp"

namespace hb::tools {

std::vector<MeasuredQuantity> measured_quantities(const SweepScene& scene) {
  const SceneModel& model = scene.first();
  const OutputUnits units = output_units(model.scene);
  const Only only = available(model, scene.settings().only);
  std::vector<MeasuredQuantity> list;
  for (const RodModel& rod : model.rods) {
    if (!rod.reported) continue;
    if (only.shape) {
      list.push_back({"deflection " + rod.name, units.length});
      list.push_back({"bending moment " + rod.name, "N m"});
      if (body_at(*model.linkage(), rod.link)->elastic->section_height > 0)
        list.push_back({"stress " + rod.name, "MPa"});
    }
    if (only.stability) {
      list.push_back({"frequency " + rod.name, frequency_unit(model.scene).name});
      list.push_back({"growth rate " + rod.name, units.rate});
    }
    for (Eigen::Index i = 1; only.steady && i <= std::min<Eigen::Index>(rod.num_modes, max_curves); ++i)
      list.push_back({fmt::format("q_{} {}", i, rod.name), units.response});
  }
  if (!only.reactions) return list;
  for (const JointForce& joint : joint_forces(*model.linkage(), 1, {}).joints)
    for (Eigen::Index c = 0; c < joint.rigid.num_components(); ++c)
      list.push_back({joint.name + (joint.rigid.num_components() == 1 ? " n" : c == 0 ? " x" : " y"), "N"});
  list.push_back({"torque", "N m"});
  return list;
}

MeasuredQuantity measured_axis(const SweepScene& scene) {
  switch (scene.axis().kind) {
    case Axis::Kind::rpm:
      return {"speed", "rpm"};
    case Axis::Kind::omega:
      return {"omega", "rad/" + scene.scene().units.time};
    case Axis::Kind::parameter:
      break;
  }
  return {scene.axis().path, path_unit(scene.axis().path, scene.scene().units)};
}

}  // namespace hb::tools
