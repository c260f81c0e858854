#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tools/output/json_output.hpp"
#include "tools/output/map_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/results.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

std::shared_ptr<Map> mapped(const SceneCore& core, const py::dict& written, const py::object& progress) {
  const py::dict arguments = plain_speeds(written, core.scene.units);
  constexpr double max_points = 4e6;
  MapRequest request;
  static_cast<Request&>(request) = read_request(arguments);
  for (const bool is_x : {true, false}) {
    const char* field = is_x ? "x" : "y";
    const auto range = given(arguments, field);
    if (!range) throw RequestError(field, "nothing", "\"PATH=FROM:TO:COUNT\", as in \"rpm=200:6000:100\"");
    NamedValues named = named_values(field, *range, Third::count, core.source);
    (is_x ? request.x : request.y) = {std::move(named.path), std::move(named.values)};
  }
  const double points = static_cast<double>(request.x.values.size()) * static_cast<double>(request.y.values.size());
  if (points > max_points)
    throw RequestError("x, y", fmt::format("{} x {} points", request.x.values.size(), request.y.values.size()),
                       fmt::format("at most {} in all", max_points));
  if (!request.only.stability)
    throw RequestError("only", shown(*given(arguments, "only")), "stability, growth, verdict");
  if (const auto range = given(arguments, "damping_range")) {
    const std::vector<double> factors = numbers("damping_range", *range);
    if (factors.size() != 2) throw RequestError("damping_range", shown(*range), "a pair (low, high) of factors");
    request.damping_range = {factors[0], factors[1]};
  }
  const std::vector<BandRequest> bands = read_bands(arguments);
  if (bands.size() > 1) throw RequestError("band", shown(*given(arguments, "band")), "one band");
  if (!bands.empty() && bands.front().parameter == BandParameter::damping)
    request.damping_range = {bands.front().from, bands.front().to};
  else if (!bands.empty())
    request.band = bands.front();
  if (const auto stress = given(arguments, "stress")) request.stress = py::cast<bool>(*stress);
  PythonWork work(arguments, progress);
  return work.run([&] { return std::make_shared<Map>(map(core.source, request, work)); });
}

}  // namespace

void add_map(py::module_& module) {
  py::class_<Map, std::shared_ptr<Map>>(module, "Map")
      .def("json", [](const Map& map) { return decoded(tools::map_text(tools::document_of(map))); })
      .def("words", [](const Map& map) { return decoded(tools::map_summary(tools::document_of(map))); })
      .def("table", [](const Map& map) { return table_of(tools::map_grid_csv(tools::document_of(map))); })
      .def_property_readonly("evidence", [](const Map& map) { return decoded(map.evidence); });
  module.def("map", &mapped, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace hb::python
