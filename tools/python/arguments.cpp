#include "tools/python/arguments.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"

namespace hb::python {
namespace {

bool is_text(py::handle object) { return py::isinstance<py::str>(object); }
bool is_word(py::handle object, const char* word) {
  return is_text(object) && PyUnicode_CompareWithASCIIString(object.ptr(), word) == 0;
}

template <class Enum>
Enum choice(const std::string& field, py::handle object, const std::vector<std::pair<const char*, Enum>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (is_word(object, name)) return value;
    names.push_back(name);
  }
  throw RequestError(field, shown(object), fmt::format("{}", fmt::join(names, ", ")));
}

bool flag(const std::string& field, py::handle object) {
  if (!PyBool_Check(object.ptr())) throw RequestError(field, shown(object), "True or False");
  return object.ptr() == Py_True;
}

// A C-ordered array of doubles; RequestError for what is none.
py::array_t<double> doubles(const std::string& field, py::handle object, const std::string& allowed) {
  py::object array;
  try {
    array = py::module_::import("numpy").attr("asarray")(object);
    const char kind = array.attr("dtype").attr("kind").cast<char>();
    if (std::string("iuf").find(kind) != std::string::npos)
      return py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  } catch (const py::error_already_set&) {  // no array
  }
  throw RequestError(field, shown(object), allowed);
}

std::string shape_text(const py::array& array) {
  std::vector<py::ssize_t> sizes(array.shape(), array.shape() + array.ndim());
  return fmt::format("an array of shape ({}{})", fmt::join(sizes, ", "), sizes.size() == 1 ? "," : "");
}

void require_finite(const std::string& field, const Eigen::Ref<const Eigen::MatrixXd>& entries) {
  for (const double entry : entries.reshaped())
    if (!std::isfinite(entry)) throw RequestError(field, fmt::format("{}", entry), "finite numbers");
}

bool holds_text(py::handle object) {
  if (is_text(object)) return true;
  if (!py::isinstance<py::tuple>(object) && !py::isinstance<py::list>(object)) return false;
  const auto parts = py::reinterpret_borrow<py::sequence>(object);
  return std::any_of(parts.begin(), parts.end(), is_text);
}

// A number, a range as a text or as a tuple, or a list of numbers, whose texts have units; texts without units stay.
py::object without_units(const std::string& field, const py::object& object, const tools::UnitReader& read) {
  if (py::isinstance<py::list>(object)) {
    py::list parts;
    for (const py::handle part : object)
      parts.append(is_text(part) ? without_units(field, py::reinterpret_borrow<py::object>(part), read)
                                 : py::reinterpret_borrow<py::object>(part));
    return parts;
  }
  std::string written;
  if (is_text(object)) {
    written = text(field, object);
  } else {
    for (const py::handle part : object)
      written +=
          (written.empty() ? "" : ":") + (is_text(part) ? text(field, part) : fmt::format("{}", number(field, part)));
  }
  const std::string plain = tools::plain_range(field, written, Third::step, read);
  if (plain == written) return is_text(object) ? object : py::object(py::str(plain));
  const std::optional<double> value = tools::whole_number(plain);
  return value ? py::object(py::float_(*value)) : py::object(py::str(plain));
}

}  // namespace

std::string shown(py::handle object) {
  constexpr std::size_t most = 80;
  std::string repr;
  try {
    repr = py::repr(object).cast<std::string>();
  } catch (const py::error_already_set&) {
    repr = "an object";
  }
  std::replace(repr.begin(), repr.end(), '\n', ' ');
  if (repr.size() <= most) return repr;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(repr[end]) & 0xC0) == 0x80) --end;  // not inside a character
  return repr.substr(0, end) + "...";
}

double number(const std::string& field, py::handle object) {
  if (PyFloat_CheckExact(object.ptr())) return PyFloat_AS_DOUBLE(object.ptr());
  if (!PyBool_Check(object.ptr()) &&
      (PyLong_Check(object.ptr()) || PyObject_HasAttrString(object.ptr(), "__float__"))) {
    const double value = PyFloat_AsDouble(object.ptr());
    if (PyErr_Occurred() == nullptr) return value;
    PyErr_Clear();
  }
  throw RequestError(field, shown(object), "a number");
}

int integer(const std::string& field, py::handle object, int least, int most) {
  if (!PyBool_Check(object.ptr()) && PyIndex_Check(object.ptr()) != 0) {
    const Py_ssize_t value = PyNumber_AsSsize_t(object.ptr(), nullptr);
    if (PyErr_Occurred() != nullptr) PyErr_Clear();
    if (value >= least && value <= most) return static_cast<int>(value);
  }
  throw RequestError(field, shown(object), fmt::format("an integer {} to {}", least, most));
}

