#include "tools/figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/output_folder.hpp"
#include "tools/output_units.hpp"
#include "tools/wording.hpp"

namespace hb::tools {
namespace {

constexpr const char* turn_axis = "set xrange [0:360]\nset xtics 0,60,360\n";

// The axis of a turn: the crank's angle, or the phase of a [hill] system.
std::string turn_label(const SceneModel& model) {
  return model.linkage() ? "set xlabel 'crank angle [deg]'\n" : "set xlabel 'phase Ωt [deg]'\n";
}

std::string verdict_text(const RodResult& rod) {
  if (!rod.stability) return "";
  switch (rod.stability->verdict) {
    case Verdict::stable:
      return ", stable";
    case Verdict::unstable:
      return ", UNSTABLE: would not be seen in a machine";
    case Verdict::undecided:
      break;
  }
  return ", stability undecided";
}

// The scene's name, short enough for a title.
std::string short_name(const Scene& scene) {
  constexpr std::size_t longest = 48;  // bytes
  std::string name = scene_name(scene);
  if (name.size() <= longest) return name;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;  // not inside a UTF-8 character
  return name.substr(0, end) + "...";
}

std::string verdicts_text(const SpeedResult& result) {
  std::string text;
  bool same = true;
  const RodResult* first = nullptr;
  for (const RodResult& rod : result.rods) {
    if (!rod.stability) continue;
    if (!first) first = &rod;
    same = same && rod.stability->verdict == first->stability->verdict;
    text += ", " + rod.name + " " + to_string(rod.stability->verdict);
  }
  return first && same ? std::string(", ") + to_string(first->stability->verdict) : text;
}

// First line in bold: scene, rod, speed, verdict; second: what is shown (enhanced markup).
std::string title(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const std::string& shown) {
  const std::string subject = model.linkage() ? ", " + rod.name : "";
  return "'{/:Bold " + literal(short_name(model.scene) + subject + ", " + speed_text(result.speed, model.scene)) +
         literal(verdict_text(rod)) + "}\\n" + shown + "'";
}

// gnuplot reads \n only in double quotes: break the single-quoted title there.
std::string broken(const std::string& text) {
  const std::size_t at = text.find("\\n");
  return at == std::string::npos ? text : text.substr(0, at) + "'.\"\\n\".'" + text.substr(at + 2);
}

std::string amplitude_meaning(const SceneModel& model) {
  return model.linkage() ? "q_i: amplitude of sin(iπx/l)" : "q_i: unknowns of the system";
}

std::string truncated_note(Eigen::Index num_modes) {
  return num_modes > max_panels ? fmt::format(" (first {} of {} modes)", max_panels, num_modes) : "";
}

// The part of the line through `point` along the unit vector u that lies in a box which it crosses.
std::pair<std::complex<double>, std::complex<double>> inside_box(std::complex<double> point, std::complex<double> u,
                                                                 std::complex<double> low, std::complex<double> high) {
  double from = -std::numeric_limits<double>::infinity(), to = -from;
  const auto cut = [&](double p, double v, double lower, double upper) {
    if (std::abs(v) < 1e-12) return;
    const double a = (lower - p) / v, b = (upper - p) / v;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  cut(point.real(), u.real(), low.real(), high.real());
  cut(point.imag(), u.imag(), low.imag(), high.imag());
  return {point + from * u, point + to * u};
}

std::string figure_name(const std::string& kind, const std::string& name) { return file_name(kind + "_" + name); }

}  // namespace

Figure response_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod,
                       const std::string& csv) {
  const Eigen::Index I = rod.num_modes, panels = std::min(I, max_panels);
  const std::string unit = bracketed(output_units(model.scene).response);
  Figure figure;
  figure.name = figure_name("response", rod.name);
  figure.height = static_cast<int>(140 + (panels == 1 ? 300 : 130 * panels));
  figure.commands = fmt::format(
      "set multiplot layout {},1 title {} margins char 17, char 3, char 4, char 4.5 spacing char 0, char 1.4\n"
      "unset key\n{}set format y '%g'\nset ytics autofreq\nset format x ''\n",
      panels, broken(title(model, result, rod, amplitude_meaning(model) + ", periodic response" + truncated_note(I))),
      turn_axis);
  for (Eigen::Index i = 1; i <= panels; ++i) {
    if (i == panels) figure.commands += std::string("set format x '%g'\n") + turn_label(model);
    figure.commands += fmt::format(
        "set label 1 'q_{{{0}}}{1}' at screen 0.06, graph 0.5 center rotate\n"
        "stats '{2}' using {3} nooutput\n"
        "set ytics autofreq; r = STATS_max - STATS_min; if (r > 0) {{ set ytics nice(r/3) }}\n"
        "plot '{2}' using 1:{3} with lines lt 1\n",
        i, unit, csv, 1 + i);
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
      broken(title(model, result, rod,
                   amplitude_meaning(model) + ", phase trajectories; dot: angle 0" + truncated_note(I))));
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
  Figure figure;
  figure.name = figure_name("spectrum", rod.name);
  figure.commands = fmt::format(
      "set title {}\nset xlabel 'harmonic n of the crank speed'\nset ylabel 'amplitude |c_0|, 2|c_n| of q_i{}'\n"
      "set key outside right top Left reverse samplen 2\nset format y '10^{{%T}}'\nset logscale y\n"
      "set xrange [-0.5:{}]\nset xtics autofreq\n",
      broken(title(model, result, rod, amplitude_meaning(model) + ", spectrum" + truncated_note(I))),
      bracketed(output_units(model.scene).response),
      static_cast<double>(std::max<Eigen::Index>(1, q.num_harmonics())) + 0.5);
  // What lies below rounding says nothing.
  if (largest > 0) figure.commands += fmt::format("set yrange [{}:{}]\n", 1e-17 * largest, 3 * largest);
  figure.commands += "plot ";
  for (Eigen::Index i = 1; i <= shown; ++i) {
    figure.commands += fmt::format("{}'{}' using 1:{} with linespoints lt {} ps 0.6 title 'q_{{{}}}'",
                                   i == 1 ? "" : ", ", csv, 1 + 3 * i, i, i);
  }
  figure.commands +=
      "\nunset logscale y\nset yrange [*:*]\nset xrange [*:*]\nset format y '%g'\nunset title\n"
      "unset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

Figure shape_figure(const SceneModel& model, const SpeedResult& result, const RodResult& rod, const CsvFile& csv,
                    bool moment) {
  const OutputUnits units = output_units(model.scene);
  Figure figure;
  figure.name = figure_name(moment ? "bending_moment" : "deflection", rod.name);
  figure.commands = fmt::format(
      "set title {}\nset xlabel 'x from joint 0 [{}]'\nset ylabel '{}'\n"
      "set key outside right center Left reverse samplen 2 title 'crank angle'\n"
      "set xrange [0:{}]\nset format '%g'\nset xtics autofreq\n"
      "plot '{}' using 1:2:3 with filledcurves fillcolor '#e8e8e8' title 'envelope'",
      broken(
          title(model, result, rod,
                moment ? "bending moment EJ∂²w/∂x² along the rod" : "deflection w across the rod, along its length")),
      units.length, moment ? "bending moment [N m]" : "w [" + units.length + "]", csv.rows(csv.rows.rows() - 1, 0),
      csv.name);
  for (int k = 0; k < shape_angles; ++k) {
    // Hue goes round with the crank; lightness is held down so that yellow stays readable.
    figure.commands +=
        fmt::format(", '' using 1:{} with lines linewidth 1.4 linecolor rgb hsv2rgb({:.4f}, 0.9, 0.75) title '{} deg'",
                    4 + k, static_cast<double>(k) / shape_angles, 360 * k / shape_angles);
  }
  figure.commands += "\nset xrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key default\nset key title ''\n";
  return figure;
}

std::vector<Figure> force_figures(const SceneModel& model, const SpeedResult& result, const std::string& csv) {
  const Linkage& linkage = *model.linkage();
  // Joints of one picture: those of the bodies of a dyad; the crank has its own.
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const int dyad = static_cast<int>(d);
    groups.push_back(
        {linkage.dyads[d].coupler.name, {linkage.dyads[d].coupler.name, body_name(linkage, closing_index(dyad))}});
  }
  groups.push_back({linkage.crank.body.name, {linkage.crank.body.name}});

  std::vector<Figure> figures;
  for (const auto& [name, bodies] : groups) {
    std::string panels;
    int num_rows = 0;
    int column = 2;
    for (const JointForce& joint : result.forces->joints) {
      const int components = static_cast<int>(joint.rigid.num_components());
      const std::string body = joint.name.substr(0, joint.name.find('.'));
      if (std::find(bodies.begin(), bodies.end(), body) != bodies.end()) {
        ++num_rows;
        for (int c = 0; c < components; ++c) {
          const char* component = components == 1 ? "n" : c == 0 ? "x" : "y";
          panels += fmt::format(
              "stats '{2}' using {3} nooutput\nlow = STATS_min; high = STATS_max\nstats '{2}' using {4} nooutput\n"
              "r = (high > STATS_max ? high : STATS_max) - (low < STATS_min ? low : STATS_min); if (r > 0) {{ set "
              "ytics nice(r/3) }}\n"
              "set ylabel '{0} {1} [N]'\nplot '{2}' using 1:{3} with lines lt 1 title 'elastic', "
              "'' using 1:{4} with lines lt 2 dashtype 2 title 'rigid'\nunset key\n",
              literal(joint.name), component, csv, column + 2 * c, column + 2 * c + 1);
        }
        if (components == 1) panels += "set multiplot next\n";
      }
      column += 2 * components;
    }
    if (num_rows == 0) continue;
    std::vector<std::string> own_frames = elastic_rockers(linkage);
    std::erase_if(own_frames, [&](const std::string& rocker) { return rocker != bodies.back(); });
    Figure figure;
    figure.name = figure_name("forces", name);
    figure.width = 1000;
    figure.height = 130 + 230 * num_rows;
    figure.commands = fmt::format(
        "set multiplot layout {},2 title {}\nset tmargin 2.2\nset key at graph 1, graph 1.02 right bottom horizontal "
        "samplen 3\n{}{}"
        "set ytics autofreq\n{}unset multiplot\nset tmargin -1\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset "
        "xtics autofreq\n"
        "set key default\n",
        num_rows,
        broken("'{/:Bold " +
               literal(short_name(model.scene) + ", " + speed_text(result.speed, model.scene) + verdicts_text(result)) +
               "}\\njoint forces of " + literal(name) + ": " + literal(force_frames(own_frames)) + "'"),
        turn_axis, turn_label(model), panels);
    figures.push_back(std::move(figure));
  }
  return figures;
}

Figure torque_figure(const SceneModel& model, const SpeedResult& result, const std::string& csv) {
  Figure figure;
  figure.name = "torque";
  figure.commands = fmt::format(
      "set title {}\n{}{}set ylabel 'driving torque [N m]'\nset key outside right top Left reverse samplen 3\n"
      "plot '{}' using 1:2 with lines lt 1 title 'elastic', '' using 1:3 with lines lt 2 dashtype 2 title 'rigid'\n"
      "unset title\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset xtics autofreq\nset key default\n",
      "'{/:Bold " +
          literal(short_name(model.scene) + ", " + speed_text(result.speed, model.scene) + verdicts_text(result)) +
          "}'",
      turn_axis, turn_label(model), csv);
  return figure;
}

Figure mechanism_figure(const Scene& scene, const CsvFile& csv) {
  constexpr int poses = 12;
  const Linkage& linkage = std::get<Linkage>(scene.model);
  const std::vector<TracedPoint> points = traced_points(linkage);
  const Eigen::Index num_angles = csv.rows.rows() - 1;
  const auto x_of = [](std::size_t k) { return 2 + 2 * static_cast<int>(k); };  // gnuplot column

  // Lines that draw a body: joint 0 - joint 1, and out to its points.
  struct Stroke {
    std::size_t from, to;
    int body;
  };
  std::vector<Stroke> strokes;
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::vector<std::size_t> same;
    for (std::size_t m = 0; m < k; ++m) {
      if (points[m].body == points[k].body) same.push_back(m);
    }
    // Joint 1 to joint 0; a further point to both (a triangle).
    for (std::size_t m = 0; m < std::min<std::size_t>(same.size(), 2); ++m) {
      strokes.push_back({same[m], k, points[k].body});
    }
  }

