#include "hb/engine/boundaries/discriminant_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "hb/engine/system/independent_parts.hpp"
#include "lib/chebyshev.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the exponents that the discriminant is computed from.
constexpr double exponent_tolerance = 1e-10;
constexpr Index least_degree = 8, probed_degree = 64, spare_degrees = 3;
constexpr int most_halvings = 16, most_raises = 2, num_checks = 6;
// What is left of the series, of value and limit: absolute, and relative to the largest value.
constexpr double least_tail = 1e-11, relative_tail = 1e-13;
// Of the smooth numbers beside: what their series leave, and what is not told from rounding.
constexpr double few_roundings = 16 * eps;
// Largest over smallest value of a patch, both at least 1: errors are relative to the largest.
constexpr double most_spread = 1e4;

using XY = std::array<double, 2>;
using Known = std::optional<Discriminant>;

template <class Visit>
void visit_value(Visit& visit, Known& value) {
  visit_if_there(visit, value, [&](Discriminant& d) {
    for (double* number : {&d.value, &d.error, &d.damping, &d.damping_error, &d.speed}) visit(*number);
  });
}

double lebesgue(Index degree) { return 1 + 2 / pi * std::log(double(degree) + 1); }

// The smallest to the largest |Delta|, both at least 1.
double spread(std::span<const Discriminant> values) {
  double low = HUGE_VAL, high = 0;
  for (const Discriminant& d : values) {
    low = std::min(low, std::abs(d.value));
    high = std::max(high, std::abs(d.value));
  }
  return std::max(high, 1.0) / std::max(low, 1.0);
}

double largest_of(std::span<const Discriminant> values) {
  double largest = 1;
  for (const Discriminant& d : values) largest = std::max({largest, std::abs(d.value), d.limit()});
  return largest;
}

double node_error(std::span<const Discriminant> values, double amplified) {
  double error = 0;
  for (const Discriminant& d : values) error = std::max(error, d.error);
  return amplified * (error + 4 * eps * largest_of(values));
}

// Tails that are small enough: hb/engine/README.md, (D3).
double enough(std::span<const Discriminant> values, double amplified) {
  return std::max({least_tail, relative_tail * largest_of(values), node_error(values, amplified)});
}

// Degrees that the values along a line need; more than probed_degree: unknown.
Index needed_degree(std::span<const Discriminant> line) {
  VectorXd value(static_cast<Index>(line.size())), limit = value, damping = value, speed = value;
  for (Index k = 0; k < value.size(); ++k) {
    const Discriminant& d = line[static_cast<std::size_t>(k)];
    value(k) = d.value;
    limit(k) = d.limit();
    damping(k) = d.damping;
    speed(k) = d.speed;
  }
  const MatrixXd& D = to_coefficients(value.size() - 1);
  const VectorXd c = (D.transpose() * value).cwiseAbs() + (D.transpose() * limit).cwiseAbs();
  const double least = 0.3 * enough(line, lebesgue(value.size() - 1));
  Index n = c.size() - 1;
  if (c(n) > least || c(n - 1) > least) return probed_degree + 1;
  while (n > 1 && c(n - 1) <= least) --n;
  return n;
}

// A patch on its way.
struct OpenPatch {
  ParameterBox box;
  std::array<Index, 2> degree{};  // 0: the system does not vary along the axis
  int halvings = 0, raises = 0;
  std::size_t first = 0, count = 0;  // of the values last asked for
  bool checking = false;
  DiscriminantPatch patch;  // while checking

  XY place(double u, double v) const { return {box.value(0, u), box.value(1, v)}; }
};

class Builder {
 public:
  Builder(const MapSystemAt& at, const DiscriminantSurface::Request& request) : at_(at), request_(request) {}

  // False: no surface.
  bool run() {
    if (!look_ahead()) return false;
    std::vector<OpenPatch> open(1);
    open[0].box = request_.box;
    return probe(open) && fit(std::move(open));
  }

  std::vector<DiscriminantPatch> patches;
  Index divisor = 0;
  bool undamped = true;