std::string text(const std::string& field, py::handle object) {
  if (is_text(object)) {
    try {
      return object.cast<std::string>();
    } catch (const py::cast_error&) {  // lone surrogates
    } catch (const py::error_already_set&) {
    }
  }
  throw RequestError(field, shown(object), "text");
}

std::vector<std::string> texts(const std::string& field, py::handle object) {
  if (is_text(object)) {
    // As on the command line: names joined by commas.
    std::vector<std::string> parts(1);
    for (const char c : text(field, object)) {
      if (c == ',') {
        parts.emplace_back();
      } else {
        parts.back() += c;
      }
    }
    return parts;
  }
  if (!py::isinstance<py::sequence>(object) || py::isinstance<py::bytes>(object))
    throw RequestError(field, shown(object), "text, or a list of texts");
  std::vector<std::string> result;
  const auto list = py::reinterpret_borrow<py::sequence>(object);
  for (std::size_t k = 0; k < list.size(); ++k) result.push_back(text(field, py::object(list[k])));
  return result;
}

std::vector<double> numbers(const std::string& field, py::handle object) {
  const py::array_t<double> array = doubles(field, object, "a number, or a list or array of numbers");
  if (array.ndim() > 1) throw RequestError(field, shape_text(array), "numbers in one dimension");
  return {array.data(), array.data() + array.size()};
}

Eigen::VectorXd vector(const std::string& field, py::handle object) {
  const py::array_t<double> array = doubles(field, object, "an array of finite numbers");
  if (array.ndim() != 1) throw RequestError(field, shape_text(array), "an array of one dimension");
  Eigen::VectorXd result = Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
  require_finite(field, result);
  return result;
}

Eigen::MatrixXd matrix(const std::string& field, py::handle object) {
  const py::array_t<double> array = doubles(field, object, "a matrix of finite numbers");
  if (array.ndim() != 2) throw RequestError(field, shape_text(array), "a matrix, an array of two dimensions");
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::MatrixXd result = Eigen::Map<const RowMajor>(array.data(), array.shape(0), array.shape(1));
  require_finite(field, result);
  return result;
}

std::optional<py::object> given(const py::dict& arguments, const char* field) {
  PyObject* value = PyDict_GetItemString(arguments.ptr(), field);
  if (value == nullptr || value == Py_None) return std::nullopt;
  return py::reinterpret_borrow<py::object>(value);
}

py::dict plain_speeds(const py::dict& arguments, const Units& units) {
  py::dict plain = arguments;
  for (const char* field : {"rpm", "omega"}) {
    const auto value = given(arguments, field);
    if (!value || !holds_text(*value)) continue;
    if (plain.is(arguments)) plain = arguments.attr("copy")();
    plain[field] = without_units(field, *value, [&](std::string_view part) {
      return speed_quantity(part, std::string_view(field) == "rpm", units);
    });
  }
  return plain;
}

std::vector<BandRequest> read_bands(const py::dict& arguments) {
  std::vector<BandRequest> bands;
  if (const auto asked = given(arguments, "band"))
    for (const std::string& text : texts("band", *asked)) bands.push_back(parse_band(text));
  return bands;
}

Request read_request(const py::dict& arguments) {
  Request request;
  if (const auto rpm = given(arguments, "rpm")) request.rpm = number("rpm", *rpm);
  if (const auto omega = given(arguments, "omega")) request.omega = number("omega", *omega);
  if (const auto modes = given(arguments, "modes")) {
    if (is_word(*modes, "auto")) {
      request.modes = AutoModes{};
    } else {
      if (PyBool_Check(modes->ptr()) || PyIndex_Check(modes->ptr()) == 0)
        throw RequestError("modes", shown(*modes), fmt::format("an integer 1 to {}, or \"auto\"", max_modes));
      request.modes = integer("modes", *modes, 1, max_modes);
    }
  }
  if (const auto tolerance = given(arguments, "tol")) request.tolerance = number("tol", *tolerance);
  if (const auto rods = given(arguments, "rods")) {
    request.rods = texts("rods", *rods);
    if (request.rods.empty()) throw RequestError("rods", shown(*rods), "names of elastic links, or None: all of them");
  }
  if (const auto only = given(arguments, "only")) {
    const std::vector<std::string> names = texts("only", *only);
    if (names.empty())
      throw RequestError("only", shown(*only), "steady, stability, growth, verdict, reactions, shape, or None: all");
    request.only = only_of(names);
  }
  if (const auto search = given(arguments, "search")) request.search = flag("search", *search);
  if (const auto boundaries = given(arguments, "boundaries")) request.boundaries = flag("boundaries", *boundaries);
  if (const auto tolerance = given(arguments, "boundary_tol"))
    request.boundary_tolerance = number("boundary_tol", *tolerance);
  if (const auto method = given(arguments, "steady_method"))
    request.steady_method = choice<SteadyMethod>("steady_method", *method,
                                                 {{"automatic", SteadyMethod::automatic},
                                                  {"direct", SteadyMethod::direct},
                                                  {"iterative", SteadyMethod::iterative}});
  if (const auto bound = given(arguments, "bound"))
    request.bound =
        choice<SteadyBound>("bound", *bound, {{"estimated", SteadyBound::estimated}, {"proved", SteadyBound::proved}});
  if (const auto method = given(arguments, "stability_method")) request.stability_method = stability_method(*method);
  return request;
}

