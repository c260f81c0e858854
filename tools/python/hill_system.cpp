#include <fmt/core.h>

#include <optional>

#include "hb/analysis/scene_family.hpp"
#include "lib/fourier/periodic_samples.hpp"
#include "lib/scene/scene_parts.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/stability.hpp"
#include "tools/python/steady.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// M q'' + B q' + C(Omega t) q = h(Omega t), and the same as a scene.
struct HillCore {
  HillSystem system;
  Scene scene;
};

// Sum of a kind of terms by power of Omega: stiffness (matrices, components column-major) or load.
class Terms {
 public:
  Terms(std::string field, Eigen::Index size, bool matrices)
      : field_(std::move(field)), size_(size), matrices_(matrices) {}

  // cos and sin of one harmonic; either may be None.
  void add_harmonic(int harmonic, int power, const py::object& cos, const py::object& sin) {
    const std::string name = fmt::format("{}[{}]", field_, harmonic);
    const std::optional<Eigen::VectorXd> c = components(name, cos), s = components(name, sin);
    FourierSeries term(count(), harmonic);
    for (Eigen::Index i = 0; i < count(); ++i)
      term.c(i, harmonic) = harmonic_coefficient(harmonic, c ? (*c)(i) : 0, s ? (*s)(i) : 0);
    add(power, term);
  }

  // Samples at tau = 2 pi j/N, a row each: of a matrix all entries row by row.
  void add_samples(int power, const Eigen::MatrixXd& rows) {
    if (rows.cols() != count() || rows.rows() < 3)
      throw RequestError(field_, fmt::format("{} samples of {} numbers", rows.rows(), rows.cols()),
                         fmt::format("3 samples or more of {} numbers", count()));
    Eigen::MatrixXd samples(count(), rows.rows());
    for (Eigen::Index j = 0; j < rows.rows(); ++j)
      for (Eigen::Index k = 0; k < count(); ++k)
        samples(matrices_ ? k / size_ + size_ * (k % size_) : k, j) = rows(j, k);
    add(power, interpolate(samples));
  }

  const std::array<FourierSeries, 3>& series() const { return series_; }

 private:
  Eigen::Index count() const { return matrices_ ? size_ * size_ : size_; }

  std::optional<Eigen::VectorXd> components(const std::string& name, const py::object& object) const {
    if (object.is_none()) return std::nullopt;
    if (!matrices_) {
      Eigen::VectorXd entries = vector(name, object);
      if (entries.size() != size_)
        throw RequestError(name, fmt::format("{} numbers", entries.size()),
                           fmt::format("{}, as many as mass has rows", size_));
      return entries;
    }
    const Eigen::MatrixXd entries = matrix(name, object);
    if (entries.rows() != size_ || entries.cols() != size_)
      throw RequestError(name, fmt::format("a {} x {} matrix", entries.rows(), entries.cols()),
                         fmt::format("{0} x {0}, the size of mass", size_));
    return entries.reshaped();
  }

  void add(int power, const FourierSeries& term) {
    FourierSeries& sum = series_[static_cast<std::size_t>(power)];
    if (sum.c.size() == 0) sum = FourierSeries(count(), 0);
    if (term.num_harmonics() > sum.num_harmonics()) sum = fourier::resized(sum, term.num_harmonics());
    sum.c.leftCols(term.c.cols()) += term.c;
  }

  std::string field_;
  Eigen::Index size_;
  bool matrices_;
  std::array<FourierSeries, 3> series_;
};

// Lists of (harmonic, power, cos, sin) and of (power, samples).
std::array<FourierSeries, 3> read_terms(const std::string& field, Eigen::Index size, bool matrices,
                                        const py::list& harmonics, const py::list& samples) {
  Terms terms(field, size, matrices);
  for (const py::handle item : harmonics) {
    const auto term = py::reinterpret_borrow<py::tuple>(item);
    terms.add_harmonic(term[0].cast<int>(), term[1].cast<int>(), term[2], term[3]);
  }
  for (const py::handle item : samples) {
    const auto term = py::reinterpret_borrow<py::tuple>(item);
    terms.add_samples(term[0].cast<int>(), matrix(field, term[1]));
  }
  return terms.series();
}

