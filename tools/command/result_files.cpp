#include "tools/command/result_files.hpp"

#include <fmt/core.h>

#include "tools/output/branches_output.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/map_loads_output.hpp"
#include "tools/output/map_theory_output.hpp"
#include "tools/output/sweep_machine.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_theory.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/pictures/branch_figure.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/report/page_pictures.hpp"

namespace hb::tools {

std::vector<Figure> sweep_files(const SweepScene& scene, const SweepResult& result, OutputFolder& folder,
                                const MeasuredOverlay& measured) {
  std::vector<Figure> figures;
  if (!measured.empty()) folder.write(measured.csv().name, csv_text(measured.csv()));
  const Only& only = result.computed;
  const CsvFile critical = critical_csv(scene, result);
  if (only.steady) folder.write(critical.name, csv_text(critical));
  if (only.stability) {
    if (result.searched_bands) {
      const CsvFile bands = bands_csv(scene, result);
      folder.write(bands.name, csv_text(bands));
      const CsvFile not_excluded = not_excluded_csv(scene, result);
      folder.write(not_excluded.name, csv_text(not_excluded));
    }
    const CsvFile verdicts = sweep_verdict_csv(scene, result);
    folder.write(verdicts.name, csv_text(verdicts));
    figures.push_back(sweep_verdict_figure(scene, result, verdicts));
  }
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    if (!result.rods[r].reported || !(only.steady || only.stability || only.shape)) continue;
    const CsvFile rod = sweep_rod_csv(scene, result, r);
    folder.write(rod.name, csv_text(rod));
    if (only.stability) {
      figures.push_back(campbell_figure(scene, result, r, rod, critical.name, measured));
      figures.push_back(growth_figure(scene, result, r, rod, measured));
    }
    if (only.steady) figures.push_back(peaks_figure(scene, result, r, rod, measured));
    if (only.shape) figures.push_back(strain_figure(scene, result, r, rod, measured));
  }
  if (only.reactions) {
    const CsvFile forces = sweep_forces_csv(scene, result);
    folder.write(forces.name, csv_text(forces));
    const CsvFile machine = sweep_machine_csv(scene, result);
    folder.write(machine.name, csv_text(machine));
    for (Figure& figure : sweep_force_figures(scene, result, forces, measured)) figures.push_back(std::move(figure));
  }
  if (has_theory(scene, result)) {
    const CsvFile theory = sweep_theory_csv(scene, result);
    folder.write(theory.name, csv_text(theory));
  }
  for (Figure& figure : figures) figure.x_label = quoted(axis_label(scene));
  return figures;
}

std::vector<Figure> branch_files(const SweepScene& scene, const SweepResult& linear, const NonlinearSweep& sweep,
                                 OutputFolder& folder, const MeasuredOverlay& measured) {
  std::vector<Figure> figures;
  const CsvFile bifurcations = bifurcations_csv(scene, sweep);
  folder.write(bifurcations.name, csv_text(bifurcations));
  if (!sweep.joints.empty()) {
    const CsvFile machine = branches_machine_csv(scene, sweep);
    folder.write(machine.name, csv_text(machine));
  }
  for (std::size_t r = 0; r < sweep.rods.size() && !sweep.branches.empty(); ++r) {
    if (!sweep.reported[r]) continue;
    const CsvFile branches = branches_csv(scene, sweep, r);
    folder.write(branches.name, csv_text(branches));
    figures.push_back(branch_figure(scene, linear, sweep, r, sweep_rod_csv(scene, linear, r), branches, measured));
  }
  return figures;
}

std::vector<Figure> map_files(const MapDocument& document, MapColour colour, OutputFolder& folder) {
  const MapResult& result = document.result;
  const auto write = [&](const CsvFile& file) {
    folder.write(file.name, csv_text(file));
    return file.name;
  };
  MapFiles files;
  files.grid = "map_grid.csv";
  folder.write_long(files.grid, [&](const TextSink& sink) { write_map_grid(document, sink); });
  if (document.boundaries)
    files.boundaries = write(map_boundary_csv(document, result.boundaries, "map_boundaries.csv",
                                              "boundaries of stability of the worst rod"));
  for (std::size_t r = 0; r < result.rods.size() && result.rods.size() > 1 && document.boundaries; ++r) {
    std::vector<RodCurve> own;
    for (const BoundaryCurve& curve : result.maps[r].boundaries) own.push_back({r, curve});
    write(map_boundary_csv(document, own, file_name("map_boundaries_" + result.rods[r]) + ".csv",
                           "boundaries of stability of " + result.rods[r]));
  }
  files.resonance = write(map_resonance_csv(document));
  if (!result.theory.empty()) files.theory = write(map_theory_csv(document));
  for (const BandEnd& end : result.band) {
    const char* parameter = to_string(result.band_of);
    files.band.push_back(write(map_boundary_csv(
        document, end.boundaries, file_name(fmt::format("map_boundaries_{}_{:g}", parameter, end.factor)) + ".csv",
        fmt::format("boundaries of stability of the worst rod with {} times {:g}", parameter, end.factor))));
  }
  std::vector<Figure> figures;
  if (!result.loads.empty()) files.loads = write(map_loads_csv(document));
  figures.push_back(map_figure(document, files, colour));
  for (Figure& figure : load_figures(document, files)) figures.push_back(std::move(figure));
  return figures;
}

std::vector<PageText::Picture> report_pictures(const SweepScene& scene, const SweepResult& result,
                                               const NonlinearSweep* branches, const MapDocument* map) {
  return page_pictures([&](OutputFolder& folder) {
    std::vector<Figure> figures = sweep_files(scene, result, folder);
    if (branches != nullptr)
      for (Figure& figure : branch_files(scene, result, *branches, folder)) figures.push_back(std::move(figure));
    if (scene.first().linkage() != nullptr) {
      const CsvFile mechanism = mechanism_csv(scene.scene());
      folder.write(mechanism.name, csv_text(mechanism));
      figures.push_back(mechanism_figure(scene.scene(), mechanism));
    }
    if (map != nullptr)
      for (Figure& figure : map_files(*map, MapColour::growth, folder)) figures.push_back(std::move(figure));
    return figures;
  });
}

}  // namespace hb::tools
