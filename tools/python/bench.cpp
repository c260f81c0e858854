#include "hb/analysis/bench.hpp"

#include <nlohmann/json.hpp>

#include "tools/output/bench_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// The memory in the document is that of the call's end.
struct BenchCore {
  Bench bench;
  std::string json;
};

std::shared_ptr<BenchCore> benched(const SceneCore& core, const py::dict& written, const py::object& progress) {
  const py::dict arguments = plain_speeds(written, core.scene.units);
  BenchRequest request;
  static_cast<Request&>(request) = read_request(arguments);
  if (const auto limit = given(arguments, "case_limit")) request.case_limit = number("case_limit", *limit);
  const std::optional<int> turns = read_turns(arguments);
  PythonWork work(arguments, py::none());
  request.told = [&](std::size_t done, std::size_t total) { work.tell(progress, "bench", done, total); };
  NonlinearOptions options;
  options.turns = turns.value_or(1);
  options.stop = work.stop();
  constexpr bool whole = true;
  return work.run(
      [&] {
        Bench found = turns ? nonlinear_bench(core.scene, request, options) : bench(core.scene, request);
        if (work.stopped() || work.late()) throw Stopped();
        std::string json = tools::json_text(tools::bench_json(found));
        return std::make_shared<BenchCore>(BenchCore{std::move(found), std::move(json)});
      },
      whole);
}

py::list left_out(const BenchCore& core) {
  py::list sentences;
  for (const RodBench& rod : core.bench.rods)
    if (rod.rows.empty())
      for (const std::string& note : rod.notes) sentences.append(decoded(rod.name + ": " + note));
  return sentences;
}

}  // namespace

void add_bench(py::module_& module) {
  py::class_<BenchCore, std::shared_ptr<BenchCore>>(module, "Bench")
      .def("json", [](const BenchCore& core) { return decoded(core.json); })
      .def("words", [](const BenchCore& core) { return decoded(tools::bench_text(core.bench)); })
      .def_property_readonly("shortfalls", &left_out);
  module.def("bench", &benched, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
