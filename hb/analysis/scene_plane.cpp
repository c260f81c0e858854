#include "hb/analysis/scene_plane.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/plane_numbers.hpp"
#include "hb/analysis/request.hpp"
#include "lib/chebyshev.hpp"
#include "lib/rod/rod.hpp"

namespace hb {
namespace scene_plane {

using Eigen::Index;
using Eigen::MatrixXd;

struct Box {
  std::array<double, 2> low{}, high{};

  double unit(std::size_t axis, double v) const {
    const double width = high[axis] - low[axis];
    return width > 0 ? ((v - low[axis]) - (high[axis] - v)) / width : 0;
  }
  double value(std::size_t axis, double t) const { return 0.5 * ((1 - t) * low[axis] + (1 + t) * high[axis]); }
  bool contains(double u, double v) const { return u >= low[0] && u <= high[0] && v >= low[1] && v <= high[1]; }
};

// Part of the plane of scene numbers: interpolated, divided further, or (neither) computed place by place.
struct Patch {
  Box box;
  std::array<Index, 2> degree{};
  std::vector<Layout> layouts;  // per rod
  std::vector<MatrixXd> coefficients;  // per rod: numbers x products of Chebyshev polynomials, first axis fastest
  std::vector<NumberErrors> errors;  // per rod
  std::vector<std::array<bool, 2>> varies;  // per rod: not the same bits at all nodes along the axis
  std::vector<Patch> parts;

  bool interpolates() const { return !coefficients.empty(); }
};

}  // namespace scene_plane

using scene_plane::Box;
using scene_plane::Layout;
using scene_plane::NumberErrors;
using scene_plane::Patch;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Relative to the entries of a matrix; the Fourier coefficients of a geometry carry rounding of a few 1e-14.
constexpr double interpolation_tolerance = 1e-13;
constexpr std::array<Index, 5> degrees_1d = {2, 4, 8, 16, 32};
constexpr std::array<Index, 3> degrees_2d = {2, 4, 8};
constexpr int max_depth_1d = 5, max_depth_2d = 2;

// Whether values at (n[0]+1) x (n[1]+1) nodes, one a column, first axis fastest, change along each axis.
std::array<bool, 2> varying(const MatrixXd& values, const std::array<Index, 2>& n) {
  const Index rows = n[0] + 1;
  std::array<bool, 2> varies{};
  for (Index k = 0; k < values.cols(); ++k) {
    varies[0] |= values.col(k) != values.col(k - k % rows);
    varies[1] |= values.col(k) != values.col(k % rows);
  }
  return varies;
}

}  // namespace

struct ScenePlane::Implementation {
  SceneFamily family;
  std::array<PlaneAxis, 2> axes;
  PlaneOptions options;
  std::optional<Scene> corner;
  std::vector<std::string> names;  // of all rods asked for
  std::array<bool, 2> varies{};  // the axis is a scene number
  Patch root;
  std::size_t id = 0;
  std::atomic<std::size_t> computed = 0;
  std::size_t patches = 0;

  Numbers numbers_at(double u, double v) const {
    Numbers numbers;
    if (varies[0]) numbers.push_back({axes[0].path, u});
    if (varies[1]) numbers.push_back({axes[1].path, v});
    return numbers;
  }

  bool asked(const std::string& name) const {
    return options.rods.empty() || std::find(options.rods.begin(), options.rods.end(), name) != options.rods.end();
  }

