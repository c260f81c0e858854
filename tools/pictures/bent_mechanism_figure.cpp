#include "tools/pictures/bent_mechanism_figure.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "lib/constants.hpp"
#include "lib/linkage/kinematics.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"

namespace hb::tools {
namespace {

using Point2 = std::complex<double>;

// The largest deflection is drawn as about this part of its link.
constexpr double drawn_share = 0.15;
constexpr Eigen::Index points_along = 41;

enum class BentPart { rigid = 0, chord = 1, bent = 2, fixed = 3, slider = 4, joint = 5 };

// 1, 2, 5, 10, ... not above `most`, at least 1.
double round_factor(double most) {
  if (!(most > 1)) return 1;
  const double ten = std::pow(10, std::floor(std::log10(most))), digit = most / ten;
  return ten * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

// Straight pieces, of a point both ends alike.
class BentRows {
 public:
  void line(int pose, BentPart part, const std::vector<Point2>& points) {
    for (std::size_t k = 0; k < std::max<std::size_t>(1, points.size() - 1); ++k) {
      const Point2 &from = points[k], &to = points[std::min(k + 1, points.size() - 1)];
      rows_.push_back({double(pose), double(static_cast<int>(part)), from.real(), from.imag(), to.real(), to.imag()});
    }
  }
  [[nodiscard]] Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows_.size()), 6);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (std::size_t c = 0; c < 6; ++c)
        matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) = rows_[k][c];
    return matrix;
  }

 private:
  std::vector<std::array<double, 6>> rows_;
};

// w of a rod at the poses, a column each.
Eigen::MatrixXd deflections(const SceneModel& model, const RodModel& rod, const SpeedResult& result,
                            const RodResult& of) {
  const Body& link = *body_at(*model.linkage(), rod.link);
  const Eigen::Index multiple = std::max<Eigen::Index>(1, (2 * of.steady->q.num_harmonics() + 1) / bent_poses + 1);
  const Eigen::MatrixXd all =
      rod_field(link, model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], result.speed, of.steady->q,
                Eigen::VectorXd::LinSpaced(points_along, 0, link.length), multiple * bent_poses)
          .w;
  Eigen::MatrixXd poses(points_along, bent_poses);
  for (int pose = 0; pose < bent_poses; ++pose) poses.col(pose) = all.col(pose * multiple);
  return poses;
}

// Points of a body in the order of traced_points: joint 0, joint 1, then its further points.
std::vector<std::vector<TracedPoint>> by_body(const Linkage& linkage) {
  std::vector<std::vector<TracedPoint>> bodies;
  for (const TracedPoint& point : traced_points(linkage)) {
    if (bodies.empty() || bodies.back().front().body != point.body) bodies.emplace_back();
    bodies.back().push_back(point);
  }
  return bodies;
}

struct BentRod {
  int link;
  Eigen::MatrixXd w;
};

}  // namespace

std::optional<BentMechanism> bent_mechanism(const SceneModel& model, const SpeedResult& result) {
  if (!model.linkage()) return std::nullopt;
  const Linkage& linkage = *model.linkage();
  BentMechanism bent;
  std::vector<BentRod> rods;
  double most = HUGE_VAL;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    if (!rod.shape || !(rod.shape->deflection.max_abs > 0)) continue;
    rods.push_back({rod.link, deflections(model, model.rods[r], result, rod)});
    most = std::min(most, drawn_share * body_at(linkage, rod.link)->length / rod.shape->deflection.max_abs);
  }
  if (rods.empty()) return std::nullopt;
  bent.factor = round_factor(most);
  BentRows rows;
  std::vector<BodyMotion> motion;
  for (int pose = 0; pose < bent_poses; ++pose) {
    motion_at(linkage, two_pi * pose / bent_poses, motion);
    for (const std::vector<TracedPoint>& body : by_body(linkage)) {
      std::vector<Point2> at;
      for (const TracedPoint& point : body)
        at.push_back(motion[static_cast<std::size_t>(point.body)].position(point.point));
      const auto rod = std::ranges::find(rods, body.front().body, &BentRod::link);
      // Joint 1 to joint 0; a further point to both.
      for (std::size_t k = 1; k < at.size(); ++k)
        for (std::size_t m = 0; m < std::min<std::size_t>(k, 2); ++m)
          rows.line(pose, rod != rods.end() ? BentPart::chord : BentPart::rigid, {at[m], at[k]});
      if (rod != rods.end() && at.size() >= 2) {
        const Point2 along = (at[1] - at[0]) / std::abs(at[1] - at[0]);
        std::vector<Point2> line;
        for (Eigen::Index i = 0; i < points_along; ++i)
          line.push_back(at[0] + static_cast<double>(i) / static_cast<double>(points_along - 1) * (at[1] - at[0]) +
                         bent.factor * rod->w(i, pose) * along * Point2(0, 1));
        rows.line(pose, BentPart::bent, line);
      }
      for (std::size_t k = 0; k < at.size(); ++k) {
        const bool slider = body_at(linkage, body[k].body) == nullptr && body[k].point == Point2(0);
        rows.line(pose, body[k].fixed ? BentPart::fixed : slider ? BentPart::slider : BentPart::joint, {at[k]});
      }
    }
  }
  bent.csv.name = "bent_mechanism.csv";
  bent.csv.comment = {
      fmt::format("{}, {}: bent links at {} crank angles, deflections {:g} times larger", scene_name(model.scene),
                  speed_text(result.speed, model.scene), bent_poses, bent.factor),
      "pose: crank angle over " + fmt::format("{}", 360 / bent_poses) +
          " deg; part: 0 rigid link, 1 elastic link unbent, 2 bent, 3 pivot, 4 slider, 5 joint"};
  const std::string unit = bracketed(model.scene.units.length);
  bent.csv.columns = {"pose", "part", "x from" + unit, "y from" + unit, "x to" + unit, "y to" + unit};
  bent.csv.rows = rows.matrix();
  return bent;
}

