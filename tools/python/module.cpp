#include "tools/command/version.hpp"
#include "tools/python/bindings.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace hb::python;
  module.doc() = "The compiled half of the package hb: scenes, analyses and their results.";
  module.attr("version") = hb::tools::version();
  add_errors(module);
  add_scene(module);
  add_stability(module);
  add_steady(module);
  add_sweep(module);
  add_map(module);
  add_bench(module);
  add_check(module);
  add_tune(module);
  add_hill_system(module);
  add_report(module);
  add_fit(module);
}