  // Systems of the rods, those of links multiplied by EJ (stability does not see it).
  std::vector<HillSystem> systems_from_scene(double u, double v) {
    ++computed;
    const Scene scene = family.scene(numbers_at(u, v));
    if (const auto* hill = std::get_if<HillSystem>(&scene.model)) return {*hill};
    const Linkage& linkage = std::get<Linkage>(scene.model);
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    require_resolved(scene, coefficients);
    std::vector<HillSystem> systems;
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      if (!asked(body_name(linkage, coefficients.links[r]))) continue;
      const Body& link = *body_at(linkage, coefficients.links[r]);
      HillSystem system = ritz_system(link, coefficients.rods[r], options.num_modes);
      const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
      system.mass *= EJ;
      system.damping *= EJ;
      for (FourierSeries& series : system.stiffness) series.c *= EJ;
      systems.push_back(std::move(system));
    }
    return systems;
  }

  // The last place of each thread is kept: a search along the speed stays at one place.
  const std::vector<HillSystem>* systems_directly(double u, double v) {
    struct Last {
      std::size_t id = 0;
      double u = 0, v = 0;
      std::optional<std::vector<HillSystem>> systems;
    };
    thread_local Last last;
    if (last.id != id || last.u != u || last.v != v) {
      last = {id, u, v, std::nullopt};
      try {
        last.systems = systems_from_scene(u, v);
      } catch (const SceneError&) {
      }
    }
    return last.systems ? &*last.systems : nullptr;
  }

  void for_each(std::size_t count, const std::function<void(std::size_t)>& work) const {
    options.work->for_each(count, work);
  }

  using Samples = std::vector<std::optional<std::vector<HillSystem>>>;

  Samples samples_at(const std::vector<std::array<double, 2>>& places) {
    Samples samples(places.size());
    for_each(places.size(), [&](std::size_t k) {
      try {
        samples[k] = systems_from_scene(places[k][0], places[k][1]);
      } catch (const SceneError&) {
      }
    });
    return samples;
  }

  bool interpolate(Patch& patch, Index degree) {
    const std::array<Index, 2> n = {varies[0] ? degree : 0, varies[1] ? degree : 0};
    std::vector<std::array<double, 2>> places;
    const VectorXd first = lobatto_nodes(n[0]), second = lobatto_nodes(n[1]);
    for (Index j = 0; j <= n[1]; ++j) {
      for (Index i = 0; i <= n[0]; ++i) places.push_back({patch.box.value(0, first(i)), patch.box.value(1, second(j))});
    }
    // Places between the nodes, spread by the golden section and the square root of 2.
    constexpr int num_checks = 6;
    const std::size_t num_nodes = places.size();
    for (int k = 1; k <= num_checks; ++k) {
      double whole = 0;
      const double s = std::modf(k * std::numbers::phi, &whole), t = std::modf(k * std::numbers::sqrt2, &whole);
      places.push_back({patch.box.value(0, 2 * s - 1), patch.box.value(1, 2 * t - 1)});
    }
    const Samples samples = samples_at(places);
    for (const auto& sample : samples) {
      if (!sample) return false;
      for (std::size_t r = 0; r < sample->size(); ++r)
        if ((*sample)[r].num_modes() != (*samples[0])[r].num_modes()) return false;  // shear.hpp, num_unknowns
    }
    patch.degree = n;
    for (std::size_t r = 0; r < samples[0]->size(); ++r) {
      Layout layout;
      for (const auto& sample : samples) layout.widen((*sample)[r]);
      MatrixXd values(layout.size(), static_cast<Index>(num_nodes));
      for (std::size_t k = 0; k < num_nodes; ++k) values.col(static_cast<Index>(k)) = packed((*samples[k])[r], layout);
      const std::array<bool, 2> varies = varying(values, n);
      const MatrixXd Dx = varies[0] ? to_coefficients(n[0]) : first_value(n[0]);
      const MatrixXd Dy = varies[1] ? to_coefficients(n[1]) : first_value(n[1]);
      MatrixXd coefficients = MatrixXd::Zero(values.rows(), values.cols());
      const Index rows = n[0] + 1;
      for (Index l = 0; l <= n[1]; ++l) {
        for (Index j = 0; j <= n[1]; ++j) {
          coefficients.middleCols(rows * l, rows) += Dy(j, l) * (values.middleCols(rows * j, rows) * Dx);
        }
      }
      for (Index number = 0; number < values.rows(); ++number)
        if ((values.row(number).array() == values(number, 0)).all()) {
          coefficients.row(number).setZero();
          coefficients(number, 0) = values(number, 0);
        }
      VectorXd errors = VectorXd::Zero(values.rows());
      for (std::size_t k = num_nodes; k < places.size(); ++k) {
        const VectorXd truth = packed((*samples[k])[r], layout);
        const VectorXd error = (coefficients * products(patch, places[k][0], places[k][1]) - truth).cwiseAbs();
        errors = errors.cwiseMax(error);
        if (!(error.array() <= interpolation_tolerance * scales(truth, layout).array()).all()) {
          patch.coefficients.clear();
          patch.errors.clear();
          patch.layouts.clear();
          patch.varies.clear();
          return false;
        }
      }
      patch.layouts.push_back(layout);
      patch.varies.push_back(varies);
      patch.errors.push_back(errors_of(errors, coefficients, layout));
      patch.coefficients.push_back(std::move(coefficients));
    }
    ++patches;
    return true;
  }

  static VectorXd products(const Patch& patch, double u, double v) {
    const VectorXd first = chebyshev(patch.box.unit(0, u), patch.degree[0]);
    const VectorXd second = chebyshev(patch.box.unit(1, v), patch.degree[1]);
    return (first * second.transpose()).reshaped();
  }

  void divide(Patch& patch, int depth) {
    const bool both = varies[0] && varies[1];
    if (both) {
      for (const Index degree : degrees_2d) {
        if (interpolate(patch, degree)) return;
      }
    } else {
      for (const Index degree : degrees_1d) {
        if (interpolate(patch, degree)) return;
      }
    }
    if (depth == (both ? max_depth_2d : max_depth_1d)) return;
    for (int half_v = 0; half_v < (varies[1] ? 2 : 1); ++half_v) {
      for (int half_u = 0; half_u < (varies[0] ? 2 : 1); ++half_u) {
        Patch part;
        part.box = patch.box;
        const std::array<int, 2> half = {half_u, half_v};
        for (std::size_t axis = 0; axis < 2; ++axis) {
          if (!varies[axis]) continue;
          const double middle = patch.box.value(axis, 0);
          (half[axis] == 0 ? part.box.high : part.box.low)[axis] = middle;
        }
        divide(part, depth + 1);
        patch.parts.push_back(std::move(part));
      }
    }
  }

  double speed_at(double x, double y) const {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double v = axis == 0 ? x : y;
      if (axes[axis].role == PlaneAxis::Role::rpm) return speed_from_rpm(v, corner->units);
      if (axes[axis].role == PlaneAxis::Role::omega) return v;
    }
    return options.speed;
  }
};

