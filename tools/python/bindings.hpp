// What the files of the module `hb._core` share: each adds one concept.
#pragma once

#include <pybind11/pybind11.h>

namespace hb::python {

namespace py = pybind11;

void add_errors(py::module_& module);
void add_scene(py::module_& module);
void add_stability(py::module_& module);
void add_steady(py::module_& module);
void add_sweep(py::module_& module);
void add_map(py::module_& module);
void add_bench(py::module_& module);
void add_check(py::module_& module);
void add_tune(py::module_& module);
void add_hill_system(py::module_& module);
void add_report(py::module_& module);
void add_fit(py::module_& module);

}  // namespace hb::python
