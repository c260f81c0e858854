#include "tools/pictures/figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"

namespace hb::tools {
namespace {

std::string amplitude_meaning(const SceneModel& model) {
  return model.linkage() ? "q_i: amplitude of sin(iπx/l)" : "q_i: unknowns of the system";
}

std::string truncated_note(Eigen::Index num_modes) {
  return num_modes > max_panels ? fmt::format(" (first {} of {} modes)", max_panels, num_modes) : "";
}

}  // namespace

Figure response_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const std::string& csv,
                       const MeasuredOverlay& measured) {
  const Eigen::Index I = rod.num_modes, panels = std::min(I, max_panels);
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= panels; ++i) names.push_back(fmt::format("q_{} {}", i, rod.name));
  const std::string unit = bracketed(output_units(model.scene).response);
  Figure figure;
  figure.name = figure_name("response", rod.name);
  figure.height = static_cast<int>(140 + (panels == 1 ? 300 : 130 * panels));
  figure.commands = fmt::format(
      "set multiplot layout {},1 title {} margins char 17, char 3, char 4, char 5.5 spacing char 0, char 1.4\n"
      "unset key\n{}set format y '%g'\nset ytics autofreq\nset format x ''\n",
      panels,
      rod_title(model, result, rod,
                amplitude_meaning(model) + ", periodic response" + truncated_note(I) + measured.note(names)),
      turn_axis);
  for (Eigen::Index i = 1; i <= panels; ++i) {
    if (i == panels) figure.commands += std::string("set format x '%g'\n") + turn_label(model);
    figure.commands += fmt::format(
        "set label 1 'q_{{{0}}}{1}' at screen 0.06, graph 0.5 center rotate\n"
        "stats '{2}' using {3} nooutput\n"
        "set ytics autofreq; r = STATS_max - STATS_min; if (r > 0) {{ set ytics nice(r/3) }}\n"
        "plot '{2}' using 1:{3} with lines lt 1{4}\n",
        i, unit, csv, 1 + i, measured.layer(names[static_cast<std::size_t>(i) - 1]));
  }
  figure.commands +=
      "unset multiplot\nunset label\nset ytics autofreq\nunset xlabel\nset xtics autofreq\nset xrange [*:*]\nset key\n";
  return figure;
}

Figure phase_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const std::string& csv) {
  const Eigen::Index I = rod.num_modes, panels = std::min(I, max_panels);
  const Eigen::Index columns = panels == 1 ? 1 : panels <= 4 ? 2 : 3, rows = (panels + columns - 1) / columns;
  const OutputUnits units = output_units(model.scene);
  const std::string rate = bracketed((units.response.empty() ? "1" : units.response) + "/" + units.time);
  Figure figure;
  figure.name = figure_name("phase", rod.name);
  figure.width = static_cast<int>(columns == 1 ? 760 : 400 * columns);
  figure.height = static_cast<int>(110 + (columns == 1 ? 440 : 330 * rows));
  figure.commands = fmt::format(
      "set multiplot layout {},{} title {}\nunset key\nset format '%g'\nset xtics autofreq\nset tmargin 2\n", rows,
      columns,
      rod_title(model, result, rod,
                amplitude_meaning(model) + ", phase trajectories; dot: angle 0" + truncated_note(I)));
  for (Eigen::Index i = 1; i <= panels; ++i) {
    figure.commands += fmt::format(
        "set xlabel 'q_{{{0}}}{1}'\nset ylabel 'dq_{{{0}}}/dt{2}'\n"
        "stats '{3}' using {4} nooutput\n"
        "r = STATS_max - STATS_min; if (r > 0) {{ set xtics nice(r/2) }}\n"
        "plot '{3}' using {4}:{5} with lines lt 1, '' using {4}:{5} every ::0::0 with points lt 2 pt 7 ps 0.9\n",
        i, bracketed(units.response), rate, csv, 1 + i, 1 + I + i);
  }
  figure.commands += "unset multiplot\nset tmargin -1\nunset xlabel\nunset ylabel\nset xtics autofreq\nset key\n";
  return figure;
}

