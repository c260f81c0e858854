#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "tools/output/check_json.hpp"
#include "tools/output/check_report.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_check_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// By one of the two theories.
struct CheckCore {
  std::optional<Check> linear;
  std::optional<NonlinearChecks> nonlinear;
};

Integrator read_integrator(py::handle object) {
  const std::string name = text("integrator", object);
  const std::vector<std::pair<const char*, Integrator>> known = {{"automatic", Integrator::automatic},
                                                                 {"adams", Integrator::adams},
                                                                 {"bdf", Integrator::bdf},
                                                                 {"collocation", Integrator::collocation}};
  for (const auto& [word, integrator] : known)
    if (name == word) return integrator;
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

std::shared_ptr<CheckCore> checked(const SceneCore& core, const py::dict& written, const py::object& progress) {
  const py::dict arguments = plain_speeds(written, core.scene.units);
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
  const std::optional<int> turns = read_turns(arguments);
  PythonWork work(arguments, progress);
  return work.run([&] {
    auto result = std::make_shared<CheckCore>();
    if (!turns) {
      result->linear = check(core.scene, request, work);
      if (result->linear->speeds.empty()) throw Stopped();
      return result;
    }
    NonlinearOptions options;
    options.turns = *turns;
    options.stop = work.stop();
    result->nonlinear = nonlinear_check(core.scene, request, options, work);
    if (work.stopped()) throw Stopped();
    for (NonlinearCheck& check : result->nonlinear->speeds)
      if (!check.not_compared.empty()) work.say_time_limit(check.shortfalls);
    return result;
  });
}

std::string json(const CheckCore& core) {
  if (core.linear) return tools::json_text(tools::check_json(*core.linear));
  const NonlinearChecks& found = *core.nonlinear;
  return tools::json_text(tools::nonlinear_check_json(*found.model, found.speeds, found.settings));
}

std::string words(const CheckCore& core) {
  if (core.linear) return tools::check_report(*core.linear, false);
  const NonlinearChecks& found = *core.nonlinear;
  return tools::nonlinear_check_report(*found.model, found.speeds, found.settings);
}

template <class Checks>
py::list shortfalls(const Checks& speeds) {
  py::list sentences;
  for (const auto& speed : speeds)
    for (const std::string& sentence : speed.shortfalls) sentences.append(decoded(sentence));
  return sentences;
}

}  // namespace

void add_check(py::module_& module) {
  py::class_<CheckCore, std::shared_ptr<CheckCore>>(module, "Check")
      .def_property_readonly(
          "agrees",
          [](const CheckCore& core) { return core.linear ? core.linear->agrees() : core.nonlinear->agrees(); })
      .def_property_readonly("shortfalls",
                             [](const CheckCore& core) {
                               return core.linear ? shortfalls(core.linear->speeds)
                                                  : shortfalls(core.nonlinear->speeds);
                             })
      .def("json", [](const CheckCore& core) { return decoded(json(core)); })
      .def("words", [](const CheckCore& core) { return decoded(words(core)); });
  module.def("check", &checked, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
