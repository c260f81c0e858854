#include "tools/python/scene.hpp"

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "lib/scene/scene_reader.hpp"
#include "tools/command/command.hpp"
#include "tools/command/version.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/scene_report.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

namespace fs = std::filesystem;

SceneCore loaded(const std::string& file) { return {read_text_file(file), file, fs::path(file).parent_path()}; }

SceneCore changed(const SceneCore& core, const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<Override> overrides;
  for (const auto& [path, value] : values) overrides.push_back({path, value});
  const py::gil_scoped_release release;
  // Read first: problems are told by the paths given.
  (void)core.source.with(overrides);
  return {core.source.text_with(overrides), core.name, core.folder};
}

py::dict units_of(const Units& units) {
  py::dict result;
  result["length"] = units.length;
  result["mass"] = units.mass;
  result["time"] = units.time;
  result["angle"] = units.angle;
  return result;
}

// Names of the elastic links; "system" of a [hill] scene.
std::vector<std::string> rods_of(const Scene& scene) {
  const auto* linkage = std::get_if<Linkage>(&scene.model);
  if (linkage == nullptr) return {"system"};
  std::vector<std::string> names;
  for (const int link : elastic_links(*linkage)) names.push_back(body_name(*linkage, link));
  return names;
}

// A folder that goes with everything in it.
class Scratch {
 public:
  Scratch() : path_((fs::temp_directory_path() / "hb-python-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The mechanism as `hb scene --out` draws it, as SVG; empty where gnuplot is missing or fails, and for a [hill] scene.
std::string drawing(const Scene& scene) {
  using namespace tools;
  if (!std::holds_alternative<Linkage>(scene.model)) return "";
  const Scratch scratch;
  if (scratch.path().empty()) return "";
  try {
    const PictureKinds kinds = {"svg"};
    const std::string script = script_name("scene");
    OutputFolder folder(fs::path(scratch.path()) / "scene", "scene");
    const CsvFile mechanism = mechanism_csv(scene);
    folder.write(mechanism.name, csv_text(mechanism));
    const std::vector<Figure> figures = {mechanism_figure(scene, mechanism)};
    folder.write(script, plot_script(figures, {.kinds = kinds}));
    const fs::path place = folder.scratch_with_links();
    if (!run_gnuplot(place, script, figures, std::chrono::seconds(30), kinds).complete()) return "";
    std::ostringstream text;
    text << std::ifstream(place / (figures.front().name + ".svg"), std::ios::binary).rdbuf();
    return text.str();
  } catch (const OutputError&) {
    return "";
  }
}

}  // namespace

SceneCore::SceneCore(std::string text_, std::string name_, fs::path folder_)
    : text(std::move(text_)),
      name(std::move(name_)),
      folder(std::move(folder_)),
      source(text, name, folder),
      scene(source.with()) {}

tools::Provenance SceneCore::provenance(const std::string& call) const {
  return {fmt::format("hb {}", tools::version()), call, name, text};
}

double angle_unit(const Units& units) { return units.angle == "deg" ? std::numbers::pi / 180 : 1; }

void add_scene(py::module_& module) {
  py::class_<SceneCore, std::shared_ptr<SceneCore>>(module, "Scene")
      .def(py::init([](const py::object& text_given, const std::string& name, const std::string& folder) {
             std::string scene_text = text("text", text_given);
             const py::gil_scoped_release release;
             return std::make_shared<SceneCore>(std::move(scene_text), name, folder);
           }),
           py::arg("text"), py::arg("name"), py::arg("folder"))
      .def_static(
          "load",
          [](const std::string& file) {
            const py::gil_scoped_release release;
            return std::make_shared<SceneCore>(loaded(file));
          },
          py::arg("file"))
      .def("changed",
           [](const SceneCore& core, const std::vector<std::pair<std::string, std::string>>& values) {
             return std::make_shared<SceneCore>(changed(core, values));
           })
      .def_property_readonly("text", [](const SceneCore& core) { return decoded(core.text); })
      .def_property_readonly("name", [](const SceneCore& core) { return decoded(core.name); })
      .def_property_readonly("folder", [](const SceneCore& core) { return decoded(core.folder.string()); })
      .def_property_readonly("title", [](const SceneCore& core) { return decoded(core.scene.title); })
      .def_property_readonly("units", [](const SceneCore& core) { return units_of(core.scene.units); })
      .def_property_readonly("rods", [](const SceneCore& core) { return decoded(rods_of(core.scene)); })
      .def_property_readonly("warnings", [](const SceneCore& core) { return decoded(core.scene.warnings); })
      .def_property_readonly("notes", [](const SceneCore& core) { return decoded(core.scene.notes); })
      .def_property_readonly("is_linkage",
                             [](const SceneCore& core) { return std::holds_alternative<Linkage>(core.scene.model); })
      .def("paths", [](const SceneCore& core) { return decoded(core.source.numeric_paths()); })
      .def("value", [](const SceneCore& core, const std::string& path) { return core.source.value(path); })
      .def("table", [](const SceneCore& core) { return decoded(tools::scene_table(core.scene)); })
      .def("json", [](const SceneCore& core) { return decoded(tools::json_text(tools::scene_json(core.scene))); })
      .def("mechanism",
           [](const SceneCore& core) -> py::object {
             if (!std::holds_alternative<Linkage>(core.scene.model)) return py::none();
             return table_of(tools::mechanism_csv(core.scene));
           })
      .def("drawing", [](const SceneCore& core) {
        std::string svg;
        {
          const py::gil_scoped_release release;
          svg = drawing(core.scene);
        }
        return decoded(svg);
      });
}

}  // namespace hb::python
