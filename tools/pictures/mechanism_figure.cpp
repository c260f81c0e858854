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

// Lines that draw a body: joint 0 - joint 1, and out to its points.
struct Stroke {
  std::size_t from, to;
  int body;
};

std::vector<Stroke> body_strokes(const std::vector<TracedPoint>& points) {
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
  return strokes;
}

Eigen::Index x_column(std::size_t k) { return 1 + 2 * static_cast<Eigen::Index>(k); }  // in the rows
int x_field(std::size_t k) { return 2 + 2 * static_cast<int>(k); }  // in gnuplot

// The corners of what the points sweep over, and room around.
struct SweptBox {
  Point low, high;
  double margin;
};

SweptBox swept_box(const Eigen::MatrixXd& rows, std::size_t num_points) {
  double low_x = rows(0, 1), high_x = low_x, low_y = rows(0, 2), high_y = low_y;
  for (std::size_t k = 0; k < num_points; ++k) {
    const Eigen::Index column = x_column(k);
    low_x = std::min(low_x, rows.col(column).minCoeff());
    high_x = std::max(high_x, rows.col(column).maxCoeff());
    low_y = std::min(low_y, rows.col(column + 1).minCoeff());
    high_y = std::max(high_y, rows.col(column + 1).maxCoeff());
  }
  const double margin = 0.08 * std::max(high_x - low_x, high_y - low_y);
  return {{low_x - margin, low_y - margin}, {high_x + margin, high_y + margin}, margin};
}

// gnuplot's commands of the picture, curve by curve and label by label.
class MechanismDrawing {
 public:
  MechanismDrawing(const Scene& scene, const CsvFile& csv)
      : linkage_(std::get<Linkage>(scene.model)),
        csv_(csv),
        points_(traced_points(linkage_)),
        strokes_(body_strokes(points_)),
        box_(swept_box(csv.rows, points_.size())) {}

  [[nodiscard]] const SweptBox& box() const { return box_; }
  [[nodiscard]] std::string commands() const { return labels_ + plot_; }

  // Guides of sliders, behind everything.
  void guides() {
    for (const auto& dyad : linkage_.dyads) {
      if (const auto* slider = std::get_if<Slider>(&dyad.closing)) {
        const auto [from, to] = inside_box(slider->guide, std::polar(1.0, slider->direction), box_.low, box_.high);
        labels_ += fmt::format("set arrow {} from {},{} to {},{} nohead dashtype 4 linecolor '#888888' linewidth 0.8\n",
                               label_++, from.real(), from.imag(), to.real(), to.imag());
      }
    }
  }

  // Every so many angles, light.
  void poses(int count) {
    for (const Stroke& stroke : strokes_)
      add_stroke(stroke, fmt::format("every {}", num_angles() / count), "linewidth 0.7 linecolor '#c4ccd4'");
  }

