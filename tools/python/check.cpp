#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "hb/analysis/analyses.hpp"
#include "tools/output/check_json.hpp"
#include "tools/output/check_report.hpp"
#include "tools/output/json_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

Integrator read_integrator(py::handle object) {
  const std::string name = text("integrator", object);
  for (const Integrator integrator :
       {Integrator::automatic, Integrator::adams, Integrator::bdf, Integrator::collocation})
    if (name == to_string(integrator)) return integrator;
  throw RequestError("integrator", "\"" + name + "\"", "automatic, adams, bdf, collocation");
}

// A range of speeds, or the scene's; nothing where it is one speed.
std::vector<double> several(const char* field, const std::optional<py::object>& asked,
                            const std::optional<Speeds>& scene) {
  if (asked && !PyFloat_Check(asked->ptr()) && !PyLong_Check(asked->ptr()) &&
      PyObject_HasAttrString(asked->ptr(), "__len__"))
    return range_values(field, *asked, Third::step);
  if (asked || !scene || !(scene->from < scene->to)) return {};
  return range_values(field, py::make_tuple(scene->from, scene->to, scene->step), Third::step);
}

std::shared_ptr<Check> checked(const SceneCore& core, const py::dict& arguments, const py::object& progress) {
  py::dict rest = arguments.attr("copy")();
  const auto rpm = given(arguments, "rpm"), omega = given(arguments, "omega");
  if (rpm && omega) throw RequestError("omega", shown(*omega) + " beside rpm = " + shown(*rpm), "one of the two");
  std::vector<double> rpms, omegas;
  if (!omega) rpms = several("rpm", rpm, core.scene.analysis.rpm);
  if (!rpm) omegas = several("omega", omega, core.scene.analysis.omega);
  if (!rpms.empty()) rest["rpm"] = py::none();
  if (!omegas.empty()) rest["omega"] = py::none();
  CheckRequest request;
  static_cast<Request&>(request) = read_request(rest);
  request.rpms = std::move(rpms);
  request.omegas = std::move(omegas);
  if (const auto integrator = given(arguments, "integrator")) request.integrator = read_integrator(*integrator);
  if (const auto limit = given(arguments, "case_limit")) request.case_limit = number("case_limit", *limit);
  if (const auto march = given(arguments, "march")) request.march = py::bool_(*march);
  PythonWork work(read_threads(arguments), progress);
  return work.run([&] { return std::make_shared<Check>(check(core.scene, request, work)); });
}

}  // namespace

void add_check(py::module_& module) {
  py::class_<Check, std::shared_ptr<Check>>(module, "Check")
      .def_property_readonly("agrees", &Check::agrees)
      .def_property_readonly("shortfalls",
                             [](const Check& check) {
                               py::list sentences;
                               for (const SpeedCheck& speed : check.speeds)
                                 for (const std::string& sentence : speed.shortfalls) sentences.append(decoded(sentence));
                               return sentences;
                             })
      .def("json",
           [](const Check& check) {
             return decoded(tools::json_text(tools::check_json(*check.model, check.speeds, check.settings)));
           })
      .def("words", [](const Check& check) {
        return decoded(tools::check_report(*check.model, check.speeds, check.settings, false));
      });
  module.def("check", &checked, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