 private:
  // Corners and middle: the harmonics that there are.
  bool look_ahead() {
    const ParameterBox& box = request_.box;
    for (const auto& [u, v] : {XY{-1, -1}, {1, -1}, {-1, 1}, {1, 1}, {0.123, 0.234}}) {
      const std::optional<ScaledSystem> system = at_(box.value(0, u), box.value(1, v));
      if (!system || system->num_modes() != 1) return false;
      divisor = std::gcd(divisor, common_divisor(*system));
      undamped = undamped && system->G(0, 0) == 0;
    }
    return divisor > 0;
  }

  // --- Values ---

  Known value(const XY& place) const {
    const std::optional<ScaledSystem> system = at_(place[0], place[1]);
    if (!system) return std::nullopt;
    return discriminant(*system, divisor, exponent_tolerance);
  }

  // Into values_. False where some place has no discriminant, or too many are needed.
  bool evaluate(const std::vector<XY>& places) {
    evaluations_ += places.size();
    if (evaluations_ > request_.most_evaluations) return false;
    constexpr std::size_t at_once = 32;
    const std::vector<std::vector<Known>> found = computed_parts<std::vector<Known>>(
        request_.parts, (places.size() + at_once - 1) / at_once,
        [&](std::size_t part) {
          std::vector<Known> values;
          for (std::size_t k = part * at_once; k < std::min((part + 1) * at_once, places.size()); ++k)
            values.push_back(value(places[k]));
          return values;
        },
        [](auto& visit, std::vector<Known>& values) {
          visit_elements(visit, values, [&](Known& each) { visit_value(visit, each); });
        });
    values_.clear();
    for (const std::vector<Known>& part : found)
      for (const Known& there : part) {
        if (!there || !std::isfinite(there->limit())) return false;
        if (undamped ? there->damping != 0 : there->damping < 0) return false;
        values_.push_back(*there);
      }
    return values_.size() == places.size();
  }

  std::span<const Discriminant> values_of(const OpenPatch& patch) const {
    return std::span(values_).subspan(patch.first, patch.count);
  }

  // --- How large patches may be, and of which degrees: along their rims ---

  struct Rim {
    std::size_t axis, first;  // of probed_degree + 1 values
  };

  bool probe(std::vector<OpenPatch>& patches) {
    std::vector<OpenPatch> open = std::move(patches), found;
    std::size_t nodes = 0;
    while (!open.empty()) {
      std::vector<XY> places;
      std::vector<std::vector<Rim>> rims;
      for (const OpenPatch& patch : open) rims.push_back(rims_of(patch, places));
      if (!evaluate(places)) return false;
      std::vector<OpenPatch> next;
      std::size_t ahead = 0;
      for (std::size_t k = 0; k < open.size(); ++k) {
        OpenPatch& patch = open[k];
        std::array<double, 2> spreads = {1, 1};
        for (const Rim& rim : rims[k]) {
          const auto line = std::span(values_).subspan(rim.first, probed_degree + 1);
          patch.degree[rim.axis] =
              std::max({patch.degree[rim.axis], least_degree, needed_degree(line) + spare_degrees});
          spreads[rim.axis] = std::max(spreads[rim.axis], spread(line));
        }
        std::array<bool, 2> halved{};
        for (const std::size_t axis : {0, 1})
          halved[axis] = patch.degree[axis] > probed_degree ||
                         (spreads[0] * spreads[1] > most_spread && spreads[axis] >= spreads[1 - axis]);
        if (!halved[0] && !halved[1]) {
          nodes += static_cast<std::size_t>((patch.degree[0] + 1) * (patch.degree[1] + 1)) + num_checks;
          found.push_back(std::move(patch));
        } else {
          const std::size_t first = next.size();
          if (!halve(patch, halved, next)) return false;
          ahead += (next.size() - first) * nodes_of_half(patch.degree, halved);
        }
      }
      open = std::move(next);
      if (evaluations_ + nodes + ahead > request_.most_evaluations) return false;
    }
    patches = std::move(found);
    return true;
  }

