// hb check: harmonic balance against time integration on an independent path.
#include <fmt/core.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command.hpp"
#include "tools/common_flags.hpp"
#include "tools/cross_check.hpp"
#include "tools/csv_output.hpp"
#include "tools/gnuplot.hpp"
#include "tools/json_output.hpp"
#include "tools/output_folder.hpp"
#include "tools/output_units.hpp"
#include "tools/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

struct CheckFlags {
  CommonFlags common;
  std::string integrator, time_limit;
  bool march = false;
};

CheckOptions check_options(const CheckFlags& flags) {
  CheckOptions options;
  options.march = flags.march;
  if (!flags.time_limit.empty())
    options.time_limit = number_flag("--time-limit", flags.time_limit, 1e-3, 1e6, "seconds from 0.001 to 1000000");
  const std::string& name = flags.integrator;
  if (name.empty() || name == "automatic")
    options.integrator = Integrator::automatic;
  else if (name == "adams")
    options.integrator = Integrator::adams;
  else if (name == "bdf")
    options.integrator = Integrator::bdf;
  else if (name == "collocation")
    options.integrator = Integrator::collocation;
  else
    throw UsageError(fmt::format("--integrator: found \"{}\", allowed: automatic, adams, bdf, collocation", name));
  return options;
}

// FROM, FROM + STEP, ... not beyond TO (a thousandth of a step is forgiven).
std::vector<double> speeds_of(const SpeedRange& range, const Units& units) {
  constexpr double most = 100000;
  const Speeds& speeds = range.speeds;
  const double steps = speeds.step > 0 ? std::floor((speeds.to - speeds.from) / speeds.step + 1e-3) : 0;
  if (!(steps < most)) throw UsageError(fmt::format("--rpm: found {} speeds, allowed: up to {:.0f}", steps + 1, most));
  std::vector<double> result;
  for (int k = 0; k <= static_cast<int>(steps); ++k) {
    const double value = speeds.from + k * speeds.step;
    result.push_back(range.in_rpm ? speed_from_rpm(value, units) : value);
  }
  return result;
}

// ---- JSON ----

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json exponents_json(const std::vector<Exponent>& exponents) {
  Json list = Json::array();
  for (const Exponent& e : exponents) list.push_back({number(e.value.real()), number(e.value.imag())});
  return list;
}

Json rod_json(const RodCheck& rod, double tolerance) {
  Json json;
  const auto compared = [&](const Comparison& c) { return rod.compared ? number(c.difference) : Json(); };
  json["q_difference"] = compared(rod.q);
  json["exponent_difference"] = compared(rod.exponents);
  json["agrees"] = rod.compared || rod.agrees ? Json(rod.agrees) : Json();
  json["q_allowed"] = rod.compared ? number(rod.q.allowed) : Json();
  json["exponent_allowed"] = rod.compared ? number(rod.exponents.allowed) : Json();
  json["q1_difference"] = compared(rod.q1);
  if (rod.deflection) json["deflection_difference"] = number(rod.deflection->difference);
  if (rod.marched) {
    json["marching_difference"] = number(rod.marched->difference);
    json["marching_allowed"] = number(rod.marched->allowed);
  }
  Json& series = json["harmonic_balance"];
  series = {{"tolerance", tolerance},
            {"error_bound", number(rod.steady.error_bound)},
            {"harmonics", rod.steady.num_harmonics},
            {"growth_rate", number(rod.stability.growth_rate)},
            {"growth_error", number(rod.stability.growth_error)},
            {"exponents", exponents_json(rod.stability.exponents)},
            {"verdict", to_string(rod.stability.verdict)}};
  Json& shooting = json["shooting"];
  shooting = {{"status", to_string(rod.shooting.status)},
              {"integrator", to_string(rod.shooting.integrator)},
              {"integrator_tolerance", number(rod.shooting.integrator_tolerance)},
              {"q_error", rod.shooting.orbit.q.size() > 0 ? number(rod.shooting.q_error) : Json()},
              {"growth_rate", rod.shooting.exponents.empty() ? Json() : number(rod.shooting.growth_rate)},
              {"growth_error", rod.shooting.exponents.empty() ? Json() : number(rod.shooting.growth_error)},
              {"exponents", exponents_json(rod.shooting.exponents)},
              {"verdict", to_string(rod.shooting.verdict)},
              {"segments", rod.shooting.num_segments},
              {"steps", rod.shooting.steps},
              {"evaluations", rod.shooting.evaluations},
              {"seconds", rod.shooting.seconds},
              {"predicted_seconds", number(rod.shooting.predicted_seconds)}};
  if (!rod.shooting.message.empty()) shooting["message"] = rod.shooting.message;
  if (rod.marching) {
    json["marching"] = {{"status", to_string(rod.marching->status)},
                        {"integrator", to_string(rod.marching->integrator)},
                        {"turns", rod.marching->turns},
                        {"q_error", number(rod.marching->q_error)},
                        {"steps", rod.marching->steps},
                        {"seconds", rod.marching->seconds}};
    if (!rod.marching->message.empty()) json["marching"]["message"] = rod.marching->message;
  }
  return json;
}

