#include "tools/python/steady.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/output/band_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/table_output.hpp"
#include "tools/python/arguments.hpp"
#include "tools/python/python_work.hpp"
#include "tools/python/scene.hpp"
#include "tools/python/stability.hpp"
#include "tools/python/tables.hpp"

namespace hb::python {
namespace {

// The components of a joint's force, or of the torque, over the turn.
struct ForceView {
  py::object owner;
  const Answer* answer;
  const FourierSeries *elastic, *rigid;
  std::optional<double> error;  // of the elastic values
  std::optional<double> mean_theory_error = {};
};

double largest_of(const FourierSeries& series) {
  double largest = 0;
  for (Eigen::Index c = 0; c < series.num_components(); ++c)
    largest = std::max(largest, fourier::max_abs(series, c).value);
  return largest;
}

// Of any component of any joint's force, and of the torque.
std::optional<double> joints_error(const SpeedResult& result) {
  if (!result.force_errors) return std::nullopt;
  double largest = 0;
  for (const JointForce& joint : result.forces->joints) largest = std::max(largest, largest_of(joint.elastic));
  return (result.force_errors->force + result.force_errors->force_cut) * largest;
}
std::optional<double> torque_error(const SpeedResult& result) {
  if (!result.force_errors) return std::nullopt;
  return (result.force_errors->torque + result.force_errors->torque_cut) * largest_of(result.forces->torque);
}

// Angles as given, in rad over the period of `turns` turns that a series stands for; whether one or several.
struct Angles {
  Eigen::VectorXd phase;
  bool single;
};

Angles angles(const Answer& answer, const py::object& given_angles) {
  const std::vector<double> list = numbers("angle", given_angles);
  const double unit = angle_unit(answer.model->scene.units) / answer.turns();
  Angles result{Eigen::VectorXd(static_cast<Eigen::Index>(list.size())),
                py::isinstance<py::float_>(given_angles) || py::isinstance<py::int_>(given_angles)};
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (!std::isfinite(list[k])) throw RequestError("angle", fmt::format("{}", list[k]), "finite numbers");
    result.phase(static_cast<Eigen::Index>(k)) = unit * list[k];
  }
  return result;
}

Eigen::MatrixXd values_at(const FourierSeries& series, const Eigen::VectorXd& phase) {
  Eigen::MatrixXd values(series.num_components(), phase.size());
  for (Eigen::Index k = 0; k < phase.size(); ++k) values.col(k) = fourier::evaluate(series, phase(k));
  return values;
}

// Without the axes that a single number, or a single component, leaves out.
py::object shaped(const Eigen::MatrixXd& values, bool single_row, bool single_column) {
  py::object array = array_of(values);
  if (single_column) array = array[py::make_tuple(py::slice(0, values.rows(), 1), 0)];
  if (single_row) array = array[py::int_(0)];
  return array;
}

py::object force_at(const ForceView& force, const FourierSeries& series, const py::object& angle) {
  const Angles at = angles(*force.answer, angle);
  return shaped(values_at(series, at.phase), series.num_components() == 1, at.single);
}

const FourierSeries& solved_q(const RodView& rod) {
  const RodResult& result = rod.result();
  if (!result.steady) throw RequestError("only", "no steady state", "steady among what is computed");
  if (result.steady->q.c.size() == 0)
    throw RequestError("rpm", "no periodic solution at this speed", "a speed off resonance");
  return result.steady->q;
}

// w or EJ w'' at places x along the rod, kept terms and the static share of the others.
py::object field_at(const RodView& rod, const py::object& places, const py::object& given_angles, bool moment) {
  const Answer& answer = *rod.answer;
  const Linkage* linkage = answer.model->linkage();
  if (linkage == nullptr) throw RequestError("x", "a [hill] scene", "an elastic link: a [hill] system has no shape");
  const FourierSeries& q = solved_q(rod);
  const RodResult& result = rod.result();
  const RodModel& model = answer.model->rods[rod.rod];
  const Body& link = *body_at(*linkage, result.link);
  const std::vector<double> list = numbers("x", places);
  const bool single = py::isinstance<py::float_>(places) || py::isinstance<py::int_>(places);
  for (const double x : list)
    if (!(x >= 0 && x <= link.length))
      throw RequestError("x", fmt::format("{}", x), fmt::format("0 to {}, the link's length", link.length));
  const Angles at = angles(answer, given_angles);
  const RodCoefficients& coefficients = answer.model->coefficients.rods[static_cast<std::size_t>(model.coefficients)];
  // Enough samples for the product of the deflection and the rod's coefficients.
  Eigen::Index harmonics = 0;
  for (const FourierSeries& f : coefficients.f) harmonics = std::max(harmonics, f.num_harmonics());
  harmonics += q.num_harmonics();
  const Eigen::Map<const Eigen::VectorXd> x(list.data(), static_cast<Eigen::Index>(list.size()));
  Eigen::MatrixXd values(x.size(), at.phase.size());
  if (values.size() > 0) {
    const py::gil_scoped_release release;
    const RodField field =
        rod_field(link, coefficients, answer.result.speed, q, x, fourier::fast_length(2 * harmonics + 2));
    values = values_at(fourier::analyse(moment ? field.bending_moment : field.w), at.phase);
  }
  return shaped(values, single, at.single);
}

py::object optional(const std::optional<double>& value) { return value ? py::cast(*value) : py::none(); }

tools::CsvFile rod_table(const RodView& rod, const std::string& what) {
  const SceneModel& model = *rod.answer->model;
  const SpeedResult& result = rod.answer->result;
  if (what == "exponents" && rod.result().stability) return tools::exponents_csv(model, result, rod.result());
  (void)solved_q(rod);
  if (what == "response") return tools::response_csv(model, result, rod.result());
  if (what == "fourier") return tools::fourier_csv(model, result, rod.result());
  if (what == "deflection" && rod.result().shape) return tools::deflection_csv(model, result, rod.result());
  if (what == "bending_moment" && rod.result().shape) return tools::bending_moment_csv(model, result, rod.result());
  throw RequestError("what", "\"" + what + "\"",
                     "of what was computed: response, fourier, deflection, bending_moment, exponents");
}

tools::CsvFile table(const Answer& answer, const std::string& what) {
  if (answer.result.forces && what == "joint_forces") return tools::forces_csv(*answer.model, answer.result);
  if (answer.result.forces && what == "torque") return tools::torque_csv(*answer.model, answer.result);
  throw RequestError("what", "\"" + what + "\"", "joint_forces or torque, where reactions were computed");
}

std::shared_ptr<Answer> linear(const SceneCore& core, const py::dict& arguments) {
  return linear_answer(core.scene, read_request(arguments), arguments);
}

std::shared_ptr<Answer> nonlinear(const SceneCore& core, const py::dict& arguments, int turns,
                                  const std::vector<BandRequest>& bands) {
  const Request request = read_request(arguments);
  PythonWork work(arguments, py::none());
  NonlinearOptions options;
  options.turns = turns;
  options.stop = work.stop();
  return work.run([&] {
    NonlinearSteady found = nonlinear_steady(core.scene, request, options);
    if (work.stopped()) throw Stopped();
    work.say_time_limit(found.shortfalls);
    auto answer = std::make_shared<Answer>();
    answer->nonlinear_bands = nonlinear_bands(core.scene, request, options, bands);
    if (work.stopped()) throw Stopped();
    answer->settings = std::move(found.settings);
    answer->model = std::move(found.model);
    answer->nonlinear = std::move(static_cast<NonlinearResult&>(found));
    answer->result = tools::as_speed_result(*answer->nonlinear);
    answer->result.shortfalls = answer->nonlinear->shortfalls;
    for (std::size_t r = 0; r < answer->result.rods.size(); ++r)
      answer->result.rods[r].cut = answer->nonlinear->rods[r].cut;
    return answer;
  });
}

// "damping=0.5:2" each.
std::shared_ptr<Answer> answer_of(const SceneCore& core, const py::dict& written) {
  const py::dict arguments = plain_speeds(written, core.scene.units);
  const std::vector<BandRequest> bands = read_bands(arguments);
  if (const std::optional<int> turns = read_turns(arguments)) return nonlinear(core, arguments, *turns, bands);
  std::shared_ptr<Answer> answer = linear(core, arguments);
  if (bands.empty()) return answer;
  const Request request = read_request(arguments);
  PythonWork work(arguments, py::none());
  constexpr bool whole = true;
  answer->bands = work.run([&] { return sensitivity_bands(core.scene, request, bands); }, whole);
  return answer;
}

std::optional<Verdict> verdict_of(const Answer& answer) {
  if (answer.nonlinear)
    return answer.nonlinear->stability ? std::optional(answer.nonlinear->stability->verdict) : std::nullopt;
  if (!answer.result.computed.stability || answer.result.rods.empty()) return std::nullopt;
  Verdict verdict = Verdict::stable;
  for (const RodResult& rod : answer.result.rods)
    if (rod.stability) verdict = worst(verdict, rod.stability->verdict);
  return verdict;
}

py::object stability_of(const RodView& rod) {
  const std::optional<Stability>& stability = rod.result().stability;
  return stability ? py::cast(StabilityView{rod.owner, &*stability, {}, rod.answer->model->scene.units.time_in_s})
                   : py::none();
}

// An attribute of the rod's stability; None where that was not computed.
template <class Value>
auto of_stability(Value value) {
  return [value](const py::object& self) -> py::object {
    const auto& stability = self.cast<const RodView&>().result().stability;
    return stability ? py::object(value(*stability, self)) : py::none();
  };
}

nlohmann::ordered_json document_of(const Answer& answer) {
  nlohmann::ordered_json document =
      answer.nonlinear ? tools::nonlinear_json(*answer.model, *answer.nonlinear, answer.settings, false)
                       : tools::steady_json(*answer.model, answer.result, answer.settings, false);
  if (!answer.nonlinear_bands.empty()) document["bands"] = tools::bands_json(document, answer.nonlinear_bands);
  if (!answer.bands.empty()) document["bands"] = tools::bands_json(document, answer.bands);
  return document;
}

// Of the answer's, those that begin with the rod's name.
std::vector<std::string> shortfalls_of(const RodView& rod) {
  std::vector<std::string> own;
  for (const std::string& sentence : rod.answer->result.shortfalls)
    if (sentence.starts_with(rod.result().name + ":")) own.push_back(sentence);
  return own;
}

// Exponents and verdict.
void add_rod_stability(py::class_<RodView>& rod) {
  rod.def_property_readonly("stability", &stability_of, "Everything known of its stability; None: not computed.")
      .def_property_readonly("exponents", of_stability([](const Stability& s, const py::object& self) {
                               return view(s.exponents, &Exponent::value, self);
                             }),
                             "Floquet exponents, 1/time, read-only; see Stability.")
      .def_property_readonly("exponent_errors", of_stability([](const Stability& s, const py::object& self) {
                               return view(s.exponents, &Exponent::error, self);
                             }),
                             "Error of each exponent, read-only.")
      .def_property_readonly("growth_rate", of_stability([](const Stability& s, const py::object&) {
                               return py::float_(s.growth_rate + 0.0);
                             }),
                             "Largest real part of the exponents, 1/time.")
      .def_property_readonly("growth_error", of_stability([](const Stability& s, const py::object&) {
                               return py::float_(s.growth_error);
                             }),
                             "Error of the growth rate.")
      .def_property_readonly(
          "verdict", of_stability([](const Stability& s, const py::object&) { return py::str(to_string(s.verdict)); }),
          "\"stable\", \"bounded\", \"unstable\" or \"undecided\"; None: not computed.");
}

// Functions of the crank angle.
void add_rod_functions(py::class_<RodView>& rod) {
  rod.def(
         "response",
         [](const RodView& rod, const py::object& angle) {
           const FourierSeries& q = solved_q(rod);
           const Angles at = angles(*rod.answer, angle);
           return shaped(values_at(q, at.phase), false, at.single);
         },
         py::arg("angle"), "q_i at crank angles in the scene's unit: (I, len(angle)).")
      .def(
          "deflection",
          [](const RodView& rod, const py::object& x, const py::object& angle) {
            return field_at(rod, x, angle, false);
          },
          py::arg("x"), py::arg("angle"),
          "Deflection at x from joint 0, (len(x), len(angle)), in the scene's unit of length; to the left positive.")
      .def(
          "bending_moment",
          [](const RodView& rod, const py::object& x, const py::object& angle) {
            return field_at(rod, x, angle, true);
          },
          py::arg("x"), py::arg("angle"), "Bending moment EJ w'' at x, (len(x), len(angle)), in the scene's units.");
}

void add_rod(py::module_& module) {
  py::class_<RodView> rod(module, "Rod", "The response and stability of one elastic link at one speed.");
  rod.def_property_readonly(
         "name", [](const RodView& rod) { return decoded(rod.result().name); }, "Its name.")
      .def_property_readonly(
          "modes", [](const RodView& rod) { return rod.result().num_modes; }, "Number of Ritz terms I.")
      .def_property_readonly(
          "converged", [](const RodView& rod) { return shortfalls_of(rod).empty(); },
          "Whether what was asked of it reached the tolerance; if not, `shortfalls` says what did not.")
      .def_property_readonly(
          "shortfalls", [](const RodView& rod) { return decoded(shortfalls_of(rod)); },
          "What missed the tolerance, a sentence each.")
      .def_property_readonly(
          "harmonics",
          [](const RodView& rod) -> py::object {
            const auto& steady = rod.result().steady;
            return steady ? py::cast(std::max<Eigen::Index>(0, steady->q.num_harmonics())) : py::none();
          },
          "Number of harmonics H; None without a steady state.")
      .def_property_readonly(
          "q",
          [](const py::object& self) -> py::object {
            const auto& steady = self.cast<const RodView&>().result().steady;
            return steady ? py::object(view(steady->q.c, self)) : py::none();
          },
          "Fourier coefficients c_n of every q_i over the crank angle, (I, H+1) complex, read-only, in the scene's\n"
          "unit of length: q_i(t) = sum_n c_n exp(i n Omega t), c_-n = conj(c_n).")
      .def_property_readonly(
          "max_abs",
          [](const py::object& self) -> py::object {
            const RodResult& rod = self.cast<const RodView&>().result();
            return rod.steady ? py::object(view(rod.max_abs, &Extremum::value, self)) : py::none();
          },
          "Largest |q_i| over the turn, (I,), read-only.")
      .def_property_readonly(
          "crank_angle",
          [](const RodView& rod) -> py::object {
            if (!rod.result().steady) return py::none();
            Eigen::VectorXd angle(static_cast<Eigen::Index>(rod.result().max_abs.size()));
            for (Eigen::Index i = 0; i < angle.size(); ++i)
              angle(i) = tools::scene_angle(rod.result().max_abs[static_cast<std::size_t>(i)].crank_angle,
                                            rod.answer->model->scene.units);
            return shaped(angle, false, true);
          },
          "Where |q_i| is largest, (I,), in the scene's unit of angle.")
      .def_property_readonly(
          "error_bound",
          [](const RodView& rod) -> py::object {
            const auto& steady = rod.result().steady;
            return steady && steady->status != SteadyStatus::singular ? py::cast(steady->error_bound) : py::none();
          },
          "Bound on max |error of q| / max |q| for this number of modes.")
      .def_property_readonly(
          "modes_error",
          [](const RodView& rod) -> py::object {
            const auto& cut = rod.result().cut;
            return cut ? py::cast(cut->deflection) : py::none();
          },
          "Estimated relative error of the deflection from cutting the Ritz series; None: not asked.")
      .def_property_readonly(
          "theory_error",
          [](const RodView& rod) {
            const auto& theory = rod.answer->result.theory;
            return theory ? optional(theory->rods[rod.rod].q) : py::none();
          },
          "By how much the linear theory itself is off, relative; None: beyond it, or not judged.")
      .def("_table", [](const RodView& rod, const std::string& what) { return table_of(rod_table(rod, what)); })
      .def_property_readonly("_owner", [](const RodView& rod) { return rod.owner; })
      .def_property_readonly("_index", [](const RodView& rod) { return rod.rod; })
      .def("__repr__", [](const RodView& rod) {
        const RodResult& result = rod.result();
        std::string text = fmt::format("<hb.Rod {}: {} modes", result.name, result.num_modes);
        if (!result.max_abs.empty()) text += fmt::format(", max |q_1| = {:.6g}", result.max_abs.front().value);
        if (result.stability) text += fmt::format(", {}", to_string(result.stability->verdict));
        return decoded(text + ">");
      });
  add_rod_stability(rod);
  add_rod_functions(rod);
}

using SeriesOf = const FourierSeries* ForceView::*;

// One number of each component over the turn.
template <class Number>
auto over_the_turn(SeriesOf series, Number number) {
  return [series, number](const ForceView& force) {
    const FourierSeries& of = *(force.*series);
    Eigen::VectorXd values(of.num_components());
    for (Eigen::Index c = 0; c < values.size(); ++c) values(c) = number(of, c);
    return shaped(values, of.num_components() == 1, true);
  };
}

double mean_square(const FourierSeries& series, Eigen::Index component) {
  return std::norm(series.c(component, 0)) + 2 * series.c.row(component).tail(series.num_harmonics()).squaredNorm();
}

void add_numbers(py::class_<ForceView>& force, const std::string& suffix, const std::string& of, SeriesOf series) {
  const auto add = [&](const char* name, const char* what, auto number) {
    const std::string doc = what + of + ": (2,); guides and torque a number.";
    force.def_property_readonly((name + suffix).c_str(), over_the_turn(series, number), doc.c_str());
  };
  add("min", "Smallest value over the turn",
      [](const FourierSeries& s, Eigen::Index c) { return fourier::range(s, c).min.value; });
  add("max", "Largest value over the turn",
      [](const FourierSeries& s, Eigen::Index c) { return fourier::range(s, c).max.value; });
  add("mean", "Mean over the turn", [](const FourierSeries& s, Eigen::Index c) { return s.c(c, 0).real(); });
  add("rms", "Root of the mean square over the turn",
      [](const FourierSeries& s, Eigen::Index c) { return std::sqrt(mean_square(s, c)); });
}

void add_force(py::module_& module) {
  py::class_<ForceView> force(module, "Force",
                              "A joint's force, or the driving torque, over the turn, in the scene's units.");
  add_numbers(force, "", "", &ForceView::elastic);
  add_numbers(force, "_rigid", " of the rigid mechanism", &ForceView::rigid);
  force
      .def_property_readonly(
          "error", [](const ForceView& f) { return optional(f.error); },
          "Estimated error of the elastic values, modes left out included; None: not known.")
      .def_property_readonly(
          "mean_theory_error", [](const ForceView& f) { return optional(f.mean_theory_error); },
          "Of the driving torque, what the first nonlinear correction changes of its mean; None: no value, not judged, "
          "or without linearisation.")
      .def(
          "elastic", [](const ForceView& f, const py::object& angle) { return force_at(f, *f.elastic, angle); },
          py::arg("angle"), "With the links' elasticity: (2, len(angle)); guides and torque (len(angle),).")
      .def(
          "rigid", [](const ForceView& f, const py::object& angle) { return force_at(f, *f.rigid, angle); },
          py::arg("angle"), "Of the rigid mechanism, shaped as elastic(angle).")
      .def_property_readonly(
          "elastic_series", [](const py::object& self) { return view(self.cast<const ForceView&>().elastic->c, self); },
          "Fourier coefficients over the crank angle, (components, harmonics + 1) complex, read-only.")
      .def_property_readonly(
          "rigid_series", [](const py::object& self) { return view(self.cast<const ForceView&>().rigid->c, self); },
          "Fourier coefficients of the rigid mechanism.");
}

}  // namespace