ScenePlane::ScenePlane(SceneFamily family, PlaneAxis x, PlaneAxis y, PlaneOptions options)
    : self_(new Implementation{std::move(family), {std::move(x), std::move(y)}, std::move(options), {}, {}, {}, {}}) {
  static std::atomic<std::size_t> next_id = 1;
  Implementation& s = *self_;
  s.id = next_id++;
  Box& box = s.root.box;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    s.varies[axis] = s.axes[axis].role == PlaneAxis::Role::scene_number;
    if (!s.varies[axis]) continue;
    box.low[axis] = s.axes[axis].from;
    box.high[axis] = s.axes[axis].to;
  }
  // A wrong number shows at a corner; a linkage that does not turn through there may do so elsewhere.
  std::optional<ObstructedLinkage> obstructed;
  const auto look_at = [&](double u, double v) {
    try {
      Scene scene = s.family.scene(s.numbers_at(u, v));
      if (!s.corner) s.corner = std::move(scene);
    } catch (const ObstructedLinkage& error) {
      if (!obstructed) obstructed = error;
    }
  };
  for (const double u : {box.low[0], box.high[0]}) {
    for (const double v : {box.low[1], box.high[1]}) look_at(u, v);
  }
  constexpr int places = 16;
  for (int k = 0; k <= places && !s.corner; ++k) {
    for (int l = 0; l <= places && !s.corner; ++l) {
      look_at(box.value(0, 2.0 * k / places - 1), box.value(1, 2.0 * l / places - 1));
    }
  }
  if (!s.corner) throw ObstructedLinkage(*obstructed);

  if (const auto* linkage = std::get_if<Linkage>(&s.corner->model)) {
    std::vector<std::string> all;
    for (const int link : elastic_links(*linkage)) all.push_back(body_name(*linkage, link));
    if (all.empty())
      throw RequestError("", "no elastic links", "a scene with some",
                         "the scene has no elastic links: nothing can become unstable");
    for (const std::string& name : s.options.rods) {
      if (std::find(all.begin(), all.end(), name) == all.end()) {
        throw RequestError("rods", fmt::format("\"{}\"", name), fmt::format("{}", fmt::join(all, ", ")));
      }
    }
    for (const std::string& name : all) {
      if (s.asked(name)) s.names.push_back(name);
    }
  } else {
    s.names.push_back("system");
    for (const std::string& name : s.options.rods) {
      if (name != "system") throw RequestError("rods", fmt::format("\"{}\"", name), "system");
    }
    s.options.rods.clear();
  }
  if (s.varies[0] || s.varies[1]) {
    s.divide(s.root, 0);
  } else {
    s.interpolate(s.root, 0);
  }
}

