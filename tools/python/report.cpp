#include <nlohmann/json.hpp>

#include "tools/command/result_files.hpp"
#include "tools/output/band_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/map_output.hpp"
#include "tools/output/output_file.hpp"
#include "tools/output/sweep_bands.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/results.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/steady.hpp"
#include "tools/report/design_page.hpp"
#include "tools/report/report_data.hpp"

namespace hb::python {
namespace {

using namespace tools;

// Writes the page that `page` gives, whole or not at all.
void write_page(const std::string& file, PythonWork& work, const std::function<std::string()>& page) {
  if (const std::string obstacle = report_obstacle(); !obstacle.empty()) throw RequestError("report", obstacle, "");
  work.run([&] {
    OutputFile place(file, "report");
    place.commit(page());
    return true;
  });
}

void steady_report(const SceneCore& core, const Answer& answer, const std::string& file, const std::string& call) {
  PythonWork work;
  write_page(file, work, [&] {
    ReportData data(answer.model->scene);
    if (answer.nonlinear)
      data.add_speed(nonlinear_place(answer.model, *answer.nonlinear, answer.settings), answer.settings);
    else
      data.add_speed({answer.model, answer.result, "", {}}, answer.settings);
    if (!answer.bands.empty())
      data.add_bands(bands_json(steady_json(*answer.model, answer.result, answer.settings, false), answer.bands));
    return data.page(page_text(core.provenance(call), {}));
  });
}

// A sweep, and beside it a map where one is given.
void sweep_report(const SceneCore& core, const SweepCore& swept, const Map* map, const std::string& file,
                  const std::string& call, bool pictures, int threads) {
  const Sweep& sweep = swept.linear;
  PythonWork work(threads);
  write_page(file, work, [&] {
    ReportData data(core.scene);
    const NonlinearSweep* branches = swept.branches ? &*swept.branches : nullptr;
    data.add_sweep(*sweep.scene, sweep, places_along(*sweep.scene, work, branches), branches);
    if (!swept.bands.empty()) {
      nlohmann::ordered_json table = sweep_json(*sweep.scene, sweep, false);
      table["bands"] = sweep_bands_json(table, swept.bands);
      data.add_sweep_bands(table);
    }
    std::optional<MapDocument> document;
    if (map != nullptr) {
      document.emplace(document_of(*map));
      data.add_map(map_json(*document), core.source);
    }
    std::vector<PageText::Picture> still;
    if (pictures) still = report_pictures(*sweep.scene, sweep, branches, document ? &*document : nullptr);
    return data.page(page_text(core.provenance(call), std::move(still)));
  });
}

void map_report(const SceneCore& core, const Map& map, const std::string& file, const std::string& call) {
  PythonWork work;
  write_page(file, work, [&] {
    ReportData data(map.scene);
    data.add_map(map_json(document_of(map)), core.source);
    return data.page(page_text(core.provenance(call), {}));
  });
}

void tune_report(const SceneCore& core, const TuneCore& tune, const std::string& file, const std::string& call) {
  PythonWork work;
  write_page(file, work, [&] {
    return design_page(tune.task, tune.result, tune.before, tune_json(tune.task, tune.result, tune.before, false), work,
                       page_text(core.provenance(call), {}));
  });
}

}  // namespace

void add_report(py::module_& module) {
  module.def("steady_report", &steady_report, py::arg("scene"), py::arg("answer"), py::arg("file"), py::arg("call"));
  module.def("sweep_report", &sweep_report, py::arg("scene"), py::arg("sweep"), py::arg("map").none(true),
             py::arg("file"), py::arg("call"), py::arg("pictures"), py::arg("threads"));
  module.def("map_report", &map_report, py::arg("scene"), py::arg("map"), py::arg("file"), py::arg("call"));
  module.def("tune_report", &tune_report, py::arg("scene"), py::arg("tune"), py::arg("file"), py::arg("call"));
}

}  // namespace hb::python