StabilityMethod stability_method(py::handle object) {
  return choice<StabilityMethod>("stability_method", object,
                                 {{"automatic", StabilityMethod::automatic},
                                  {"hill", StabilityMethod::hill},
                                  {"slaving", StabilityMethod::slaving},
                                  {"propagation", StabilityMethod::propagation},
                                  {"determinant", StabilityMethod::determinant},
                                  {"bound", StabilityMethod::bound}});
}

std::optional<int> read_turns(const py::dict& arguments) {
  constexpr int most = 64;
  const auto theory = given(arguments, "theory"), period = given(arguments, "period");
  const std::string name = theory ? text("theory", *theory) : "linear";
  if (name == "nonlinear") return period ? integer("period", *period, 1, most) : 1;
  if (name != "linear") throw RequestError("theory", shown(*theory), "linear, nonlinear");
  if (period) throw RequestError("period", shown(*period) + " with the linear theory", "with theory=\"nonlinear\"");
  return std::nullopt;
}

int read_threads(const py::dict& arguments) {
  constexpr int most = 1024;
  const auto threads = given(arguments, "threads");
  if (!threads) return 1;
  if (is_word(*threads, "all")) return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, most);
  if (PyBool_Check(threads->ptr()) || PyIndex_Check(threads->ptr()) == 0)
    throw RequestError("threads", shown(*threads), fmt::format("an integer 1 to {}, or \"all\"", most));
  return integer("threads", *threads, 1, most);
}

std::vector<double> range_values(const std::string& field, py::handle object, Third third) {
  using namespace tools;
  if (is_text(object)) {
    const std::string range = text(field, object);
    return third == Third::step ? range_by_step(field, range) : range_by_count(field, range);
  }
  if (py::isinstance<py::tuple>(object)) {
    const auto parts = py::reinterpret_borrow<py::tuple>(object);
    const char* allowed = third == Third::step ? "a tuple (from, to, step), or an array of values"
                                               : "a tuple (from, to, count), or an array of values";
    if (parts.size() != 3) throw RequestError(field, shown(object), allowed);
    const double from = number(field, parts[0]), to = number(field, parts[1]);
    if (is_text(parts[2])) return range_by_count(field, fmt::format("{}:{}:{}", from, to, text(field, parts[2])));
    if (!(std::isfinite(from) && std::isfinite(to))) throw RequestError(field, shown(object), "finite numbers");
    if (third == Third::count) {
      const int count = integer(field, parts[2], 2, static_cast<int>(max_range_points));
      return range_by_count(field, fmt::format("{}:{}:{}", from, to, count));
    }
    const double step = number(field, parts[2]);
    if (!std::isfinite(step)) throw RequestError(field, shown(object), "finite numbers");
    return range_by_step(field, from, to, step);
  }
  if (PyFloat_Check(object.ptr()) || PyLong_Check(object.ptr()))
    throw RequestError(field, shown(object), "a range (from, to, step), or an array of values");
  std::vector<double> values = numbers(field, object);
  for (const double value : values)
    if (!std::isfinite(value)) throw RequestError(field, fmt::format("{}", value), "finite numbers");
  return values;
}

NamedValues named_values(const std::string& field, py::handle object, Third third, const SceneSource& source) {
  if (is_text(object)) {
    const tools::NamedRange named = tools::named_range(field, text(field, object));
    const std::string plain = tools::plain_range(field, named.range, third, source, named.path);
    return {named.path, range_values(field, py::str(plain), third)};
  }
  if (py::isinstance<py::tuple>(object) && py::len(object) == 2) {
    const auto parts = py::reinterpret_borrow<py::tuple>(object);
    return {text(field, parts[0]), range_values(field, parts[1], third)};
  }
  throw RequestError(field, shown(object), "\"PATH=FROM:TO:...\", or a tuple (path, range)");
}

}  // namespace hb::python
