#include "tools/python/stability.hpp"

#include <fmt/core.h>

#include <cmath>

#include "lib/constants.hpp"
#include "tools/python/arrays.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

template <class Value>
py::array of_each(const StabilityView& view, Value value) {
  const std::vector<Exponent>& exponents = view.stability->exponents;
  py::array_t<double> array(static_cast<py::ssize_t>(exponents.size()));
  for (std::size_t k = 0; k < exponents.size(); ++k)
    array.mutable_at(static_cast<py::ssize_t>(k)) = value(exponents[k]);
  return read_only(std::move(array));
}

}  // namespace

void add_stability(py::module_& module) {
  py::class_<StabilityView>(module, "Stability",
                            "Floquet exponents of a periodic motion, the growth rate and what is known of its sign.")
      .def_property_readonly(
          "exponents",
          [](const py::object& self) {
            return view(self.cast<const StabilityView&>().stability->exponents, &Exponent::value, self);
          },
          "Exponents, 1/time: real part descending, imaginary part folded to (-Omega/2, Omega/2]. Read-only.")
      .def_property_readonly(
          "exponent_errors",
          [](const py::object& self) {
            return view(self.cast<const StabilityView&>().stability->exponents, &Exponent::error, self);
          },
          "Error of each exponent, 1/time. Read-only.")
      .def_property_readonly(
          "frequencies_hz",
          [](const StabilityView& v) {
            return of_each(v, [&v](const Exponent& e) { return e.frequency * (1 / (two_pi * v.time_in_s)); });
          },
          "Frequency of each exponent, unfolded, Hz. Read-only.")
      .def_property_readonly(
          "frequencies_hz_errors",
          [](const StabilityView& v) {
            return of_each(v, [&v](const Exponent& e) { return e.error * (1 / (two_pi * v.time_in_s)); });
          },
          "Their errors, Hz. Read-only.")
      .def_property_readonly(
          "damping_ratios",
          [](const StabilityView& v) {
            return of_each(
                v, [](const Exponent& e) { return -e.value.real() / std::hypot(e.value.real(), e.frequency) + 0.0; });
          },
          "-Re/|exponent| of each at its frequency. Read-only.")
      .def_property_readonly(
          "damping_ratio_errors",
          [](const StabilityView& v) {
            return of_each(v, [](const Exponent& e) { return e.error / std::hypot(e.value.real(), e.frequency); });
          },
          "Their errors. Read-only.")
      .def_property_readonly(
          "growth_rate", [](const StabilityView& v) { return v.stability->growth_rate + 0.0; },
          "Largest real part, 1/time: above 0 disturbances grow.")
      .def_property_readonly(
          "growth_error", [](const StabilityView& v) { return v.stability->growth_error; },
          "Error of growth_rate, the larger half of growth_interval.")
      .def_property_readonly(
          "growth_interval",
          [](const StabilityView& v) {
            return py::make_tuple(v.stability->growth_low + 0.0, v.stability->growth_high + 0.0);
          },
          "(low, high) between which the growth rate lies: what the verdict rests on.")
      .def_property_readonly(
          "verdict", [](const StabilityView& v) { return to_string(v.stability->verdict); },
          "\"stable\", \"bounded\", \"unstable\" or \"undecided\".")
      .def_property_readonly(
          "converged", [](const StabilityView& v) { return v.stability->converged; },
          "Whether growth_error is within what was asked.")
      .def_property_readonly(
          "shortfalls",
          [](const StabilityView& v) {
            py::list sentences;
            if (!v.stability->converged)
              sentences.append(fmt::format("the growth rate is known to {:.1e} only", v.stability->growth_error));
            return sentences;
          },
          "What missed the tolerance, a sentence each.")
      .def_property_readonly(
          "method", [](const StabilityView& v) { return to_string(v.stability->method); },
          "The method that gave the growth rate.")
      .def_property_readonly(
          "evidence", [](const StabilityView& v) { return decoded(v.stability->evidence); },
          "One sentence: what was done.")
      .def("__repr__", [](const StabilityView& v) {
        return py::str("<hb.Stability {}, growth rate {:.6g} +/- {:.1e}, {} exponents>")
            .format(to_string(v.stability->verdict), v.stability->growth_rate + 0.0, v.stability->growth_error,
                    v.stability->exponents.size());
      });
}

}  // namespace hb::python