  // At least, of a part of a patch that needs more degrees than are probed, or has too large a spread.
  static std::size_t nodes_of_half(const std::array<Index, 2>& degree, const std::array<bool, 2>& halved) {
    std::size_t nodes = 1;
    for (const std::size_t axis : {0, 1})
      nodes *= static_cast<std::size_t>(1 + (halved[axis] ? degree[axis] / 2 : std::min(degree[axis], probed_degree)));
    return nodes;
  }

  std::vector<Rim> rims_of(const OpenPatch& patch, std::vector<XY>& places) const {
    std::vector<Rim> rims;
    const VectorXd& nodes = lobatto_nodes(probed_degree);
    for (const std::size_t axis : {0, 1}) {
      if (!request_.varies[axis]) continue;
      for (const double other : {-1.0, 1.0}) {
        if (!request_.varies[1 - axis] && other > 0) continue;
        rims.push_back({axis, places.size()});
        for (const double t : nodes) places.push_back(axis == 0 ? patch.place(t, other) : patch.place(other, t));
      }
    }
    return rims;
  }

  static bool halve(const OpenPatch& patch, const std::array<bool, 2>& halved, std::vector<OpenPatch>& next) {
    if (patch.halvings == most_halvings) return false;
    for (int upper = 0; upper < (halved[1] ? 2 : 1); ++upper)
      for (int right = 0; right < (halved[0] ? 2 : 1); ++right) {
        OpenPatch& part = next.emplace_back();
        part.box = patch.box;
        part.halvings = patch.halvings + 1;
        for (const std::size_t axis : {0, 1})
          if (halved[axis])
            ((axis == 0 ? right : upper) ? part.box.low : part.box.high)[axis] = patch.box.value(axis, 0);
      }
    return true;
  }

  // --- Polynomials ---

  bool fit(std::vector<OpenPatch> open) {
    while (!open.empty()) {
      std::vector<XY> places;
      for (OpenPatch& patch : open) {
        patch.first = places.size();
        patch.checking ? add_checks(patch, places) : add_nodes(patch, places);
        patch.count = places.size() - patch.first;
      }
      if (!evaluate(places)) return false;
      std::vector<OpenPatch> next;
      for (OpenPatch& patch : open) {
        if (patch.checking ? checked(patch) : fitted(patch)) {
          if (patch.checking) {
            patches.push_back(std::move(patch.patch));
          } else {
            patch.checking = true;
            next.push_back(std::move(patch));
          }
        } else if (!go_on(patch, next)) {
          return false;
        }
      }
      open = std::move(next);
    }
    return true;
  }

  static void add_nodes(const OpenPatch& patch, std::vector<XY>& places) {
    for (const double v : lobatto_nodes(patch.degree[1]))
      for (const double u : lobatto_nodes(patch.degree[0])) places.push_back(patch.place(u, v));
  }

  // Spread by the golden section and the square root of 2.
  static void add_checks(const OpenPatch& patch, std::vector<XY>& places) {
    for (int k = 1; k <= num_checks; ++k) {
      double whole = 0;
      const double s = std::modf(k * std::numbers::phi, &whole), t = std::modf(k * std::numbers::sqrt2, &whole);
      places.push_back(patch.place(2 * s - 1, 2 * t - 1));
    }
  }

