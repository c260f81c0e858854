#include "tools/work/sweep_key.hpp"

#include <array>
#include <complex>

#include "tools/work/checkpoint.hpp"

namespace hb::tools {
namespace {

void add(TaskKey& key, const std::array<FourierSeries, 3>& powers) {
  for (const FourierSeries& series : powers) {
    key.add(static_cast<double>(series.c.rows())).add(static_cast<double>(series.c.cols()));
    for (const std::complex<double> c : series.c.reshaped()) key.add(c.real()).add(c.imag());
  }
}

}  // namespace

std::uint64_t sweep_key(const SweepScene& scene) {
  TaskKey key;
  const Settings& settings = scene.settings();
  key.add("sweep").add(scene.axis().path);
  for (const double x : scene.axis().values) key.add(x);
  key.add(static_cast<double>(std::get<int>(settings.modes))).add(settings.tolerance);
  key.add(settings.only.steady).add(settings.only.stability).add(settings.only.reactions).add(settings.only.shape);
  key.add(settings.only.growth).add(settings.only.verdict).add(settings.search);
  for (const std::string& rod : settings.rods) key.add(rod);
  key.add(static_cast<double>(settings.steady_method)).add(static_cast<double>(settings.stability_method));
  // Numbers of the scene by what they lead to, at both ends of the axis; files that the scene names are in them.
  for (const double x : {scene.axis().values.front(), scene.axis().values.back()}) {
    const ScenePlace place = scene.at(x);
    key.add(place.speed);
    if (!place.model) continue;
    for (const RodModel& rod : place.model->rods) {
      key.add(rod.name);
      for (const double value : rod.system.mass.reshaped()) key.add(value);
      for (const double value : rod.system.damping.reshaped()) key.add(value);
      add(key, rod.system.stiffness);
      add(key, rod.system.load);
    }
    if (const Linkage* linkage = place.model->linkage()) {
      // What stresses and the flywheel are judged by does not reach the rods.
      const Body& crank = linkage->crank.body;
      key.add(crank.inertia + crank.mass * std::norm(crank.com));
      for (const RodModel& rod : place.model->rods) {
        const Elastic& elastic = *body_at(*linkage, rod.link)->elastic;
        key.add(elastic.section_height).add(elastic.strength.yield).add(elastic.strength.tensile);
        key.add(elastic.strength.endurance);
      }
    }
    if (settings.only.reactions && place.model->linkage()) {
      // Masses of rigid links do not reach the rods.
      const JointForces forces = joint_forces(*place.model->linkage(), place.speed, {});
      for (const std::complex<double> c : forces.torque_rigid.c.reshaped()) key.add(c.real()).add(c.imag());
    }
  }
  return key.value();
}

}  // namespace hb::tools