int plane_modes(const SceneFamily& family, const PlaneAxis& x, const PlaneAxis& y, double speed,
                const Settings& settings) {
  if (const int* asked = std::get_if<int>(&settings.modes)) return *asked;
  Settings growth = settings;
  growth.only = {.steady = true, .stability = true, .reactions = false, .shape = false};
  int modes = 1;
  for (const auto& [s, t] : {std::pair(0.0, 0.0), {0.0, 1.0}, {1.0, 0.0}, {1.0, 1.0}, {0.5, 0.5}}) {
    Numbers numbers;
    std::optional<double> rpm, omega;
    for (const auto& [axis, at] : {std::pair(&x, s), {&y, t}}) {
      const double value = axis->from + at * (axis->to - axis->from);
      if (axis->role == PlaneAxis::Role::rpm) rpm = value;
      if (axis->role == PlaneAxis::Role::omega) omega = value;
      if (axis->role == PlaneAxis::Role::scene_number) numbers.push_back({axis->path, value});
    }
    FamilyMember member = family.at(numbers);
    if (!member.scene) continue;
    const double here = rpm ? speed_from_rpm(*rpm, member.scene->units) : omega.value_or(speed);
    try {
      const SceneModel model = make_model(std::move(*member.scene), growth, false);
      modes = most_modes(analyse(model, here, growth).rods, modes);
    } catch (const ObstructedLinkage&) {  // a corner that the map leaves out too
    }
  }
  return modes;
}

ScenePlane::~ScenePlane() = default;
ScenePlane::ScenePlane(ScenePlane&&) noexcept = default;

const Scene& ScenePlane::scene() const { return *self_->corner; }
const std::vector<std::string>& ScenePlane::rods() const { return self_->names; }
double ScenePlane::speed(double x, double y) const { return self_->speed_at(x, y); }

std::array<bool, 2> ScenePlane::varies(std::size_t rod) const {
  std::array<bool, 2> varies{true, true};
  if (!self_->root.interpolates()) return varies;
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (self_->varies[axis]) varies[axis] = self_->root.varies[rod][axis];
  return varies;
}

std::optional<ScaledSystem> ScenePlane::system(std::size_t rod, double x, double y) const {
  Implementation& s = *self_;
  if (s.options.work->ends_early()) return std::nullopt;
  const double u = s.varies[0] ? x : 0, v = s.varies[1] ? y : 0;
  const Patch* patch = &s.root;
  while (!patch->parts.empty()) {
    const auto part =
        std::find_if(patch->parts.begin(), patch->parts.end(), [&](const Patch& p) { return p.box.contains(u, v); });
    if (part == patch->parts.end()) break;
    patch = &*part;
  }
  try {
    if (patch->interpolates() && patch->box.contains(u, v)) {
      const VectorXd numbers = patch->coefficients[rod] * Implementation::products(*patch, u, v);
      const HillSystem system = unpacked(numbers, patch->layouts[rod]);
      const double speed = s.speed_at(x, y);
      return scale_system(system, speed, given_errors(system, patch->errors[rod], speed));
    }
    const std::vector<HillSystem>* systems = s.systems_directly(u, v);
    if (!systems) return std::nullopt;
    return scale_system((*systems)[rod], s.speed_at(x, y));
  } catch (const std::invalid_argument&) {  // singular mass in between
    return std::nullopt;
  }
}

std::optional<ScenePlane::Absence> ScenePlane::absence(double x, double y) const {
  if (self_->options.work->ends_early()) return Absence{"not computed before the end", -1};
  const double u = self_->varies[0] ? x : 0, v = self_->varies[1] ? y : 0;
  try {
    (void)self_->systems_from_scene(u, v);
  } catch (const ObstructedLinkage& error) {
    return Absence{error.what(), error.dyad};
  } catch (const SceneError& error) {
    return Absence{error.what(), -1};
  }
  return std::nullopt;
}

std::string ScenePlane::evidence() const {
  return fmt::format("{} geometries computed, {} interpolating patches", self_->computed.load(), self_->patches);
}

}  // namespace hb