  const Eigen::MatrixXd& rows = csv.rows;
  double low_x = rows(0, 1), high_x = low_x, low_y = rows(0, 2), high_y = low_y;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto column = 1 + 2 * static_cast<Eigen::Index>(k);
    low_x = std::min(low_x, rows.col(column).minCoeff());
    high_x = std::max(high_x, rows.col(column).maxCoeff());
    low_y = std::min(low_y, rows.col(column + 1).minCoeff());
    high_y = std::max(high_y, rows.col(column + 1).maxCoeff());
  }
  const double margin = 0.08 * std::max(high_x - low_x, high_y - low_y);
  low_x -= margin, high_x += margin, low_y -= margin, high_y += margin;

  Figure figure;
  figure.name = "mechanism";
  const double aspect = (high_y - low_y) / (high_x - low_x);
  figure.width = 960;
  figure.height = static_cast<int>(std::clamp(110 + 700 * aspect, 320.0, 1100.0));
  figure.commands = fmt::format(
      "set title {}\nset size ratio -1\nset xrange [{}:{}]\nset yrange [{}:{}]\nset xtics autofreq\nset ytics "
      "autofreq\n"
      "set xlabel 'x [{}]'\nset ylabel 'y [{}]'\nset key outside right top Left reverse samplen 2\nset format '%g'\n",
      broken("'{/:Bold " + literal(short_name(scene)) +
             fmt::format("}}\\nmechanism over one turn: crank angle 0 dark, every {} deg light, paths of the joints'",
                         360 / poses)),
      low_x, high_x, low_y, high_y, scene.units.length, scene.units.length);

  std::string plot;
  const auto add = [&](const std::string& curve) { plot += (plot.empty() ? "plot " : ", ") + curve; };
  // Guides of sliders, behind everything.
  int label = 1;
  std::string labels;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    if (const auto* slider = std::get_if<Slider>(&linkage.dyads[d].closing)) {
      const auto [from, to] =
          inside_box(slider->guide, std::polar(1.0, slider->direction), {low_x, low_y}, {high_x, high_y});
      labels += fmt::format("set arrow {} from {},{} to {},{} nohead dashtype 4 linecolor '#888888' linewidth 0.8\n",
                            label++, from.real(), from.imag(), to.real(), to.imag());
    }
  }
  for (const Stroke& stroke : strokes) {
    add(fmt::format(
        "'{}' using {}:{}:(${}-${}):(${}-${}) every {} with vectors nohead linewidth 0.7 linecolor '#c4ccd4' notitle",
        csv.name, x_of(stroke.from), x_of(stroke.from) + 1, x_of(stroke.to), x_of(stroke.from), x_of(stroke.to) + 1,
        x_of(stroke.from) + 1, num_angles / poses));
  }
  // Paths of what moves; a coupler's joint 0 is the point it hangs on, its joint 1 the closing body's joint.
  int colour = 1;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool repeats =
        std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(k), [&](const TracedPoint& p) {
          const auto a = 1 + 2 * static_cast<Eigen::Index>(&p - points.data()),
                     b = 1 + 2 * static_cast<Eigen::Index>(k);
          return (rows.middleCols(a, 2) - rows.middleCols(b, 2)).cwiseAbs().maxCoeff() <= 1e-9 * margin;
        });
    if (points[k].fixed || repeats) continue;
    add(fmt::format("'{}' using {}:{} with lines lt {} linewidth 1.2 title '{}'", csv.name, x_of(k), x_of(k) + 1,
                    1 + (colour++ - 1) % 6, literal(points[k].name)));
  }
  for (const Stroke& stroke : strokes) {
    const bool elastic = [&] {
      const Body* body = body_at(linkage, stroke.body);
      return body != nullptr && body->elastic.has_value();
    }();
    add(fmt::format(
        "'{}' using {}:{}:(${}-${}):(${}-${}) every ::0::0 with vectors nohead linewidth {} linecolor '{}' notitle",
        csv.name, x_of(stroke.from), x_of(stroke.from) + 1, x_of(stroke.to), x_of(stroke.from), x_of(stroke.to) + 1,
        x_of(stroke.from) + 1, elastic ? 2.0 : 3.0, elastic ? "#b03060" : "#333333"));
  }
  bool any_elastic = false;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Body* body = body_at(linkage, points[k].body);
    const bool is_slider = body == nullptr && points[k].point == std::complex<double>(0);
    const char* style = points[k].fixed ? "pointtype 9 pointsize 1.6"
                        : is_slider     ? "pointtype 5 pointsize 1.8"
                                        : "pointtype 7 pointsize 0.8";
    add(fmt::format("'{}' using {}:{} every ::0::0 with points {} linecolor '{}' notitle", csv.name, x_of(k),
                    x_of(k) + 1, style, is_slider ? "#666666" : "#222222"));
    // A link's name stands beside its middle at crank angle 0.
    if (body != nullptr && k > 0 && points[k - 1].body == points[k].body &&
        (k < 2 || points[k - 2].body != points[k].body)) {
      any_elastic = any_elastic || body->elastic.has_value();
      const auto a = 1 + 2 * static_cast<Eigen::Index>(k - 1), b = 1 + 2 * static_cast<Eigen::Index>(k);
      const std::complex<double> from(rows(0, a), rows(0, a + 1)), to(rows(0, b), rows(0, b + 1));
      // Beside the line, away from the body's further points.
      double side = 1;
      for (const auto& [name, point] : body->points) side = point.imag() > 0 ? -1 : 1;
      const std::complex<double> normal = (to - from) / std::abs(to - from) * std::complex<double>(0, side);
      const std::complex<double> at = (from + to) / 2.0 + 0.045 * (high_x - low_x) * normal;
      labels += fmt::format("set label {} {} at {},{} center font ',11' textcolor '{}' front\n", label++,
                            quoted(body->name), at.real(), at.imag(), body->elastic ? "#b03060" : "#333333");
    } else if (is_slider) {
      const auto a = 1 + 2 * static_cast<Eigen::Index>(k);
      labels += fmt::format("set label {} {} at {},{} offset 0.6,1.2 font ',11' textcolor '#333333' front\n", label++,
                            quoted(points[k].name), rows(0, a), rows(0, a + 1));
    }
  }
  if (any_elastic) add("NaN with lines linewidth 2 linecolor '#b03060' title 'elastic link'");
  figure.commands += labels + plot +
                     "\nunset label\nunset arrow\nset size noratio\nset xrange [*:*]\nset yrange [*:*]\n"
                     "unset title\nunset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

}  // namespace hb::tools
