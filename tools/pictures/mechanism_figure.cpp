// The mechanism drawn: links at crank angle 0, other poses lightly behind, paths of its joints.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/figures.hpp"

namespace hb::tools {
namespace {

using Point = std::complex<double>;

double distance_to_segment(Point p, Point from, Point to) {
  const double length2 = std::norm(to - from);
  const double share = length2 > 0 ? std::clamp(((p - from) * std::conj(to - from)).real() / length2, 0.0, 1.0) : 0;
  return std::abs(p - from - share * (to - from));
}

// Places for names where they cover no link and no other name. All lengths in pixels inside.
class LabelPlaces {
 public:
  explicit LabelPlaces(double pixels_per_unit) : scale_(pixels_per_unit) {}

  void avoid(Point from, Point to) { links_.push_back({scale_ * from, scale_ * to}); }
  // Less strictly.
  void avoid_path(Point from, Point to) { paths_.push_back({scale_ * from, scale_ * to}); }

  // The centre of `name` beside the link (or the point, if both ends are one): as near to its middle as is free.
  Point beside(Point from, Point to, const std::string& name) {
    const Point a = scale_ * from, b = scale_ * to;
    const double half_width = 3.6 * static_cast<double>(name.size()) + 3, half_height = 9;
    const Point along = std::abs(b - a) > 0 ? (b - a) / std::abs(b - a) : Point(1, 0);
    Point best = a;
    double best_score = -std::numeric_limits<double>::infinity();
    for (const double share : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8}) {
      for (int turn = 0; turn < 8; ++turn) {
        // On a link only to its two sides; round a point everywhere.
        if (std::abs(b - a) > 0 && turn % 4 != 2) continue;
        const Point away = along * std::polar(1.0, turn * std::numbers::pi / 4);
        for (const double gap : {8.0, 16.0, 28.0, 44.0}) {
          const double reach = std::abs(away.real()) * half_width + std::abs(away.imag()) * half_height;
          const Point centre = a + share * (b - a) + (reach + gap) * away;
          const double score = std::min(clearance(centre, half_width, half_height), 10.0) +
                               0.5 * std::min(to_lines(paths_, centre, half_width, half_height), 8.0) - 0.1 * gap -
                               4 * std::abs(share - 0.5);
          if (score > best_score) best_score = score, best = centre;
        }
      }
    }
    names_.push_back({best, {half_width, half_height}});
    return best / scale_;
  }

 private:
  // Distance of a box from the nearest line (by points of the box) and name; negative: names overlap.
  double clearance(Point centre, double half_width, double half_height) const {
    double least = to_lines(links_, centre, half_width, half_height);
    for (const auto& [other, half] : names_) {
      const double dx = std::abs((centre - other).real()) - half_width - half.real();
      const double dy = std::abs((centre - other).imag()) - half_height - half.imag();
      least = std::min(least, std::max(dx, dy));
    }
    return least;
  }

  static double to_lines(const std::vector<std::pair<Point, Point>>& lines, Point centre, double half_width,
                         double half_height) {
    double least = 100;
    for (const auto& [from, to] : lines)
      for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0})
        for (const double y : {-1.0, 0.0, 1.0}) {
          const Point corner(x * half_width, y * half_height);
          least = std::min(least, distance_to_segment(centre + corner, from, to));
        }
    return least;
  }

  double scale_;
  std::vector<std::pair<Point, Point>> links_, paths_;
  std::vector<std::pair<Point, Point>> names_;  // centre, half the box
};

// The part of the line through `point` along the unit vector u that lies in a box which it crosses.
std::pair<Point, Point> inside_box(Point point, Point u, Point low, Point high) {
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

}  // namespace

Figure mechanism_figure(const Scene& scene, const CsvFile& csv) {
  constexpr int poses = 12;
  const Linkage& linkage = std::get<Linkage>(scene.model);
  const std::vector<TracedPoint> points = traced_points(linkage);
  const Eigen::Index num_angles = csv.rows.rows() - 1;
  const auto column_of = [](std::size_t k) { return 1 + 2 * static_cast<Eigen::Index>(k); };  // of x in csv.rows
  const auto x_of = [](std::size_t k) { return 2 + 2 * static_cast<int>(k); };  // in gnuplot

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
    const Eigen::Index column = column_of(k);
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
      "set xlabel 'x [{}]'\nset ylabel 'y [{}]'\nset key outside right top Left reverse samplen 2\nset format '%g'\n"
      "set style textbox opaque noborder fillcolor '#ffffff' margins 0.6, 0.6\n",
      two_lines(short_name(scene),
                fmt::format("crank angle 0 dark, every {} deg light; paths of the joints", 360 / poses)),
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
  // Paths of what moves; points that stay together (a coupler's joint 0 and the point that it hangs on) have one.
  std::vector<std::pair<std::size_t, std::string>> paths;  // a point of it, the names of all
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].fixed) continue;
    const auto same = std::find_if(paths.begin(), paths.end(), [&](const auto& path) {
      return (rows.middleCols(column_of(path.first), 2) - rows.middleCols(column_of(k), 2)).cwiseAbs().maxCoeff() <=
             1e-9 * margin;
    });
    if (same == paths.end()) {
      paths.push_back({k, points[k].name});
    } else {
      same->second += " = " + points[k].name;
    }
  }
  for (std::size_t k = 0; k < paths.size(); ++k) {
    // Seven colours; then the same, dashed.
    add(fmt::format("'{}' using {}:{} with lines lt {} dashtype {} linewidth 1.2 title '{}'", csv.name,
                    x_of(paths[k].first), x_of(paths[k].first) + 1, 1 + k % 7, 1 + k / 7, literal(paths[k].second)));
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
  LabelPlaces place(std::min(630 / (high_x - low_x), (figure.height - 110) / (high_y - low_y)));
  const auto position = [&](std::size_t k) { return Point(rows(0, column_of(k)), rows(0, column_of(k) + 1)); };
  for (const Stroke& stroke : strokes) place.avoid(position(stroke.from), position(stroke.to));
  for (const auto& [k, names] : paths) {
    constexpr Eigen::Index step = 10;
    const auto at = [&, column = column_of(k)](Eigen::Index j) { return Point(rows(j, column), rows(j, column + 1)); };
    for (Eigen::Index j = 0; j + step <= num_angles; j += step) place.avoid_path(at(j), at(j + step));
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
    // A link is named where its joint 1 comes.
    const bool link = body != nullptr && k > 0 && points[k - 1].body == points[k].body &&
                      (k < 2 || points[k - 2].body != points[k].body);
    if (!link && !is_slider) continue;
    any_elastic = any_elastic || (link && body->elastic.has_value());
    const std::string& name = link ? body->name : points[k].name;
    const Point at =
        link ? place.beside(position(k - 1), position(k), name) : place.beside(position(k), position(k), name);
    labels += fmt::format("set label {} {} at {},{} center font ',11' textcolor '{}' front boxed\n", label++,
                          quoted(name), at.real(), at.imag(), link && body->elastic ? "#b03060" : "#333333");
  }
  if (any_elastic) add("NaN with lines linewidth 2 linecolor '#b03060' title 'elastic link'");
  figure.commands += labels + plot +
                     "\nunset label\nunset arrow\nset size noratio\nset xrange [*:*]\nset yrange [*:*]\n"
                     "unset title\nunset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

}  // namespace hb::tools