Json seconds_json(const std::vector<SpeedCheck>& checks, bool march) {
  double series = 0, shooting = 0, marching = 0;
  for (const SpeedCheck& check : checks) {
    series += check.seconds_harmonic_balance;
    shooting += check.seconds_shooting;
    marching += check.seconds_marching;
  }
  Json json = {{"harmonic_balance", series}, {"shooting", shooting}};
  if (march) json["marching"] = marching;
  return json;
}

Json single_json(const SceneModel& model, const SpeedCheck& check, const Settings& settings) {
  Json json;
  json["title"] = scene_name(model.scene);
  json["rpm"] = rpm_from_speed(check.speed, model.scene.units);
  json["omega"] = check.speed;
  json["agrees"] = check.agrees();
  json["rods"] = Json::object();
  for (const RodCheck& rod : check.rods) json["rods"][rod.name] = rod_json(rod, settings.tolerance);
  if (check.joints) {
    json["joints"] = {{"difference", number(check.joints->forces.difference)},
                      {"allowed", number(check.joints->forces.allowed)},
                      {"agrees", check.joints->forces.agrees()},
                      {"worst", check.joints->worst}};
    json["torque"] = {{"difference", number(check.joints->torque.difference)},
                      {"allowed", number(check.joints->torque.allowed)},
                      {"agrees", check.joints->torque.agrees()}};
  }
  return json;
}

// How far a rod is from its allowance; the worst case of a range is the largest.
double excess(const RodCheck& rod) {
  if (!rod.compared) return -1;
  return std::max(rod.q.difference / rod.q.allowed, rod.exponents.difference / rod.exponents.allowed);
}

struct WorstCase {
  const SpeedCheck* check = nullptr;
  const RodCheck* rod = nullptr;
};

WorstCase worst_case(const std::vector<SpeedCheck>& checks) {
  WorstCase worst;
  for (const SpeedCheck& check : checks)
    for (const RodCheck& rod : check.rods)
      if (rod.compared && (worst.rod == nullptr || !(excess(rod) <= excess(*worst.rod)))) worst = {&check, &rod};
  return worst;
}

Json range_json(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  Json json;
  json["title"] = scene_name(model.scene);
  json["rpm"] = Json::array();
  json["omega"] = Json::array();
  json["agrees"] = std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.agrees(); });
  json["rods"] = Json::object();
  for (const SpeedCheck& check : checks) {
    json["rpm"].push_back(rpm_from_speed(check.speed, model.scene.units));
    json["omega"].push_back(check.speed);
    for (const RodCheck& rod : check.rods) {
      Json& entry = json["rods"][rod.name];
      entry["q_difference"].push_back(rod.compared ? number(rod.q.difference) : Json());
      entry["q_allowed"].push_back(rod.compared ? number(rod.q.allowed) : Json());
      entry["exponent_difference"].push_back(rod.compared ? number(rod.exponents.difference) : Json());
      entry["exponent_allowed"].push_back(rod.compared ? number(rod.exponents.allowed) : Json());
      entry["verdict"].push_back(to_string(rod.shooting.verdict));
      entry["agrees"].push_back(rod.compared || rod.agrees ? Json(rod.agrees) : Json());
    }
    if (check.joints) {
      json["joints_difference"].push_back(number(check.joints->forces.difference));
      json["torque_difference"].push_back(number(check.joints->torque.difference));
    }
  }
  if (const WorstCase worst = worst_case(checks); worst.rod != nullptr)
    json["worst"] = {{"rpm", rpm_from_speed(worst.check->speed, model.scene.units)},
                     {"rod", worst.rod->name},
                     {"q_difference", number(worst.rod->q.difference)},
                     {"exponent_difference", number(worst.rod->exponents.difference)}};
  return json;
}

