#include "hb/engine/boundaries/surface_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/chebyshev.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// h counts as zero up to so many times the patch's error.
constexpr double safe_errors = 10;

double clenshaw(const VectorXd& c, double t) {
  double last = 0, sum = 0;
  for (Index k = c.size() - 1; k > 0; --k) {
    const double next = 2 * t * sum - last + c(k);
    last = sum;
    sum = next;
  }
  return t * sum - last + c(0);
}

// h over a part of the line that lies in one patch.
struct LinePiece {
  double from, to, unit_from, unit_to;  // in places and in the patch's own unit
  VectorXd value, limit;
  double error;

  // Coefficients over [t0, t1] of the piece, 0 <= t0 < t1 <= 1.
  [[nodiscard]] VectorXd over(double sign, double t0, double t1) const {
    const Index degree = std::max(value.size(), limit.size()) - 1;
    const VectorXd& nodes = lobatto_nodes(degree);
    VectorXd h(degree + 1);
    for (Index k = 0; k <= degree; ++k) {
      const double t = 0.5 * ((1 - nodes(k)) * t0 + (1 + nodes(k)) * t1), u = (1 - t) * unit_from + t * unit_to;
      h(k) = sign * clenshaw(value, u) - clenshaw(limit, u);
    }
    return to_coefficients(degree).transpose() * h;
  }
};

std::vector<LinePiece> pieces(const DiscriminantSurface& surface, const MapLine& line) {
  const std::size_t axis = line.along_x ? 0 : 1, other = 1 - axis;
  std::vector<LinePiece> found;
  for (const DiscriminantPatch& patch : surface.patches()) {
    const ParameterBox& box = patch.box;
    // Where two patches meet the upper one has the line, but for the last.
    if (!(line.fixed >= box.low[other] && line.fixed <= box.high[other])) continue;
    const double from = std::max(line.low, box.low[axis]), to = std::min(line.high, box.high[axis]);
    if (!(from < to)) continue;
    const double place = box.unit(other, line.fixed);
    found.push_back({from, to, box.unit(axis, from), box.unit(axis, to), patch.value.along(axis, place),
                     patch.limit.along(axis, place), patch.error});
  }
  std::ranges::stable_sort(found, {}, &LinePiece::from);
  // A line between two rows of patches is in both.
  std::vector<LinePiece> once;
  for (LinePiece& piece : found) {
    if (!once.empty()) piece.from = std::max(piece.from, once.back().to);
    if (piece.from < piece.to) once.push_back(std::move(piece));
  }
  return once;
}

// Zeros of one piece for one sign of Delta: (D6).
class ZeroSearch {
 public:
  ZeroSearch(const LinePiece& piece, bool positive) : piece_(piece), positive_(positive) { search(0, 1, 0); }

  bool settled = true;
  std::vector<SurfaceZero> zeros;

 private:
  void search(double t0, double t1, int depth) {
    constexpr int deepest = 16;
    const VectorXd c = piece_.over(positive_ ? 1 : -1, t0, t1);
    const double margin = safe_errors * piece_.error;
    double others = 0, steeper = 0;
    for (Index k = 1; k < c.size(); ++k) others += std::abs(c(k));
    for (Index k = 2; k < c.size(); ++k) steeper += double(k * k) * std::abs(c(k));
    if (std::abs(c(0)) - others > margin) return;
    if (c.size() > 1 && std::abs(c(1)) > steeper) return monotonic(c, t0, t1, margin);
    if (depth == deepest) {
      settled = false;
      return;
    }
    constexpr double nearly_half = 0.4871;  // zeros at simple places do not fall on it
    const double middle = t0 + nearly_half * (t1 - t0);
    search(t0, middle, depth + 1);
    if (settled) search(middle, t1, depth + 1);
  }