Figure spectrum_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                       const std::string& csv) {
  const Eigen::Index I = rod.num_modes, shown = std::min(I, max_panels);
  const FourierSeries& q = rod.steady->q;
  const double largest = q.c.size() == 0 ? 0 : 2 * q.c.cwiseAbs().maxCoeff();
  const std::string units = output_units(model.scene).response;
  Figure figure;
  figure.name = figure_name("spectrum", rod.name);
  figure.commands = fmt::format(
      "set title {}\nset xlabel 'harmonic n of {} (frequency n × {:.4g} Hz)'\n"
      "set ylabel 'amplitude |c_0|, 2|c_n| of q_i{}'\n"
      "set key outside right top Left reverse samplen 2\nset format y '10^{{%T}}'\nset logscale y\n"
      "set xrange [-0.5:{}]\nset xtics autofreq\n",
      rod_title(model, result, rod, amplitude_meaning(model) + ", spectrum" + truncated_note(I)),
      model.linkage() ? "the crank speed" : "Ω", result.speed / (2 * std::numbers::pi) / model.scene.units.time_in_s,
      bracketed(output_units(model.scene).response),
      static_cast<double>(std::max<Eigen::Index>(1, q.num_harmonics())) + 0.5);
  if (largest > 0) {
    double max_abs = 0;
    for (const Extremum& peak : rod.max_abs) max_abs = std::max(max_abs, peak.value);
    // Grey: amplitudes that the error bound does not vouch for, down to rounding.
    const double bound = std::min(rod.steady->error_bound * max_abs, largest), bottom = 1e-17 * largest;
    figure.commands += fmt::format("set yrange [{}:{}]\n", bottom, 3 * largest);
    if (bound > bottom)
      figure.commands += fmt::format(
          "set object 1 rectangle from graph 0, first {} to graph 1, first {} fillcolor '#ececec' fillstyle solid "
          "noborder behind\n"
          "set label 1 'below the error bound of q, {:.1e}{}' at graph 0.02, first {} offset 0, -0.7 "
          "font ',11' textcolor '#666666' front\n",
          bottom, bound, bound, literal(units.empty() ? "" : " " + units), bound);
  }
  figure.commands += "plot ";
  for (Eigen::Index i = 1; i <= shown; ++i) {
    figure.commands += fmt::format("{}'{}' using 1:{} with linespoints lt {} ps 0.6 title 'q_{{{}}}'",
                                   i == 1 ? "" : ", ", csv, 1 + 3 * i, i, i);
  }
  figure.commands +=
      "\nunset logscale y\nunset object\nunset label\nset yrange [*:*]\nset xrange [*:*]\nset format y '%g'\nunset "
      "title\n"
      "unset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

Figure shape_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const CsvFile& csv,
                    bool moment) {
  const OutputUnits units = output_units(model.scene);
  Figure figure;
  figure.name = figure_name(moment ? "bending_moment" : "deflection", rod.name);
  const RodPeak& peak = moment ? rod.shape->bending_moment : rod.shape->deflection;
  const std::string largest =
      fmt::format("largest |{}| = {:.4g} {} at x = {:.4g} {}, crank angle {:.1f} deg", moment ? "M" : "w",
                  peak.max_abs * (moment ? units.moment : 1), moment ? "N m" : units.length, peak.x, units.length,
                  peak.crank_angle * degrees_per_radian);
  figure.commands = fmt::format(
      "set title {}\nset xlabel 'x from joint 0 to joint 1 [{}]'\nset ylabel '{}'\n"
      "set key outside right center Left reverse samplen 2 title 'crank angle'\n"
      "set xrange [0:{}]\nset format '%g'\nset xtics autofreq\n"
      "plot '{}' using 1:2:3 with filledcurves fillcolor '#e8e8e8' title 'whole turn'",
      rod_title(model, result, rod, largest), units.length,
      moment ? "bending moment M = EJ ∂²w/∂x² [N m]" : "deflection w, to the left positive [" + units.length + "]",
      csv.rows(csv.rows.rows() - 1, 0), csv.name);
  for (int k = 0; k < shape_angles; ++k) {
    // Hue goes round with the crank; lightness is held down so that yellow stays readable.
    figure.commands +=
        fmt::format(", '' using 1:{} with lines linewidth 1.4 linecolor rgb hsv2rgb({:.4f}, 0.9, 0.75) title '{} deg'",
                    4 + k, static_cast<double>(k) / shape_angles, 360 * k / shape_angles);
  }
  figure.commands += "\nset xrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key default\nset key title ''\n";
  return figure;
}

Figure stress_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const std::string& csv) {
  Figure figure;
  figure.name = figure_name("stress", rod.name);
  figure.commands = fmt::format(
      "set title {}\nset xlabel 'x from joint 0 to joint 1 [{}]'\nset ylabel 'stress [MPa]'\n"
      "set key outside right center Left reverse samplen 2\n"
      "plot '{}' using 1:2:3 with filledcurves fillcolor '#cfe3f2' notitle, '' using 1:2 with lines lt 1 title 'right "
      "fibre', '' using 1:3 with lines lt 1 notitle, '' using 1:4 with lines lt 2 dashtype 2 title 'left fibre', '' "
      "using 1:5 with lines lt 2 dashtype 2 notitle\n"
      "unset title\nunset xlabel\nunset ylabel\nset key default\n",
      rod_title(model, result, rod, "axial and bending stress together, smallest and largest over the turn"),
      output_units(model.scene).length, csv);
  return figure;
}

}  // namespace hb::tools