// ---- text ----

using Text = fmt::memory_buffer;

template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

void add_comparison(Text& text, const char* what, const Comparison& c) {
  add(text, "  {:<24} {:>10.2e}  {:>10.2e}  {}\n", what, c.difference, c.allowed, c.agrees() ? "agrees" : "DISAGREES");
}

void add_rod(Text& text, const RodCheck& rod, const Settings& settings, const OutputUnits& units) {
  const ShootingResult& shooting = rod.shooting;
  add(text, "\n{}\n", rod.name);
  add(text, "  harmonic balance         asked {:.1e}, bound {:.1e}, {} harmonics\n", settings.tolerance,
      rod.steady.error_bound, rod.steady.num_harmonics);
  if (shooting.status == ShootingStatus::too_expensive || shooting.orbit.q.size() == 0) {
    add(text, "  shooting                 {}: {}\n", to_string(shooting.status), shooting.message);
  } else {
    add(text, "  shooting                 asked {:.1e}, reached {:.1e}; {}, {} steps, {} segment{} a turn, {:.3g} s\n",
        std::max(settings.tolerance, 1e-9), shooting.q_error, to_string(shooting.integrator), shooting.steps,
        shooting.num_segments, shooting.num_segments == 1 ? "" : "s", shooting.seconds);
  }
  if (rod.marching) {
    add(text, "  marching from rest       {}: {}{} turns, {} steps, {:.3g} s\n", to_string(rod.marching->status),
        rod.marching->message.empty() ? "" : rod.marching->message + "; ", rod.marching->turns, rod.marching->steps,
        rod.marching->seconds);
  }
  if (!rod.compared) {
    add(text, "  {}\n",
        rod.agrees ? "both paths find no unique periodic solution: they agree"
                   : "not compared: one path has no result");
    return;
  }
  add(text, "  {:<24} {:>10}  {:>10}\n", "", "difference", "allowed");
  add_comparison(text, "q / max |q|", rod.q);
  add_comparison(text, "q' / max |q'|", rod.q1);
  if (rod.deflection) add_comparison(text, "w / max |w|", *rod.deflection);
  if (rod.marched) add_comparison(text, "q by marching / max |q|", *rod.marched);
  add_comparison(text, ("exponents" + bracketed(units.rate)).c_str(), rod.exponents);
  add(text, "  growth rate{:<13} {} and {}\n", bracketed(units.rate),
      with_error(rod.stability.growth_rate, rod.stability.growth_error),
      with_error(shooting.growth_rate, shooting.growth_error));
  add(text, "  exponents listed         {} and {}{}\n", rod.stability.exponents.size(), shooting.exponents.size(),
      shooting.some_below ? "; the others decay below what the integration resolves" : "");
  add(text, "  verdict                  {} and {}\n", to_string(rod.stability.verdict), to_string(shooting.verdict));
}

std::string single_text(const SceneModel& model, const SpeedCheck& check, const Settings& settings) {
  const OutputUnits units = output_units(model.scene);
  Text text;
  add(text, "{}, {}: harmonic balance against time integration\n", scene_name(model.scene),
      speed_text(check.speed, model.scene));
  for (const RodCheck& rod : check.rods) add_rod(text, rod, settings, units);
  if (check.joints) {
    add(text, "\njoints\n  {:<24} {:>10}  {:>10}\n", "", "difference", "allowed");
    add_comparison(text, "forces / largest", check.joints->forces);
    add_comparison(text, "torque / largest", check.joints->torque);
    add(text, "  largest difference at    {}\n", check.joints->worst);
  }
  add(text, "\ntime: harmonic balance {:.3g} s, shooting {:.3g} s", check.seconds_harmonic_balance,
      check.seconds_shooting);
  if (check.seconds_marching > 0) add(text, ", marching {:.3g} s", check.seconds_marching);
  add(text, "\n");
  return fmt::to_string(text);
}