  // False: the tails are too large.
  bool fitted(OpenPatch& open) const {
    const std::span<const Discriminant> nodes = values_of(open);
    MatrixXd value(open.degree[0] + 1, open.degree[1] + 1), limit = value, damping = value, speed = value;
    double damping_error = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto n = static_cast<Index>(k);
      value(n) = nodes[k].value;
      limit(n) = nodes[k].limit();
      damping(n) = nodes[k].damping;
      speed(n) = nodes[k].speed;
      damping_error = std::max(damping_error, nodes[k].damping_error);
    }
    DiscriminantPatch& patch = open.patch;
    patch.box = open.box;
    patch.value = ChebyshevProduct(value);
    patch.limit = ChebyshevProduct(limit);
    patch.damping = ChebyshevProduct(damping);
    patch.speed = ChebyshevProduct(speed);
    const double amplified = lebesgue(open.degree[0]) * lebesgue(open.degree[1]), most = enough(nodes, amplified);
    double tails = 0, damping_tails = 0, speed_tails = 0;
    bool done = true;
    for (const std::size_t axis : {0, 1}) {
      const double own = patch.value.tail(axis) + patch.limit.tail(axis);
      done = done && own <= most && patch.speed.tail(axis) <= few_roundings * speed.maxCoeff() &&
             patch.damping.tail(axis) <= std::max(few_roundings * damping.maxCoeff(), 1e-13);
      tails += own;
      damping_tails += patch.damping.tail(axis);
      speed_tails += patch.speed.tail(axis);
    }
    patch.error = 4 * tails + node_error(nodes, amplified) + patch.value.dropped() + patch.limit.dropped();
    patch.damping_error =
        4 * damping_tails + amplified * (damping_error + few_roundings * damping.maxCoeff()) + patch.damping.dropped();
    patch.speed_error = 4 * speed_tails + amplified * few_roundings * speed.maxCoeff() + patch.speed.dropped();
    return done;
  }

  // At places between the nodes the polynomials are as good as their tails say.
  bool checked(OpenPatch& open) const {
    DiscriminantPatch& patch = open.patch;
    double off = 0, given = 0;
    bool good = true;
    const std::span<const Discriminant> checks = values_of(open);
    std::vector<XY> places;
    add_checks(open, places);
    for (std::size_t k = 0; k < checks.size(); ++k) {
      const DiscriminantValue there = patch.at(places[k][0], places[k][1]);
      const Discriminant& truth = checks[k];
      off = std::max(off, std::abs(there.value - truth.value) + std::abs(there.limit - truth.limit()));
      given = std::max(given, truth.error);
      good = good && std::abs(there.damping - truth.damping) <= patch.damping_error &&
             std::abs(there.speed - truth.speed) <= patch.speed_error;
    }
    if (!good || !(off <= patch.error + given)) return false;
    patch.error = std::max(patch.error, 4 * off);
    return true;
  }

  // With higher degrees, or halved.
  static bool go_on(OpenPatch& patch, std::vector<OpenPatch>& next) {
    const std::array<Index, 2> degree = patch.degree;
    if (patch.raises < most_raises) {
      for (Index& n : patch.degree) n += (n + 3) / 4;
      ++patch.raises;
      patch.checking = false;
      next.push_back(std::move(patch));
      return true;
    }
    const std::size_t first = next.size();
    if (!halve(patch, {degree[0] > 0, degree[1] > 0}, next)) return false;
    for (std::size_t k = first; k < next.size(); ++k) next[k].degree = degree;
    return true;
  }

  const MapSystemAt& at_;
  const DiscriminantSurface::Request& request_;
  std::vector<Discriminant> values_;
  std::size_t evaluations_ = 0;
};

}  // namespace

std::optional<DiscriminantSurface> DiscriminantSurface::over(const MapSystemAt& at, const Request& request) {
  Builder builder(at, request);
  if (!builder.run()) return std::nullopt;
  DiscriminantSurface surface;
  surface.patches_ = std::move(builder.patches);
  surface.undamped_ = builder.undamped;
  surface.divisor_ = builder.divisor;
  return surface;
}

DiscriminantValue DiscriminantSurface::at(double x, double y) const {
  const auto patch = std::ranges::find_if(patches_, [&](const DiscriminantPatch& p) { return p.box.contains(x, y); });
  return patch == patches_.end() ? DiscriminantValue{} : patch->at(x, y);
}

std::optional<Discriminant> DiscriminantSurface::exact(const ScaledSystem& system) const {
  constexpr double sharp = 1e-11;
  return discriminant(system, divisor_, sharp);
}

}  // namespace hb
