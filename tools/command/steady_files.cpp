#include "tools/command/steady_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "tools/output/csv_output.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/pictures/bent_mechanism_figure.hpp"
#include "tools/pictures/figures.hpp"

namespace hb::tools {

std::vector<MeasuredQuantity> measured_quantities(const SceneModel& model, const SpeedResult& result) {
  std::vector<MeasuredQuantity> list;
  const std::string unit = output_units(model.scene).response;
  for (const RodResult& rod : result.rods)
    for (Eigen::Index i = 1; rod.reported && result.computed.steady && i <= std::min(rod.num_modes, max_panels); ++i)
      list.push_back({fmt::format("q_{} {}", i, rod.name), unit});
  if (!result.forces) return list;
  for (const JointForce& joint : result.forces->joints)
    for (Eigen::Index c = 0; c < joint.rigid.num_components(); ++c)
      list.push_back({joint.name + (joint.rigid.num_components() == 1 ? " n" : c == 0 ? " x" : " y"), "N"});
  list.push_back({"torque", "N m"});
  return list;
}

std::vector<Figure> steady_files(const SceneModel& model, const SpeedResult& result, const MachineFiles& machine,
                                 OutputFolder& folder, const MeasuredOverlay& measured) {
  std::vector<Figure> figures;
  const auto write = [&](const CsvFile& file) { folder.write(file.name, csv_text(file)); };
  if (!measured.empty()) write(measured.csv());
  for (const RodResult& rod : result.rods) {
    if (!rod.reported) continue;
    const bool solved = rod.steady && rod.steady->status != SteadyStatus::singular;
    if (solved && result.computed.steady) {
      const CsvFile response = response_csv(model, result, rod), spectrum = fourier_csv(model, result, rod);
      write(response);
      write(spectrum);
      figures.push_back(response_figure(model, result, rod, response.name, measured));
      figures.push_back(phase_figure(model, result, rod, response.name));
      figures.push_back(spectrum_figure(model, result, rod, spectrum.name));
    }
    if (rod.shape) {
      const CsvFile deflection = deflection_csv(model, result, rod), moment = bending_moment_csv(model, result, rod);
      write(deflection);
      write(moment);
      figures.push_back(shape_figure(model, result, rod, deflection, false));
      figures.push_back(shape_figure(model, result, rod, moment, true));
    }
    const auto place = static_cast<std::size_t>(&rod - result.rods.data());
    if (const std::optional<StressEnvelope>& envelope = machine.envelopes[place]) {
      const CsvFile stress = stress_csv(model.scene, result.speed, rod.name, *envelope);
      write(stress);
      figures.push_back(stress_figure(model, result, rod, stress.name));
    }
    if (rod.stability) write(exponents_csv(model, result, rod));
  }
  if (result.forces) {
    const CsvFile forces = forces_csv(model, result), torque = torque_csv(model, result);
    write(forces);
    write(torque);
    for (Figure& figure : force_figures(model, result, forces.name, measured)) figures.push_back(std::move(figure));
    for (Figure& figure : polar_figures(model, result, forces.name)) figures.push_back(std::move(figure));
    figures.push_back(torque_figure(model, result, torque.name, measured));
    if (machine.frame) write(frame_csv(model.scene, result.speed, *machine.frame));
    for (const CsvFile& slider : slider_csvs(model.scene, result.speed, machine.sliders)) write(slider);
  }
  if (model.linkage()) {
    const CsvFile mechanism = mechanism_csv(model.scene);
    write(mechanism);
    figures.push_back(mechanism_figure(model.scene, mechanism));
    if (const std::optional<BentMechanism> bent = bent_mechanism(model, result)) {
      write(bent->csv);
      figures.push_back(bent_mechanism_figure(model, result, *bent));
    }
  }
  return figures;
}

}  // namespace hb::tools