std::string range_text(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  Text text;
  add(text, "{}: harmonic balance against time integration\n\n", scene_name(model.scene));
  add(text, "{:>10}  {:<12} {:>10} {:>10} {:>10} {:>10}  {:<10} {:<18} {}\n", "rpm", "rod", "q diff.", "allowed",
      "exp. diff.", "allowed", "verdict", "integrator", "agrees");
  for (const SpeedCheck& check : checks) {
    for (const RodCheck& rod : check.rods) {
      const double rpm = rpm_from_speed(check.speed, model.scene.units);
      if (!rod.compared) {
        add(text, "{:>10.6g}  {:<12} {}\n", rpm, rod.name,
            rod.agrees ? "both paths: no unique periodic solution" : rod.shooting.message);
        continue;
      }
      add(text, "{:>10.6g}  {:<12} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e}  {:<10} {:<18} {}\n", rpm, rod.name,
          rod.q.difference, rod.q.allowed, rod.exponents.difference, rod.exponents.allowed,
          to_string(rod.shooting.verdict), to_string(rod.shooting.integrator), rod.agrees ? "yes" : "NO");
    }
    if (check.joints)
      add(text, "{:>10}  {:<12} {:>10.2e} {:>10.2e} {:>52}{}\n", "", "joints",
          std::max(check.joints->forces.difference, check.joints->torque.difference),
          std::max(check.joints->forces.allowed, check.joints->torque.allowed), "",
          check.joints->forces.agrees() && check.joints->torque.agrees() ? "yes" : "NO");
  }
  if (const WorstCase worst = worst_case(checks); worst.rod != nullptr)
    add(text,
        "\nworst case: {} at {:.6g} rpm, q differs by {:.2e} (allowed {:.2e}), exponents by {:.2e} (allowed {:.2e})\n",
        worst.rod->name, rpm_from_speed(worst.check->speed, model.scene.units), worst.rod->q.difference,
        worst.rod->q.allowed, worst.rod->exponents.difference, worst.rod->exponents.allowed);
  const Json seconds = seconds_json(checks, false);
  add(text, "time: harmonic balance {:.3g} s, shooting {:.3g} s\n", seconds["harmonic_balance"].get<double>(),
      seconds["shooting"].get<double>());
  return fmt::to_string(text);
}

bool complete(const std::vector<SpeedCheck>& checks) {
  return std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& check) {
    return std::all_of(check.rods.begin(), check.rods.end(),
                       [](const RodCheck& rod) { return rod.compared || rod.agrees; });
  });
}

std::string closing_text(const std::vector<SpeedCheck>& checks, const SceneModel& model) {
  Text text;
  bool agree = true;
  for (const SpeedCheck& check : checks) {
    const std::string at = checks.size() > 1 ? speed_text(check.speed, model.scene) + ": " : "";
    agree = agree && check.agrees();
    for (const RodCheck& rod : check.rods)
      for (const std::string& sentence : rod.disagreements) add(text, "DISAGREES: {}{}\n", at, sentence);
    if (check.joints && !(check.joints->forces.agrees() && check.joints->torque.agrees()))
      add(text, "DISAGREES: {}joint forces or torque, largest at {}\n", at, check.joints->worst);
    for (const std::string& sentence : check.shortfalls) add(text, "NOT REACHED: {}{}\n", at, sentence);
  }
  const bool all = complete(checks);
  add(text, "{}\n",
      !agree ? "The paths DISAGREE."
      : all  ? "The paths agree within the sum of their error bars."
             : "Not everything could be compared; what could agrees within the sum of the error bars.");
  return fmt::to_string(text);
}

// ---- CSV and pictures ----

