#include <fmt/format.h>

#include "hb/analysis/damping_fit.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/arrays.hpp"
#include "tools/python/bindings.hpp"

namespace hb::python {
namespace {

using Fit = DampingFit (*)(const Eigen::VectorXd&, const Eigen::VectorXd&);

// (frequency, its error, ratio, its error, residual, fitted)
py::tuple fitted(Fit fit, const char* field, const py::object& at, const py::object& values) {
  const Eigen::VectorXd places = vector(field, at), measured = vector(field, values);
  if (places.size() != measured.size())
    throw RequestError(field, fmt::format("{} places and {} values", places.size(), measured.size()),
                       "as many of both");
  const DampingFit found = fit(places, measured);
  return py::make_tuple(found.frequency, found.frequency_error, found.ratio, found.ratio_error, found.residual,
                        array_of(found.fitted).attr("reshape")(-1));
}

}  // namespace

void add_fit(py::module_& module) {
  module.def(
      "fit_decay",
      [](const py::object& at, const py::object& values) { return fitted(&fit_decay, "decay", at, values); },
      py::arg("t"), py::arg("x"));
  module.def(
      "fit_peak", [](const py::object& at, const py::object& values) { return fitted(&fit_peak, "peak", at, values); },
      py::arg("omega"), py::arg("amplitude"));
}

}  // namespace hb::python