  void monotonic(const VectorXd& c, double t0, double t1, double margin) {
    double low = -1, high = 1, h_low = clenshaw(c, -1), h_high = clenshaw(c, 1);
    if (!(std::abs(h_low) > margin && std::abs(h_high) > margin)) {
      settled = false;
      return;
    }
    if ((h_low > 0) == (h_high > 0)) return;
    const bool rises = h_high > 0;
    double t = 0;
    for (int step = 0; step < 60 && high - low > 4 * eps; ++step) {
      // Illinois rule, halving every third time.
      t = step % 3 == 2 ? 0.5 * (low + high) : (low * h_high - high * h_low) / (h_high - h_low);
      const double h = clenshaw(c, t);
      if (h == 0) break;
      ((h > 0) == rises ? high : low) = t;
      ((h > 0) == rises ? h_high : h_low) = h;
    }
    const double step = 1e-4, left = std::max(t - step, -1.0), right = std::min(t + step, 1.0);
    const double part = 0.5 * (t1 - t0) * (piece_.to - piece_.from);
    const double place = piece_.from + (piece_.to - piece_.from) * 0.5 * ((1 - t) * t0 + (1 + t) * t1);
    zeros.push_back(
        {place, (clenshaw(c, right) - clenshaw(c, left)) / ((right - left) * part), piece_.error, positive_});
  }

  const LinePiece& piece_;
  bool positive_;
};

struct LimitDistance {
  double h, error;
};

std::optional<LimitDistance> distance_at(const DiscriminantSurface& surface, const SystemAt& along, double t,
                                         bool positive) {
  const std::optional<ScaledSystem> system = along(t);
  if (!system) return std::nullopt;
  const std::optional<Discriminant> d = surface.exact(*system);
  if (!d) return std::nullopt;
  const double limit = d->limit();
  return LimitDistance{(positive ? d->value : -d->value) - limit,
                       d->error + std::sinh(pi * d->damping) * pi * d->damping_error + 2 * eps * limit};
}

}  // namespace

std::optional<std::vector<SurfaceZero>> surface_zeros(const DiscriminantSurface& surface, const MapLine& line) {
  std::vector<SurfaceZero> zeros;
  double reached = line.low;
  for (const LinePiece& piece : pieces(surface, line)) {
    if (piece.from > reached) return std::nullopt;
    reached = piece.to;
    for (const bool positive : {true, false}) {
      ZeroSearch search(piece, positive);
      if (!search.settled) return std::nullopt;
      zeros.insert(zeros.end(), search.zeros.begin(), search.zeros.end());
    }
  }
  if (!(reached >= line.high)) return std::nullopt;
  std::ranges::sort(zeros, {}, &SurfaceZero::place);
  return zeros;
}

std::optional<StabilityBoundary> boundary_at(const DiscriminantSurface& surface, const SystemAt& along,
                                             const MapLine& line, const SurfaceZero& zero, double tolerance) {
  constexpr int most_tries = 8;
  const double size = std::max(std::abs(line.low), std::abs(line.high)), wanted = tolerance * size;
  double place = zero.place, slope = zero.slope, half = wanted;
  if (!(slope != 0)) return std::nullopt;
  const auto inside = [&](double t) { return std::clamp(t, line.low, line.high); };
  // Where the surface is not known so well the system itself says where to look.
  if (!(zero.error <= 0.5 * std::abs(slope) * wanted)) {
    const auto there = distance_at(surface, along, place, zero.positive);
    if (!there) return std::nullopt;
    place = inside(place - there->h / slope);
    half = std::max(half, 2 * there->error / std::abs(slope));
  }
  for (int k = 0; k < most_tries; ++k, half *= 4) {
    const double left = inside(place - half), right = inside(place + half);
    const auto a = distance_at(surface, along, left, zero.positive),
               b = distance_at(surface, along, right, zero.positive);
    if (!a || !b || !(left < right)) return std::nullopt;
    const bool known = std::abs(a->h) > a->error && std::abs(b->h) > b->error;
    if (known && (a->h > 0) != (b->h > 0) && (b->h > 0) == (slope > 0)) {
      StabilityBoundary boundary;
      boundary.x = std::clamp((left * b->h - right * a->h) / (b->h - a->h), left, right);
      boundary.error = std::max(right - boundary.x, boundary.x - left);
      boundary.kind = surface.kind(zero.positive);
      boundary.unstable_above = slope > 0;
      boundary.converged = boundary.error <= promised_of_boundaries * size;
      return boundary;
    }
    if (b->h != a->h) {
      const double steeper = (b->h - a->h) / (right - left);
      if ((steeper > 0) == (slope > 0)) place = inside(left - a->h / steeper);
    }
  }
  return std::nullopt;
}