RodView rod_of(const py::object& answer, std::size_t rod) { return {answer, answer.cast<const Answer*>(), rod}; }

std::shared_ptr<Answer> linear_answer(const Scene& scene, const Request& request, const py::dict& arguments) {
  PythonWork work(arguments, py::none());
  constexpr bool whole = true;
  SteadyResult found = work.run([&] { return steady(scene, request); }, whole);
  auto answer = std::make_shared<Answer>();
  answer->model = std::move(found.model);
  answer->settings = std::move(found.settings);
  answer->result = std::move(static_cast<SpeedResult&>(found));
  return answer;
}

std::string Answer::json() const { return tools::json_text(document_of(*this)); }

void add_steady(py::module_& module) {
  add_rod(module);
  add_force(module);
  py::class_<Answer, std::shared_ptr<Answer>>(module, "Answer", py::dynamic_attr())
      .def_property_readonly("omega", [](const Answer& answer) { return answer.result.speed; })
      .def_property_readonly("verdict",
                             [](const Answer& answer) -> py::object {
                               const std::optional<Verdict> verdict = verdict_of(answer);
                               return verdict ? py::cast(to_string(*verdict)) : py::none();
                             })
      .def_property_readonly("shortfalls", [](const Answer& answer) { return decoded(answer.result.shortfalls); })
      .def_property_readonly("stability",
                             [](const py::object& self) -> py::object {
                               const auto& answer = self.cast<const Answer&>();
                               if (!answer.nonlinear || !answer.nonlinear->stability) return py::none();
                               return py::cast(StabilityView{
                                   self, &*answer.nonlinear->stability, {}, answer.model->scene.units.time_in_s});
                             })
      .def("rods",
           [](const py::object& self) {
             const auto& answer = self.cast<const Answer&>();
             py::dict rods;
             for (std::size_t r = 0; r < answer.result.rods.size(); ++r)
               if (answer.result.rods[r].reported) rods[decoded(answer.result.rods[r].name)] = rod_of(self, r);
             return rods;
           })
      .def("rod",
           [](const py::object& self, std::size_t rod) {
             if (rod >= self.cast<const Answer&>().result.rods.size()) throw py::index_error();
             return rod_of(self, rod);
           })
      .def("joints",
           [](const py::object& self) {
             const auto& answer = self.cast<const Answer&>();
             py::dict joints;
             if (answer.result.forces)
               for (const JointForce& joint : answer.result.forces->joints)
                 joints[decoded(joint.name)] =
                     ForceView{self, &answer, &joint.elastic, &joint.rigid, joints_error(answer.result)};
             return joints;
           })
      .def("torque",
           [](const py::object& self) -> py::object {
             const auto& answer = self.cast<const Answer&>();
             if (!answer.result.forces) return py::none();
             return py::cast(ForceView{self, &answer, &answer.result.forces->torque,
                                       &answer.result.forces->torque_rigid, torque_error(answer.result),
                                       answer.result.theory ? answer.result.theory->mean_torque : std::nullopt});
           })
      .def("json", [](const Answer& answer) { return decoded(answer.json()); })
      .def("words",
           [](const Answer& answer) {
             std::string table = answer.nonlinear ? tools::nonlinear_table(*answer.model, *answer.nonlinear)
                                                  : tools::steady_table(*answer.model, answer.result, answer.settings);
             if (!answer.bands.empty() || !answer.nonlinear_bands.empty())
               table += tools::bands_table(document_of(answer)["bands"]);
             return decoded(table);
           })
      .def("table", [](const Answer& answer, const std::string& what) { return table_of(table(answer, what)); });
  module.def("steady", &answer_of, py::arg("scene"), py::arg("arguments"));
}

}  // namespace hb::python
