#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tools/output/branches_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/sweep_bands.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/results.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// What the sweep goes along: `x`, or a range of rpm or omega, or the scene's own.
Along axis_of(const SceneCore& core, const py::dict& arguments, Request& request) {
  if (const auto x = given(arguments, "x")) {
    const NamedValues named = named_values("x", *x, Third::step, core.source);
    if (const auto rpm = given(arguments, "rpm")) request.rpm = number("rpm", *rpm);
    if (const auto omega = given(arguments, "omega")) request.omega = number("omega", *omega);
    return {named.path, named.values};
  }
  const auto rpm = given(arguments, "rpm"), omega = given(arguments, "omega");
  if (rpm && omega) throw RequestError("omega", shown(*omega) + " beside rpm = " + shown(*rpm), "one of the two");
  if (rpm) return {"rpm", range_values("rpm", *rpm, Third::step)};
  if (omega) return {"omega", range_values("omega", *omega, Third::step)};
  const AnalysisDefaults& defaults = core.scene.analysis;
  const char* name = defaults.rpm || !defaults.omega ? "rpm" : "omega";
  const std::optional<Speeds>& speeds = defaults.rpm ? defaults.rpm : defaults.omega;
  if (!speeds || !(speeds->from < speeds->to))
    throw RequestError(name, speeds ? fmt::format("the scene's single speed {}", speeds->from) : "no speed",
                       "a range (from, to, step)");
  return {name, range_values(name, py::make_tuple(speeds->from, speeds->to, speeds->step), Third::step)};
}

std::shared_ptr<SweepCore> swept(const SceneCore& core, const py::dict& written, const py::object& progress) {
  const py::dict arguments = plain_speeds(written, core.scene.units);
  py::dict rest = arguments.attr("copy")();
  rest["rpm"] = py::none();
  rest["omega"] = py::none();
  SweepRequest request;
  static_cast<Request&>(request) = read_request(rest);
  request.x = axis_of(core, arguments, request);
  const std::optional<int> turns = read_turns(arguments);
  const std::vector<BandRequest> bands = read_bands(arguments);
  if (turns && !bands.empty())
    throw RequestError("band", "beside theory = \"nonlinear\"", "band with the linear theory");
  PythonWork work(arguments, progress);
  return work.run([&] {
    if (!turns) {
      auto answer = std::make_shared<SweepCore>(SweepCore{sweep(core.source, request, work), std::nullopt});
      if (!bands.empty()) answer->bands = sweep_bands(core.source, request, bands, work);
      return answer;
    }
    NonlinearSweepOptions options;
    options.turns = *turns;
    options.stop = work.stop();
    NonlinearAlong found = nonlinear_sweep(core.source, request, options, work);
    if (work.stopped()) throw Stopped();
    if (found.branches.stopped) work.say_time_limit(found.branches.shortfalls);
    return std::make_shared<SweepCore>(SweepCore{std::move(found.linear), std::move(found.branches)});
  });
}

std::string json(const SweepCore& core) {
  nlohmann::ordered_json document = tools::sweep_json(*core.linear.scene, core.linear, false);
  if (!core.bands.empty()) document["bands"] = tools::sweep_bands_json(document, core.bands);
  if (core.branches) tools::add_branches(document, *core.linear.scene, *core.branches);
  return tools::json_text(document);
}

std::string words(const SweepCore& core) {
  std::string table = tools::sweep_table(*core.linear.scene, core.linear);
  if (!core.bands.empty()) {
    const nlohmann::ordered_json document = tools::sweep_json(*core.linear.scene, core.linear, false);
    table += tools::sweep_bands_table(document, tools::sweep_bands_json(document, core.bands));
  }
  if (core.branches) table += tools::branches_table(*core.linear.scene, *core.branches);
  return table;
}

std::size_t rod_place(const SweepCore& core, const std::string& name) {
  const std::vector<SweepRod>& rods = core.linear.rods;
  for (std::size_t r = 0; r < rods.size(); ++r)
    if (rods[r].name == name && rods[r].reported) return r;
  throw py::key_error(name);
}

py::dict columns_of(const SweepCore& core, const std::string& rod) {
  const tools::SweepColumns at = tools::sweep_columns(*core.linear.scene, core.linear, rod_place(core, rod));
  py::dict columns;
  columns["first_peak"] = at.first_peak;
  columns["deflection"] = at.deflection;
  columns["beyond"] = at.beyond;
  columns["growth"] = at.growth;
  columns["first_frequency"] = at.first_frequency;
  return columns;
}

}  // namespace

void add_sweep(py::module_& module) {
  py::class_<SweepCore, std::shared_ptr<SweepCore>>(module, "Sweep")
      .def("json", [](const SweepCore& core) { return decoded(json(core)); })
      .def("words", [](const SweepCore& core) { return decoded(words(core)); })
      .def_property_readonly("shortfalls",
                             [](const SweepCore& core) {
                               std::vector<std::string> all = core.linear.shortfalls;
                               if (core.branches)
                                 all.insert(all.end(), core.branches->shortfalls.begin(),
                                            core.branches->shortfalls.end());
                               return decoded(all);
                             })
      .def("rod_table",
           [](const SweepCore& core, const std::string& rod) {
             return table_of(tools::sweep_rod_csv(*core.linear.scene, core.linear, rod_place(core, rod)));
           })
      .def("forces_table",
           [](const SweepCore& core) { return table_of(tools::sweep_forces_csv(*core.linear.scene, core.linear)); })
      .def("columns", &columns_of)
      .def("axis_label", [](const SweepCore& core) { return decoded(tools::axis_label(*core.linear.scene)); });
  module.def("sweep", &swept, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