std::shared_ptr<HillCore> hill_core(const py::object& mass, const py::object& damping,
                                    const py::list& stiffness_harmonics, const py::list& stiffness_samples,
                                    const py::list& load_harmonics, const py::list& load_samples) {
  HillSystem system;
  system.mass = matrix("mass", mass);
  const Eigen::Index size = system.mass.rows();
  if (size < 1 || system.mass.cols() != size)
    throw RequestError("mass", fmt::format("a {} x {} matrix", size, system.mass.cols()),
                       "a square matrix of a row or more");
  system.damping = damping.is_none() ? Eigen::MatrixXd::Zero(size, size) : matrix("damping", damping);
  if (system.damping.rows() != size || system.damping.cols() != size)
    throw RequestError("damping", fmt::format("a {} x {} matrix", system.damping.rows(), system.damping.cols()),
                       fmt::format("{0} x {0}, the size of mass", size));
  system.stiffness = read_terms("stiffness", size, true, stiffness_harmonics, stiffness_samples);
  system.load = read_terms("load", size, false, load_harmonics, load_samples);
  try {
    Scene scene = scene_of(system);
    return std::make_shared<HillCore>(HillCore{std::move(system), std::move(scene)});
  } catch (const std::invalid_argument& error) {
    std::string found = error.what();
    if (const std::string prefix = "HillSystem: "; found.starts_with(prefix)) found.erase(0, prefix.size());
    throw RequestError("mass", found, "an invertible mass and finite numbers");
  }
}

std::shared_ptr<Answer> solved(const HillCore& core, const py::dict& arguments) {
  Request request = read_request(plain_speeds(arguments, core.scene.units));
  request.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  return linear_answer(core.scene, request, arguments);
}

// An ordinary omega alone, as a loop over speeds asks: what speed_of would give.
std::optional<double> plain_speed(const py::object& omega, const py::object& rpm) {
  constexpr double slow = 1e-9, fast = 1e9;  // within what every request allows
  if (!rpm.is_none() || !PyFloat_CheckExact(omega.ptr())) return std::nullopt;
  const double speed = PyFloat_AS_DOUBLE(omega.ptr());
  return speed >= slow && speed <= fast ? std::optional(speed) : std::nullopt;
}

double asked_speed(const HillCore& core, const py::object& omega, const py::object& rpm) {
  if (const std::optional<double> plain = plain_speed(omega, rpm)) return *plain;
  if (py::isinstance<py::str>(omega) || py::isinstance<py::str>(rpm)) {
    const py::dict written = py::dict(py::arg("omega") = omega, py::arg("rpm") = rpm);
    return speed_of(read_request(plain_speeds(written, core.scene.units)), core.scene).omega;
  }
  Request request;
  if (!omega.is_none()) request.omega = number("omega", omega);
  if (!rpm.is_none()) request.rpm = number("rpm", rpm);
  return speed_of(request, core.scene).omega;
}

// The arguments by themselves: a call in a loop of thousands costs little more than the exponents.
StabilityView analysed(const HillCore& core, const py::object& omega, const py::object& rpm,
                       const py::object& tolerance, const py::object& method) {
  StabilityOptions options;
  if (!method.is_none()) options.method = stability_method(method);
  if (!tolerance.is_none()) {
    Request request;
    request.tolerance = number("tol", tolerance);
    // As hb steady takes it: the asked tolerance loosens, it does not tighten.
    options.tolerance = std::max(options.tolerance, 10 * settings_of(request, core.scene).tolerance);
  }
  const double speed = asked_speed(core, omega, rpm);
  auto found = std::make_unique<Stability>();
  {
    // Of one or two unknowns in microseconds: giving the lock away would take a good part of that.
    constexpr Eigen::Index small = 2;
    const auto analyse = [&] {
      *found = analyse_stability(core.system, speed, options);
      return true;
    };
    if (core.system.num_modes() > small)
      PythonWork().run(analyse);
    else
      analyse();
  }
  const Stability* stability = found.get();
  return {py::none(), stability, std::move(found)};
}

}  // namespace

void add_hill_system(py::module_& module) {
  py::class_<HillCore, std::shared_ptr<HillCore>>(module, "HillSystem")
      .def(py::init(&hill_core))
      .def_property_readonly("size", [](const HillCore& core) { return core.system.num_modes(); })
      .def_property_readonly(
          "mass", [](const py::object& self) { return view(self.cast<const HillCore&>().system.mass, self); })
      .def_property_readonly(
          "damping", [](const py::object& self) { return view(self.cast<const HillCore&>().system.damping, self); })
      .def("stiffness_series",
           [](const py::object& self, std::size_t power) {
             return view(self.cast<const HillCore&>().system.stiffness.at(power).c, self);
           })
      .def("load_series",
           [](const py::object& self, std::size_t power) {
             return view(self.cast<const HillCore&>().system.load.at(power).c, self);
           })
      .def("steady", &solved, py::arg("arguments"))
      .def("stability", &analysed);
}

}  // namespace hb::python
