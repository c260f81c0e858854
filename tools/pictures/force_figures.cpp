// Joint forces and driving torque over the turn, elastic beside rigid.
#include <fmt/core.h>

#include <algorithm>

#include "hb/analysis/bearing_load.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/figures.hpp"

namespace hb::tools {
namespace {

double largest_change(const FourierSeries& elastic, const FourierSeries& rigid) {
  const FourierSeries change = fourier::difference(elastic, rigid);
  double largest = 0;
  for (Eigen::Index c = 0; c < change.num_components(); ++c)
    largest = std::max(largest, fourier::max_abs(change, c).value);
  return largest;
}

// Joints of one picture: those of the bodies of a dyad; the crank has its own.
std::vector<std::pair<std::string, std::vector<std::string>>> groups_of(const Linkage& linkage) {
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const int dyad = static_cast<int>(d);
    groups.push_back(
        {linkage.dyads[d].coupler.name, {linkage.dyads[d].coupler.name, body_name(linkage, closing_index(dyad))}});
  }
  groups.push_back({linkage.crank.body.name, {linkage.crank.body.name}});
  return groups;
}

// Both axes from -limit to limit, so that a turn of the force is a turn in the picture.
std::string square_axes(const JointForce& joint, double factor) {
  const double limit =
      1.1 * factor * std::max(fourier::largest_length(joint.elastic).value, fourier::largest_length(joint.rigid).value);
  if (!(limit > 0)) return "set xrange [-1:1]\nset yrange [-1:1]\n";
  return fmt::format("set xrange [{0}:{1}]\nset yrange [{0}:{1}]\nset xtics nice({1}/2)\nset ytics nice({1}/2)\n",
                     -limit, limit);
}

}  // namespace

std::vector<Figure> polar_figures(const SceneModel& model, const SpeedResult& result, const std::string& csv) {
  const double factor = output_units(model.scene).force;
  std::vector<Figure> figures;
  for (const auto& [name, bodies] : groups_of(*model.linkage())) {
    std::string panels;
    int num_panels = 0, column = 2;
    for (const JointForce& joint : result.forces->joints) {
      const int components = static_cast<int>(joint.rigid.num_components());
      const std::string body = joint.name.substr(0, joint.name.find('.'));
      if (components == 2 && std::find(bodies.begin(), bodies.end(), body) != bodies.end()) {
        ++num_panels;
        panels += fmt::format(
            "{0}set xlabel '{1} x [N]'\nset ylabel '{1} y [N]'\nplot '{2}' using {3}:{4} with lines lt 1 title "
            "'elastic', '' using {5}:{6} with lines lt 2 dashtype 2 title 'rigid', '' using {3}:{4} every ::0::0 with "
            "points lt 1 pointtype 7 notitle\nunset key\n",
            square_axes(joint, factor), literal(joint.name), csv, column, column + 2, column + 1, column + 3);
      }
      column += 2 * components;
    }
    if (num_panels == 0) continue;
    Figure figure;
    figure.name = figure_name("polar", name);
    figure.width = 160 + 380 * num_panels;
    figure.height = 520;
    figure.commands = fmt::format(
        "set multiplot layout 1,{} title {}\nset size ratio 1\nset tmargin 2.2\nset key at graph 1, graph 1.02 right "
        "bottom horizontal Left reverse samplen 3\n{}unset multiplot\nset size noratio\nset tmargin -1\nunset "
        "xlabel\nunset "
        "ylabel\nset xrange [*:*]\nset yrange [*:*]\nset xtics autofreq\nset ytics autofreq\nset key default\n",
        num_panels, scene_title(model, result, "joint forces as vectors over the turn; dot: crank angle 0"), panels);
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::vector<Figure> force_figures(const SceneModel& model, const SpeedResult& result, const std::string& csv,
                                  const MeasuredOverlay& measured) {
  std::vector<Figure> figures;
  for (const auto& [name, bodies] : groups_of(*model.linkage())) {
    std::string panels;
    int num_rows = 0;
    int column = 2;
    double change = 0;  // of any component
    for (const JointForce& joint : result.forces->joints) {
      const int components = static_cast<int>(joint.rigid.num_components());
      const std::string body = joint.name.substr(0, joint.name.find('.'));
      if (std::find(bodies.begin(), bodies.end(), body) != bodies.end()) {
        ++num_rows;
        change = std::max(change, largest_change(joint.elastic, joint.rigid));
        for (int c = 0; c < components; ++c) {
          const char* component = components == 1 ? "n" : c == 0 ? "x" : "y";
          panels += fmt::format(
              "stats '{2}' using {3} nooutput\nlow = STATS_min; high = STATS_max\nstats '{2}' using {4} nooutput\n"
              "r = (high > STATS_max ? high : STATS_max) - (low < STATS_min ? low : STATS_min); if (r > 0) {{ set "
              "ytics nice(r/3) }}\n"
              "set ylabel '{0} {1} [N]'\nplot '{2}' using 1:{3} with lines lt 1 title 'elastic', "
              "'' using 1:{4} with lines lt 2 dashtype 2 title 'rigid'{5}\nunset key\n",
              literal(joint.name), component, csv, column + 2 * c, column + 2 * c + 1,
              measured.layer(joint.name + " " + component, true));
        }
        if (components == 1) panels += "set multiplot next\n";
      }
      column += 2 * components;
    }
    if (num_rows == 0) continue;
    std::vector<std::string> own_frames = elastic_rockers(*model.linkage());
    std::erase_if(own_frames, [&](const std::string& rocker) { return rocker != bodies.back(); });
    Figure figure;
    figure.name = figure_name("forces", name);
    figure.width = 1000;
    figure.height = 130 + 230 * num_rows;
    figure.commands = fmt::format(
        "set multiplot layout {},2 title {}\nset tmargin 2.2\nset key at graph 1, graph 1.02 right bottom horizontal "
        "Left reverse samplen 3\n{}{}"
        "set ytics autofreq\n{}unset multiplot\nset tmargin -1\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset "
        "xtics autofreq\n"
        "set key default\n",
        num_rows,
        scene_title(model, result,
                    fmt::format("joint forces of {}: {}\nelasticity changes them by {:.4g} N at most", literal(name),
                                literal(force_frames(own_frames)), change * output_units(model.scene).force)),
        turn_axis, turn_label(model), panels);
    figures.push_back(std::move(figure));
  }
  return figures;
}

Figure torque_figure(const SceneModel& model, const SpeedResult& result, const std::string& csv,
                     const MeasuredOverlay& measured) {
  Figure figure;
  figure.name = "torque";
  figure.commands = fmt::format(
      "set title {}\n{}{}set ytics autofreq\nset ylabel 'driving torque on the crank [N m]'\nset key outside right top "
      "Left reverse "
      "samplen 3\n"
      "plot '{}' using 1:2 with lines lt 1 title 'elastic', '' using 1:3 with lines lt 2 dashtype 2 title 'rigid'{}\n"
      "unset title\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset xtics autofreq\nset key default\n",
      scene_title(model, result,
                  fmt::format("driving torque; elasticity changes it by {:.4g} N m at most",
                              largest_change(result.forces->torque, result.forces->torque_rigid) *
                                  output_units(model.scene).moment)),
      turn_axis, turn_label(model), csv, measured.layer("torque", true));
  return figure;
}

}  // namespace hb::tools