CsvFile curves_csv(const SceneModel& model, const SpeedCheck& check, const RodCheck& rod) {
  const OutputUnits units = output_units(model.scene);
  const Eigen::MatrixXd& q = rod.shooting.orbit.q;
  const Eigen::Index I = q.rows(), N = q.cols();
  CsvFile file;
  file.name = file_name("check_" + rod.name) + ".csv";
  file.comment = {fmt::format("{}, {}, {}: q by harmonic balance (HB) and by shooting with {}, and their difference",
                              scene_name(model.scene), speed_text(check.speed, model.scene), rod.name,
                              to_string(rod.shooting.integrator)),
                  fmt::format("difference: relative to the largest |q|; allowed by the error bars {}", rod.q.allowed)};
  file.columns = {"crank angle [deg]"};
  file.rows.resize(N, 1 + 3 * I);
  const double size = std::max(q.cwiseAbs().maxCoeff(), 1e-300);
  for (Eigen::Index j = 0; j < N; ++j) {
    const double tau = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N);
    const Eigen::VectorXd series = fourier::evaluate(rod.steady.q, tau);
    file.rows(j, 0) = 360 * static_cast<double>(j) / static_cast<double>(N);
    for (Eigen::Index i = 0; i < I; ++i) {
      file.rows(j, 1 + 3 * i) = series(i);
      file.rows(j, 2 + 3 * i) = q(i, j);
      file.rows(j, 3 + 3 * i) = std::abs(series(i) - q(i, j)) / size;
    }
  }
  for (Eigen::Index i = 1; i <= I; ++i) {
    file.columns.push_back(fmt::format("q_{} HB{}", i, bracketed(units.response)));
    file.columns.push_back(fmt::format("q_{} shooting{}", i, bracketed(units.response)));
    file.columns.push_back(fmt::format("q_{} |difference|", i));
  }
  return file;
}

Figure curves_figure(const SceneModel& model, const SpeedCheck& check, const RodCheck& rod, const std::string& csv) {
  const Eigen::Index I = rod.shooting.orbit.q.rows(), shown = std::min<Eigen::Index>(I, 3);
  const Eigen::Index every = std::max<Eigen::Index>(1, rod.shooting.orbit.q.cols() / 64);
  Figure figure;
  figure.name = file_name("check_" + rod.name);
  figure.height = 720;
  figure.commands = fmt::format(
      "set multiplot layout 2,1 title {} margins char 13, char 24, char 4, char 3.5 spacing char 0, char 2\n"
      "set xrange [0:360]\nset xtics 0,60,360\nset key outside right top\nset format x ''\nset format y '%g'\n"
      "set ylabel 'q_1{}'\n"
      "plot '{}' using 1:2 with lines lt 1 title 'harmonic balance', '' using 1:3 every {} with points lt 2 pt 6 ps "
      "0.6 "
      "title 'shooting'\n",
      quoted(fmt::format("{}, {}, {}: two independent paths ({})", scene_name(model.scene), rod.name,
                         speed_text(check.speed, model.scene), to_string(rod.shooting.integrator))),
      bracketed(output_units(model.scene).response), csv, every);
  figure.commands +=
      "set logscale y\nset format y '10^{%L}'\nset format x '%g'\nset xlabel 'crank angle [deg]'\n"
      "set ylabel '|difference| / max |q|'\nplot ";
  for (Eigen::Index i = 1; i <= shown; ++i)
    figure.commands += fmt::format("'{}' using 1:(${} > 0 ? ${} : NaN) with lines lt {} title 'q_{}', ", csv, 1 + 3 * i,
                                   1 + 3 * i, i, i);
  figure.commands += fmt::format(
      "{} with lines lt 7 dt 2 title 'allowed by bars'\n"
      "unset multiplot\nunset logscale y\nset format y '%g'\nunset xlabel\nunset ylabel\nset xtics autofreq\n"
      "set xrange [*:*]\nset key default\n",
      rod.q.allowed);
  return figure;
}

