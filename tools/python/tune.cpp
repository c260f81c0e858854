#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/command/asked_tune.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/results.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// A number, or a text, as the command line has it: all digits.
std::string word(const std::string& field, py::handle object) {
  if (py::isinstance<py::str>(object)) return text(field, object);
  if (!PyBool_Check(object.ptr()) && PyLong_Check(object.ptr())) return py::str(object).cast<std::string>();
  return fmt::format("{}", number(field, object));
}

// {path: (from, to)} or a list of "PATH=FROM:TO".
std::vector<std::string> bounds(const std::string& field, const py::object& object) {
  if (!py::isinstance<py::dict>(object))
    return py::isinstance<py::str>(object) ? std::vector{text(field, object)} : texts(field, object);
  std::vector<std::string> words;
  for (const auto& [path, range] : py::reinterpret_borrow<py::dict>(object)) {
    const std::string name = text(field, path);
    if (!py::isinstance<py::sequence>(range) || py::isinstance<py::str>(range) || py::len(range) != 2)
      throw RequestError(field + " " + name, shown(range), "a pair (from, to)");
    const auto pair = py::reinterpret_borrow<py::sequence>(range);
    words.push_back(fmt::format("{}={}:{}", name, word(field + " " + name, py::object(pair[0])),
                                word(field + " " + name, py::object(pair[1]))));
  }
  return words;
}

// {path: value} with a number, a text or a pair (factor, path); or a list of "PATH=VALUE".
std::vector<std::string> assignments(const std::string& field, const py::object& object) {
  if (!py::isinstance<py::dict>(object))
    return py::isinstance<py::str>(object) ? std::vector{text(field, object)} : texts(field, object);
  std::vector<std::string> words;
  for (const auto& [path, value] : py::reinterpret_borrow<py::dict>(object)) {
    const std::string name = text(field, path);
    if (py::isinstance<py::tuple>(value) && py::len(value) == 2) {
      const auto pair = py::reinterpret_borrow<py::tuple>(value);
      words.push_back(fmt::format("{}={}*{}", name, word(field, pair[0]), text(field, pair[1])));
    } else {
      words.push_back(name + "=" + word(field, value));
    }
  }
  return words;
}

// Conditions are texts with commas of their own: a list, or one.
std::vector<std::string> conditions(const py::object& object) {
  if (py::isinstance<py::str>(object)) return {text("keep", object)};
  return texts("keep", object);
}

// "rpm=300:3000", or a pair (300, 3000) of rpm.
std::string span(const py::object& object) {
  if (py::isinstance<py::str>(object)) return text("over", object);
  if (!py::isinstance<py::sequence>(object) || py::len(object) != 2)
    throw RequestError("over", shown(object), "a pair (from, to) in rpm, or \"omega=FROM:TO\"");
  const auto pair = py::reinterpret_borrow<py::sequence>(object);
  return fmt::format("rpm={}:{}", word("over", py::object(pair[0])), word("over", py::object(pair[1])));
}

std::string names(const std::vector<std::string>& list) { return fmt::format("{}", fmt::join(list, ",")); }

tools::TuneFlags read_flags(const py::dict& arguments) {
  tools::TuneFlags flags;
  const auto words = [&](const char* field, std::string& flag) {
    if (const auto value = given(arguments, field)) flag = word(field, *value);
  };
  words("minimise", flags.minimise);
  words("maximise", flags.maximise);
  words("modes", flags.modes);
  words("tol", flags.tolerance);
  words("algorithm", flags.algorithm);
  words("seed", flags.seed);
  words("analyses", flags.analyses);
  words("speeds", flags.speeds);
  words("rpm", flags.rpm);
  words("omega", flags.omega);
  if (const auto rods = given(arguments, "rods")) flags.rods = names(texts("rods", *rods));
  if (const auto vary = given(arguments, "vary")) flags.vary = bounds("vary", *vary);
  if (const auto tie = given(arguments, "tie")) flags.tie = assignments("tie", *tie);
  if (const auto height = given(arguments, "height")) flags.height = assignments("height", *height);
  if (const auto keep = given(arguments, "keep")) flags.keep = conditions(*keep);
  if (const auto over = given(arguments, "over")) flags.over = span(*over);
  return flags;
}

std::shared_ptr<TuneCore> tuned(const SceneCore& core, const py::dict& arguments, const py::object& progress) {
  const tools::TuneFlags flags = read_flags(arguments);
  PythonWork work(arguments, py::none());
  return work.run([&] {
    tools::AskedTune asked = tools::asked_tune(flags, {core.name, core.text, core.folder, core.source});
    auto result = std::make_shared<TuneCore>(
        TuneCore{std::move(asked.source), std::move(asked.task), std::move(asked.scene), {}, asked.remarks});
    const int most = result->task.options.max_evaluations;
    const double sign = flags.maximise.empty() ? 1 : -1;
    result->task.options.progress = [&](int evaluations, bool feasible, double goal) {
      if (work.stopped()) throw Stopped();
      work.tell(progress, fmt::format("tune, best {}{:.6g}", feasible ? "" : "(conditions not met) ", sign * goal),
                static_cast<std::size_t>(evaluations), static_cast<std::size_t>(most));
    };
    result->task.options.stop = [&] { return work.late(); };
    try {
      result->result = tune(result->task, work);
    } catch (const RequestError&) {  // no design yet
      if (!work.late()) throw;
      throw Stopped();
    }
    result->task.options.progress = {};
    result->task.options.stop = {};
    result->task.settings.modes = result->result.num_modes;
    return result;
  });
}

std::string scene_text(const TuneCore& core, const std::string& name, const std::string& folder) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  return tools::tuned_scene(core.source, core.task, core.result, core.before.units,
                            place / std::filesystem::path(name).filename(), place);
}

}  // namespace

void add_tune(py::module_& module) {
  py::class_<TuneCore, std::shared_ptr<TuneCore>>(module, "Tune")
      .def("json",
           [](const TuneCore& core) {
             return decoded(tools::json_text(tools::tune_json(core.task, core.result, core.before, false)));
           })
      .def("words",
           [](const TuneCore& core) { return decoded(tools::tune_table(core.task, core.result, core.before)); })
      .def("table", [](const TuneCore& core) { return table_of(tools::history_csv(core.task, core.result)); })
      .def("scene_text", [](const TuneCore& core, const std::string& name,
                            const std::string& folder) { return decoded(scene_text(core, name, folder)); })
      .def_property_readonly("shortfall", [](const TuneCore& core) { return decoded(tools::shortfall(core.result)); })
      .def_property_readonly("remarks", [](const TuneCore& core) { return decoded(core.remarks); });
  module.def("tune", &tuned, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