namespace {

template <int degree>
using PieceMatrix = Eigen::Matrix<double, degree + 1, degree + 1>;

// Delta and L over a small part of a patch, with what is left of both series.
template <int degree>
struct SurfacePiece {
  PieceMatrix<degree> value, limit;
  double left = 0;

  SurfacePiece() = default;
  SurfacePiece(const DiscriminantPatch& patch, const ParameterBox& part) {
    const VectorXd& nodes = lobatto_nodes(degree);
    VectorXd u(degree + 1), v(degree + 1);
    for (Index k = 0; k <= degree; ++k) {
      u(k) = patch.box.unit(0, part.value(0, nodes(k)));
      v(k) = patch.box.unit(1, part.value(1, nodes(k)));
    }
    const PieceMatrix<degree> D = to_coefficients(degree);
    const auto add = [&](const ChebyshevProduct& product, PieceMatrix<degree>& c) {
      c = D.transpose() * PieceMatrix<degree>(product.at_all(u, v)) * D;
      left += c.template bottomRows<2>().cwiseAbs().sum() + c.template rightCols<2>().cwiseAbs().sum();
    };
    add(patch.value, value);
    add(patch.limit, limit);
  }

  // Coefficients over the lower and the upper half of an axis are these times those over the whole.
  static const std::array<PieceMatrix<degree>, 2>& halves() {
    static const std::array<PieceMatrix<degree>, 2> both = [] {
      std::array<PieceMatrix<degree>, 2> half;
      const VectorXd& nodes = lobatto_nodes(degree);
      for (const std::size_t upper : {0, 1}) {
        PieceMatrix<degree> values;
        for (Index k = 0; k <= degree; ++k)
          values.row(k) = chebyshev(0.5 * nodes(k) + (upper ? 0.5 : -0.5), degree).transpose();
        half[upper] = to_coefficients(degree).transpose() * values;
      }
      return half;
    }();
    return both;
  }

  // Shown by sums of coefficients, of the piece or of its parts: (D8).
  [[nodiscard]] bool one_verdict(double margin, int depth) const {
    bool below = true;
    for (const double sign : {1.0, -1.0}) {
      const PieceMatrix<degree> h = sign * value - limit;
      const double first = h(0, 0), others = h.cwiseAbs().sum() - std::abs(first) + left;
      if (first - others > -margin) return true;
      below = below && first + others < margin;
    }
    if (below) return true;
    if (depth == 0) return false;
    for (const PieceMatrix<degree>& u : halves())
      for (const PieceMatrix<degree>& v : halves()) {
        SurfacePiece quarter;
        quarter.value = u * value * v.transpose();
        quarter.limit = u * limit * v.transpose();
        quarter.left = left;
        if (!quarter.one_verdict(margin, depth - 1)) return false;
      }
    return true;
  }
};

bool one_verdict(const DiscriminantPatch& patch, const ParameterBox& part, int depth) {
  // A growth of 1e-5 of the speed.
  constexpr double least = 2e-9;
  const double margin = std::max(least, safe_errors * patch.error);
  if (SurfacePiece<4>(patch, part).one_verdict(margin, 0)) return true;
  if (depth == 0) return false;
  const SurfacePiece<12> piece(patch, part);
  if (piece.left < 0.1 * margin) return piece.one_verdict(margin, depth);
  if (piece.one_verdict(margin, 0)) return true;
  for (int k = 0; k < 4; ++k) {
    ParameterBox quarter = part;
    for (const std::size_t axis : {0, 1})
      (((axis == 0 ? k : k / 2) % 2 == 0) ? quarter.high : quarter.low)[axis] = part.value(axis, 0);
    if (!one_verdict(patch, quarter, depth - 1)) return false;
  }
  return true;
}

}  // namespace

bool verdict_may_change(const DiscriminantSurface& surface, const ParameterBox& box) {
  constexpr int deepest = 5;
  for (const DiscriminantPatch& patch : surface.patches()) {
    ParameterBox part;
    for (std::size_t axis : {0, 1}) {
      part.low[axis] = std::max(box.low[axis], patch.box.low[axis]);
      part.high[axis] = std::min(box.high[axis], patch.box.high[axis]);
    }
    if (!(part.low[0] < part.high[0] && part.low[1] < part.high[1])) continue;
    if (!one_verdict(patch, part, deepest)) return true;
  }
  return false;
}

}  // namespace hb