  // Paths of what moves; points that stay together (a coupler's joint 0 and the point that it hangs on) have one.
  void paths() {
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (points_[k].fixed) continue;
      const Eigen::MatrixXd& rows = csv_.rows;
      const auto same = std::find_if(paths_.begin(), paths_.end(), [&](const auto& path) {
        return (rows.middleCols(x_column(path.first), 2) - rows.middleCols(x_column(k), 2)).cwiseAbs().maxCoeff() <=
               1e-9 * box_.margin;
      });
      if (same == paths_.end()) {
        paths_.push_back({k, points_[k].name});
      } else {
        same->second += " = " + points_[k].name;
      }
    }
    for (std::size_t k = 0; k < paths_.size(); ++k) {
      // Seven colours; then the same, dashed.
      add(fmt::format("'{}' using {}:{} with lines lt {} dashtype {} linewidth 1.2 title '{}'", csv_.name,
                      x_field(paths_[k].first), x_field(paths_[k].first) + 1, 1 + k % 7, 1 + k / 7,
                      literal(paths_[k].second)));
    }
  }

  // At crank angle 0.
  void links() {
    for (const Stroke& stroke : strokes_) {
      const Body* body = body_at(linkage_, stroke.body);
      const bool elastic = body != nullptr && body->elastic.has_value();
      add_stroke(stroke, "every ::0::0",
                 fmt::format("linewidth {} linecolor '{}'", elastic ? 2.0 : 3.0, elastic ? "#b03060" : "#333333"));
    }
  }

  // Joints, and the names of links and sliders where nothing else is drawn; after paths(). scale: picture points per
  // unit of length.
  void joints_and_names(double scale) {
    LabelPlaces place(scale);
    avoid_lines(place);
    bool any_elastic = false;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Body* body = body_at(linkage_, points_[k].body);
      const bool is_slider = body == nullptr && points_[k].point == std::complex<double>(0);
      const char* style = points_[k].fixed ? "pointtype 9 pointsize 1.6"
                          : is_slider      ? "pointtype 5 pointsize 1.8"
                                           : "pointtype 7 pointsize 0.8";
      add(fmt::format("'{}' using {}:{} every ::0::0 with points {} linecolor '{}' notitle", csv_.name, x_field(k),
                      x_field(k) + 1, style, is_slider ? "#666666" : "#222222"));
      // A link is named where its joint 1 comes.
      const bool link = body != nullptr && k > 0 && points_[k - 1].body == points_[k].body &&
                        (k < 2 || points_[k - 2].body != points_[k].body);
      if (!link && !is_slider) continue;
      any_elastic = any_elastic || (link && body->elastic.has_value());
      const std::string& name = link ? body->name : points_[k].name;
      const Point at =
          link ? place.beside(position(k - 1), position(k), name) : place.beside(position(k), position(k), name);
      labels_ += fmt::format("set label {} {} at {},{} center font ',11' textcolor '{}' front boxed\n", label_++,
                             quoted(name), at.real(), at.imag(), link && body->elastic ? "#b03060" : "#333333");
    }
    if (any_elastic) add("NaN with lines linewidth 2 linecolor '#b03060' title 'elastic link'");
  }

 private:
  [[nodiscard]] Eigen::Index num_angles() const { return csv_.rows.rows() - 1; }
  [[nodiscard]] Point position(std::size_t k, Eigen::Index row = 0) const {
    return {csv_.rows(row, x_column(k)), csv_.rows(row, x_column(k) + 1)};
  }

  void add(const std::string& curve) { plot_ += (plot_.empty() ? "plot " : ", ") + curve; }

  void add_stroke(const Stroke& stroke, const std::string& every, const std::string& style) {
    const int from = x_field(stroke.from), to = x_field(stroke.to);
    add(fmt::format("'{}' using {}:{}:(${}-${}):(${}-${}) {} with vectors nohead {} notitle", csv_.name, from, from + 1,
                    to, from, to + 1, from + 1, every, style));
  }

  void avoid_lines(LabelPlaces& place) const {
    for (const Stroke& stroke : strokes_) place.avoid(position(stroke.from), position(stroke.to));
    constexpr Eigen::Index step = 10;
    for (const auto& [k, names] : paths_)
      for (Eigen::Index j = 0; j + step <= num_angles(); j += step)
        place.avoid_path(position(k, j), position(k, j + step));
  }

  const Linkage& linkage_;
  const CsvFile& csv_;
  std::vector<TracedPoint> points_;
  std::vector<Stroke> strokes_;
  SweptBox box_;
  std::vector<std::pair<std::size_t, std::string>> paths_;  // a point of it, the names of all
  std::string labels_, plot_;
  int label_ = 1;
};

}  // namespace

Figure mechanism_figure(const Scene& scene, const CsvFile& csv) {
  constexpr int poses = 12;
  MechanismDrawing drawing(scene, csv);
  const auto& [low, high, margin] = drawing.box();
  const double width = high.real() - low.real(), height = high.imag() - low.imag();

  Figure figure;
  figure.name = "mechanism";
  figure.width = 960;
  figure.height = static_cast<int>(std::clamp(110 + 700 * height / width, 320.0, 1100.0));
  figure.commands = fmt::format(
      "set title {}\nset size ratio -1\nset xrange [{}:{}]\nset yrange [{}:{}]\nset xtics autofreq\nset ytics "
      "autofreq\n"
      "set xlabel 'x [{}]'\nset ylabel 'y [{}]'\nset key outside right top Left reverse samplen 2\nset format '%g'\n"
      "set style textbox opaque noborder fillcolor '#ffffff' margins 0.6, 0.6\n",
      two_lines(short_name(scene),
                fmt::format("crank angle 0 dark, every {} deg light; paths of the joints", 360 / poses)),
      low.real(), high.real(), low.imag(), high.imag(), scene.units.length, scene.units.length);

  drawing.guides();
  drawing.poses(poses);
  drawing.paths();
  drawing.links();
  drawing.joints_and_names(std::min(630 / width, (figure.height - 110) / height));
  figure.commands += drawing.commands() +
                     "\nunset label\nunset arrow\nset size noratio\nset xrange [*:*]\nset yrange [*:*]\n"
                     "unset title\nunset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

}  // namespace hb::tools
