// Arguments of Python calls, checked: RequestError names the argument, what was found and what is allowed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/analysis/sensitivity_band.hpp"
#include "tools/command/range_units.hpp"
#include "tools/python/bindings.hpp"

namespace hb::python {

// An object as it stands in a message: its repr, shortened.
[[nodiscard]] std::string shown(py::handle object);

[[nodiscard]] double number(const std::string& field, py::handle object);
[[nodiscard]] int integer(const std::string& field, py::handle object, int least, int most);
[[nodiscard]] std::string text(const std::string& field, py::handle object);
// A text or several.
[[nodiscard]] std::vector<std::string> texts(const std::string& field, py::handle object);
[[nodiscard]] std::vector<double> numbers(const std::string& field, py::handle object);
// Finite entries of an array of one or two dimensions.
[[nodiscard]] Eigen::VectorXd vector(const std::string& field, py::handle object);
[[nodiscard]] Eigen::MatrixXd matrix(const std::string& field, py::handle object);

// The entry of a dict, or nothing where it is missing or None.
[[nodiscard]] std::optional<py::object> given(const py::dict& arguments, const char* field);

// The arguments with the units of rpm and omega taken off: of "50 Hz", "5 Hz:50 Hz:x10", ("5 Hz", "50 Hz", "x10") and
// ["5 Hz", "50 Hz"].
[[nodiscard]] py::dict plain_speeds(const py::dict& arguments, const Units& units);

// rpm, omega, modes, tol, rods, only, steady_method, stability_method and bound of a call.
[[nodiscard]] Request read_request(const py::dict& arguments);
[[nodiscard]] std::vector<BandRequest> read_bands(const py::dict& arguments);
[[nodiscard]] StabilityMethod stability_method(py::handle object);
// Turns of a motion without linearisation; nothing with theory="linear", which knows no period.
[[nodiscard]] std::optional<int> read_turns(const py::dict& arguments);
[[nodiscard]] int read_threads(const py::dict& arguments);

// Values of a range: the text of the command line ("200:6000:10", "200:6000:x59"), a tuple (from, to, third), or a list
// or array of ascending values. `third` says what a bare third number means.
using Third = tools::ThirdNumber;
[[nodiscard]] std::vector<double> range_values(const std::string& field, py::handle object, Third third);
// "PATH=RANGE", or a tuple (path, range).
struct NamedValues {
  std::string path;
  std::vector<double> values;
};
[[nodiscard]] NamedValues named_values(const std::string& field, py::handle object, Third third,
                                       const SceneSource& source);

}  // namespace hb::python