Figure bent_mechanism_figure(const SceneModel& model, const SpeedResult& result, const BentMechanism& bent) {
  double low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL, largest_w = 0;
  for (const Eigen::Index column : {2, 4}) {
    low_x = std::min(low_x, bent.csv.rows.col(column).minCoeff());
    high_x = std::max(high_x, bent.csv.rows.col(column).maxCoeff());
    low_y = std::min(low_y, bent.csv.rows.col(column + 1).minCoeff());
    high_y = std::max(high_y, bent.csv.rows.col(column + 1).maxCoeff());
  }
  for (const RodResult& rod : result.rods)
    if (rod.shape) largest_w = std::max(largest_w, rod.shape->deflection.max_abs);
  const double margin = 0.06 * std::max(high_x - low_x, high_y - low_y);
  const double width = high_x - low_x + 2 * margin, height = high_y - low_y + 2 * margin;
  const bool wide = width > 1.6 * height;
  const int columns = wide ? 2 : 3, rows = bent_poses / columns;
  Figure figure;
  figure.name = "bent_mechanism";
  figure.width = 1000;
  const double panel = static_cast<double>(figure.width - 40) / columns;
  figure.height = static_cast<int>(std::clamp(130 + rows * (panel * height / width + 48), 360.0, 1200.0));
  figure.commands = fmt::format(
      "set multiplot layout {},{} title {}\nunset key\nunset border\nunset tics\nunset grid\nset size ratio -1\n"
      "set lmargin 1\nset rmargin 1\nset tmargin 2.6\nset bmargin 0.4\nset xrange [{}:{}]\nset yrange [{}:{}]\n",
      rows, columns,
      scene_title(model, result,
                  fmt::format("deflections drawn {} (largest {:.4g} {}); dashed: unbent",
                              bent.factor > 1 ? fmt::format("{:g} times larger", bent.factor) : "to scale", largest_w,
                              literal(output_units(model.scene).length))),
      low_x - margin, high_x + margin, low_y - margin, high_y + margin);
  const auto layer = [&](int pose, BentPart part, const char* style) {
    const bool point = part == BentPart::fixed || part == BentPart::slider || part == BentPart::joint;
    return fmt::format("'{}' using ($1 == {} && $2 == {} ? $3 : NaN):4{} {}", bent.csv.name, pose,
                       static_cast<int>(part), point ? " with points" : ":($5-$3):($6-$4) with vectors nohead", style);
  };
  for (int pose = 0; pose < bent_poses; ++pose)
    figure.commands +=
        fmt::format("set title '{} deg' offset 0, -0.4\nplot {}, {}, {}, {}, {}, {}\n", 360 * pose / bent_poses,
                    layer(pose, BentPart::rigid, "linewidth 2.6 linecolor '#333333'"),
                    layer(pose, BentPart::chord, "linewidth 0.9 dashtype 2 linecolor '#888888'"),
                    layer(pose, BentPart::bent, "linewidth 2.2 linecolor '#d55e00'"),
                    layer(pose, BentPart::joint, "pointtype 7 pointsize 0.6 linecolor '#222222'"),
                    layer(pose, BentPart::fixed, "pointtype 9 pointsize 1.4 linecolor '#222222'"),
                    layer(pose, BentPart::slider, "pointtype 5 pointsize 1.5 linecolor '#666666'"));
  figure.commands +=
      "unset multiplot\nunset title\nset border 3 linecolor '#444444'\nset tics nomirror textcolor '#222222'\nset "
      "xtics nomirror autofreq\nset ytics nomirror autofreq\nset grid\nset size noratio\nset margins -1, -1, -1, "
      "-1\nset xrange "
      "[*:*]\nset yrange [*:*]\nset key default\n";
  return figure;
}

}  // namespace hb::tools
