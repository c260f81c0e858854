#include "tools/pictures/check_pictures.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/output/check_report.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

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
  file.rows.resize(N + 1, 1 + 3 * I);  // the first angle again at the end
  const double size = std::max(q.cwiseAbs().maxCoeff(), 1e-300);
  for (Eigen::Index j = 0; j <= N; ++j) {
    const double tau = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N);
    const Eigen::VectorXd series = fourier::evaluate(rod.steady.q, tau);
    file.rows(j, 0) = 360 * static_cast<double>(j) / static_cast<double>(N);
    for (Eigen::Index i = 0; i < I; ++i) {
      file.rows(j, 1 + 3 * i) = series(i);
      file.rows(j, 2 + 3 * i) = q(i, j % N);
      file.rows(j, 3 + 3 * i) = std::abs(series(i) - q(i, j % N)) / size;
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
      "set multiplot layout 2,1 title {} margins char 13, char 24, char 4, char 4.5 spacing char 0, char 2\n"
      "set xrange [0:360]\nset xtics 0,60,360\nset key outside right top Left reverse samplen 2\nset format x ''\nset "
      "format y '%g'\n"
      "set ylabel 'q_1{}'\n"
      "plot '{}' using 1:2 with lines lt 1 title 'harmonic balance', '' using 1:3 every {} with points lt 2 pt 6 ps "
      "0.6 "
      "title 'shooting'\n",
      figure_title(
          model.scene,
          {model.linkage() ? rod.name : "", speed_text(check.speed, model.scene), title_verdict(check.verdicts)},
          fmt::format("two independent paths: harmonic balance and {}", to_string(rod.shooting.integrator))),
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
  file.columns = {model.linkage() != nullptr ? "rpm" : "omega [rad/" + model.scene.units.time + "]"};
  const std::vector<RodCheck>& rods = checks.front().rods;
  for (const RodCheck& rod : rods)
    for (const char* what : {"q difference", "q allowed", "exponent difference", "exponent allowed", "growth rate"})
      file.columns.push_back(rod.name + " " + what);
  file.rows.resize(static_cast<Eigen::Index>(checks.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t k = 0; k < checks.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double speed = checks[k].speed;
    file.rows(row, 0) = model.linkage() != nullptr ? rpm_from_speed(speed, model.scene.units) : speed;
    for (std::size_t r = 0; r < rods.size(); ++r) {
      const RodCheck& rod = checks[k].rods[r];
      const auto column = static_cast<Eigen::Index>(1 + 5 * r);
      auto cells = file.rows.row(row).segment(column, 5);
      cells.setConstant(NAN);
      if (!rod.compared()) continue;
      cells.head(2) << rod.q.difference, rod.q.allowed;
      if (rod.exponents) cells.tail(3) << rod.exponents->difference, rod.exponents->allowed, rod.shooting.growth_rate;
    }
  }
  return file;
}

Figure range_figure(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  Figure figure;
  figure.name = "check";
  figure.commands = fmt::format(
      "set title {}\nset logscale y\nset format y '10^{{%L}}'\nset xlabel {}\n"
      "set ylabel '|difference of q| / max |q|'\nset key outside right top Left reverse samplen 2\nplot ",
      figure_title(model.scene, {check_verdict(checks)}, "harmonic balance against time integration"),
      quoted(model.linkage() != nullptr ? "crank speed [rpm]" : "omega [rad/" + model.scene.units.time + "]"));
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

}  // namespace

std::vector<Figure> write_check_tables(const SceneModel& model, const std::vector<SpeedCheck>& checks,
                                       OutputFolder& folder) {
  std::vector<Figure> figures;
  if (checks.size() > 1) {
    const CsvFile file = range_csv(model, checks);
    folder.write(file.name, csv_text(file));
    const bool any = std::any_of(checks.begin(), checks.end(), [](const SpeedCheck& check) {
      return std::any_of(check.rods.begin(), check.rods.end(),
                         [](const RodCheck& rod) { return rod.compared() && rod.q.difference > 0; });
    });
    if (any) figures.push_back(range_figure(model, checks));
  } else {
    for (const RodCheck& rod : checks.front().rods) {
      if (!rod.compared()) continue;
      const CsvFile file = curves_csv(model, checks.front(), rod);
      folder.write(file.name, csv_text(file));
      if (rod.q.difference > 0) figures.push_back(curves_figure(model, checks.front(), rod, file.name));
    }
  }
  return figures;
}

}  // namespace hb::tools
