#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "hb/analysis/analyses.hpp"
#include "tools/output/json_output.hpp"
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
    const NamedValues named = named_values("x", *x, Third::step);
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

std::shared_ptr<Sweep> swept(const SceneCore& core, const py::dict& arguments, const py::object& progress) {
  py::dict rest = arguments.attr("copy")();
  rest["rpm"] = py::none();
  rest["omega"] = py::none();
  SweepRequest request;
  static_cast<Request&>(request) = read_request(rest);
  request.x = axis_of(core, arguments, request);
  if (request.only.verdict) throw RequestError("only", "\"verdict\"", "steady, stability, reactions, shape");
  PythonWork work(read_threads(arguments), progress);
  return work.run([&] { return std::make_shared<Sweep>(sweep(core.source, request, work)); });
}

std::size_t rod_place(const Sweep& sweep, const std::string& name) {
  for (std::size_t r = 0; r < sweep.rods.size(); ++r)
    if (sweep.rods[r].name == name && sweep.rods[r].reported) return r;
  throw py::key_error(name);
}

}  // namespace

void add_sweep(py::module_& module) {
  py::class_<Sweep, std::shared_ptr<Sweep>>(module, "Sweep")
      .def("json",
           [](const Sweep& sweep) { return decoded(tools::json_text(tools::sweep_json(*sweep.scene, sweep, false))); })
      .def("words", [](const Sweep& sweep) { return decoded(tools::sweep_table(*sweep.scene, sweep)); })
      .def("rod_table",
           [](const Sweep& sweep, const std::string& rod) {
             return table_of(tools::sweep_rod_csv(*sweep.scene, sweep, rod_place(sweep, rod)));
           })
      .def("forces_table",
           [](const Sweep& sweep) { return table_of(tools::sweep_forces_csv(*sweep.scene, sweep)); })
      .def("columns",
           [](const Sweep& sweep, const std::string& rod) {
             const tools::SweepColumns at = tools::sweep_columns(*sweep.scene, sweep, rod_place(sweep, rod));
             py::dict columns;
             columns["first_peak"] = at.first_peak;
             columns["deflection"] = at.deflection;
             columns["beyond"] = at.beyond;
             columns["growth"] = at.growth;
             columns["first_frequency"] = at.first_frequency;
             return columns;
           })
      .def("axis_label", [](const Sweep& sweep) { return decoded(tools::axis_label(*sweep.scene)); });
  module.def("sweep", &swept, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