CsvFile range_csv(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  CsvFile file;
  file.name = "check.csv";
  file.comment = {scene_name(model.scene) +
                  ": harmonic balance against time integration; q relative to its largest, "
                  "exponents in 1/" +
                  model.scene.units.time};
  file.columns = {"rpm"};
  const std::vector<RodCheck>& rods = checks.front().rods;
  for (const RodCheck& rod : rods)
    for (const char* what : {"q difference", "q allowed", "exponent difference", "exponent allowed", "growth rate"})
      file.columns.push_back(rod.name + " " + what);
  file.rows.resize(static_cast<Eigen::Index>(checks.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t k = 0; k < checks.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    file.rows(row, 0) = rpm_from_speed(checks[k].speed, model.scene.units);
    for (std::size_t r = 0; r < rods.size(); ++r) {
      const RodCheck& rod = checks[k].rods[r];
      const auto column = static_cast<Eigen::Index>(1 + 5 * r);
      if (rod.compared)
        file.rows.row(row).segment(column, 5) << rod.q.difference, rod.q.allowed, rod.exponents.difference,
            rod.exponents.allowed, rod.shooting.growth_rate;
      else
        file.rows.row(row).segment(column, 5).setConstant(NAN);
    }
  }
  return file;
}

Figure range_figure(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  Figure figure;
  figure.name = "check";
  figure.commands = fmt::format(
      "set title {}\nset logscale y\nset format y '10^{{%L}}'\nset xlabel 'crank speed [rpm]'\n"
      "set ylabel '|difference of q| / max |q|'\nset key outside right top\nplot ",
      quoted(scene_name(model.scene) + ": harmonic balance against time integration"));
  const std::vector<RodCheck>& rods = checks.front().rods;
  for (std::size_t r = 0; r < rods.size(); ++r)
    figure.commands += fmt::format(
        "'check.csv' using 1:(${} > 0 ? ${} : NaN) with linespoints lt {} ps 0.5 title {}, "
        "'' using 1:{} with lines lt {} dt 2 title {}{}",
        2 + 5 * r, 2 + 5 * r, r + 1, quoted(rods[r].name), 3 + 5 * r, r + 1, quoted(rods[r].name + " allowed"),
        r + 1 < rods.size() ? ", " : "\n");
  figure.commands += "unset logscale y\nset format y '%g'\nunset title\nunset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

void write_output(const SceneModel& model, const std::vector<SpeedCheck>& checks, const Json& document,
                  OutputFolder& folder, bool draw) {
  folder.write("check.json", document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  std::vector<Figure> figures;
  if (checks.size() > 1) {
    const CsvFile file = range_csv(model, checks);
    folder.write(file.name, csv_text(file));
    const bool any = std::any_of(checks.begin(), checks.end(), [](const SpeedCheck& check) {
      return std::any_of(check.rods.begin(), check.rods.end(),
                         [](const RodCheck& rod) { return rod.compared && rod.q.difference > 0; });
    });
    if (any) figures.push_back(range_figure(model, checks));
  } else {
    for (const RodCheck& rod : checks.front().rods) {
      if (!rod.compared) continue;
      const CsvFile file = curves_csv(model, checks.front(), rod);
      folder.write(file.name, csv_text(file));
      if (rod.q.difference > 0) figures.push_back(curves_figure(model, checks.front(), rod, file.name));
    }
  }
  draw_figures(figures, folder, draw);
  folder.commit();
}

int run_check(const CheckFlags& flags) {
  Scene scene = read_scene(flags.common.scene_file, overrides(flags.common));
  const Settings options = settings(flags.common, scene);
  const CheckOptions check_with = check_options(flags);
  const std::vector<double> speeds = speeds_of(speed_range(flags.common, scene), scene.units);
  std::optional<OutputFolder> folder;
  if (options.out) folder.emplace(*options.out);

  const SceneModel model = make_model(std::move(scene), options);
  std::vector<SpeedCheck> checks;
  for (const double speed : speeds) checks.push_back(cross_check(model, speed, options, check_with));

  Json document = checks.size() > 1 ? range_json(model, checks) : single_json(model, checks.front(), options);
  document["seconds"] = seconds_json(checks, check_with.march);
  if (folder) write_output(model, checks, document, *folder, options.plots);
  if (options.json)
    print_json(document);
  else
    fmt::print("{}{}", checks.size() > 1 ? range_text(model, checks) : single_text(model, checks.front(), options),
               closing_text(checks, model));
  const bool agree = std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.agrees(); });
  const bool reached =
      std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.shortfalls.empty(); });
  return !agree ? exit_failed : reached ? exit_ok : exit_not_reached;
}

}  // namespace

void add_check_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "check", "cross-check against time integration on an independent path; exit 1 when they disagree");
  const auto flags = std::make_shared<CheckFlags>();
  add_scene_flags(*command, flags->common);
  add_analysis_flags(*command, flags->common);
  command->add_option("--integrator", flags->integrator, "automatic, adams, bdf (CVODE) or collocation (Radau)")
      ->type_name("NAME");
  command->add_option("--time-limit", flags->time_limit, "seconds for each rod and speed; default 60")
      ->type_name("SECONDS");
  command->add_flag("--march", flags->march, "also march from rest until the transient has died out");
  command->callback([flags, &status] { status = run_check(*flags); });
}

}  // namespace hb::tools
