// Extrema over the turn: each sample of a grid that may be next to the highest one is improved on the function itself.
// The grid is that of the harmonics which nearly all of the curvature is made of; what the others add is bounded.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "lib/constants.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/fourier/waves.hpp"
#include "lib/workspace.hpp"

namespace hb::fourier {

namespace {

using Eigen::Index;
using Samples = Eigen::Ref<const Eigen::VectorXd>;

// A function and its derivatives at one angle.
struct Jet {
  double f, f1, f2, f3;
};

// Bounds over the turn of a function and of its derivatives.
struct Bounds {
  double f = 0, f1 = 0, f2 = 0;
};

// Components of a series, the harmonics of each after each other:  f = a + Re sum_k 2 c_k e^{ik tau}.
class Components {
 public:
  // Until `memory` is used again.
  Components(const FourierSeries& series, Index first, Index count, Workspace& memory)
      : H_(series.num_harmonics()),
        a_(series.c.col(0).segment(first, count).real()),
        parts_(memory.matrix((H_ + lanes - 1) / lanes * lanes, 3 * count + 1)) {
    parts_.bottomRows(parts_.rows() - H_).setZero();
    auto all = size(count);
    all.setZero();
    for (Index i = 0; i < count; ++i) {
      double *re = parts_.col(2 * i).data(), *im = parts_.col(2 * i + 1).data();
      for (Index k = 0; k < H_; ++k) {
        re[k] = 2 * series.c(first + i, k + 1).real();
        im[k] = 2 * series.c(first + i, k + 1).imag();
      }
      size(i) = parts_.col(2 * i).cwiseAbs() + parts_.col(2 * i + 1).cwiseAbs();
      all += size(i);
    }
  }

  double mean(Index i) const { return a_(i); }

  Jet at(Index i, double tau) const {
    using Four = WavesOfFour::Four;
    Four f = Four::Zero(), f1 = f, f2 = f, f3 = f;
    WavesOfFour waves(tau, true);
    for (Index first = 0; first < parts_.rows(); first += lanes, waves.advance()) {
      const Four &c = waves.cosines(), &s = waves.sines(), &n = waves.k();
      const Four re = Four::Map(&parts_(first, 2 * i)), im = Four::Map(&parts_(first, 2 * i + 1));
      const Four x = re * c - im * s, y = n * (re * s + im * c), z = n * n;
      f += x;
      f1 -= y;
      f2 -= z * x;
      f3 += z * y;
    }
    return {a_(i) + f.sum(), f1.sum(), f2.sum(), f3.sum()};
  }

  // In place of a component: all together.
  Index all() const { return a_.size(); }

  // Of one component's harmonics above K.
  Bounds above(Index i, Index K) const {
    const double* sizes = size(i).data();
    Bounds sum;
    for (Index k = K; k < H_; ++k) {
      const double n = static_cast<double>(k + 1);
      sum.f += sizes[k];
      sum.f1 += n * sizes[k];
      sum.f2 += n * n * sizes[k];
    }
    return sum;
  }

  // The fewest harmonics that leave at most this share of the bound of f''.
  Index enough(Index i, double share) const {
    const double most = share * above(i, 0).f2;
    double left = 0;
    Index K = H_;
    for (; K > 0; --K) {
      const double n = static_cast<double>(K);
      left += n * n * size(i)(K - 1);
      if (!(left <= most)) break;
    }
    return K;
  }

  // With the harmonics up to K, N x components; until the thread's next transform.
  Eigen::Map<Eigen::MatrixXd> samples(Index K, Index samples_per_wave) const {
    constexpr Index fewest = 16;
    const Index N = fast_length(std::max(samples_per_wave * (K + 1), fewest));
    RealTransform& transform = thread_transform(N, a_.size());
    auto spectrum = transform.spectrum();
    spectrum.bottomRows(spectrum.rows() - K - 1).setZero();
    for (Index i = 0; i < a_.size(); ++i) {
      spectrum(0, i) = a_(i);
      for (Index k = 0; k < K; ++k) spectrum(k + 1, i) = {0.5 * parts_(k, 2 * i), 0.5 * parts_(k, 2 * i + 1)};
    }
    transform.backward();
    return transform.samples();
  }

 private:
  static constexpr Index lanes = 4;

  Eigen::Map<Eigen::VectorXd> size(Index i) { return {parts_.col(2 * a_.size() + i).data(), parts_.rows()}; }
  Eigen::Map<const Eigen::VectorXd> size(Index i) const {
    return {parts_.col(2 * a_.size() + i).data(), parts_.rows()};
  }

  Index H_;
  Eigen::VectorXd a_;
  // From k = 1, zeros behind: per component the real and the imaginary parts of 2 c_k, then of each and of all together
  // the sum of their sizes.
  Eigen::Map<Eigen::MatrixXd> parts_;
};

double wrapped(double tau) {
  tau = std::fmod(tau, two_pi);
  if (tau < 0) tau += two_pi;
  return tau < two_pi ? tau : 0.0;
}

// Halley's iteration on f' within a step, its value kept if it is an improvement.
template <class Function>
Extremum climbed(const Function& at, double start, double step, double sign) {
  constexpr double settled = 1e-5;  // moves after which Taylor's polynomial leaves rounding alone, of a step
  constexpr int most = 20;
  Jet here = at(start);
  Extremum best{here.f, start};
  double tau = start;
  for (int iteration = 0; iteration < most && sign * here.f2 < 0; ++iteration) {
    const double newton = -here.f1 / here.f2, bent = 1 + newton * here.f3 / (2 * here.f2);
    const double move = bent > 0.5 && bent < 2 ? newton / bent : newton;
    if (!(std::abs(tau + move - start) <= step)) break;
    tau += move;
    const bool last = std::abs(move) < settled * step;
    if (last)
      here.f += move * (here.f1 + move / 2 * (here.f2 + move / 3 * here.f3));
    else
      here = at(tau);
    if (last || sign * here.f >= sign * best.value) best = {here.f, tau};
    if (last) break;
  }
  return {best.value, wrapped(best.crank_angle)};
}

// Samples of a function over the turn, two of them repeated before the first and behind the last.
class Turn {
 public:
  explicit Turn(const Samples& g) : N_(g.size()), g_(N_ + 4) {
    g_ << g.tail<2>(), g, g.head<2>();
    const auto bends = g_.head(N_) - 2 * g_.segment(1, N_) + g_.segment(2, N_);
    most_bent_ = bends.cwiseAbs().maxCoeff();
    min_ = g.minCoeff();
    max_ = g.maxCoeff();
  }

  // The largest value (sign 1) or the smallest (-1) of the function, of which the samples leave out what has the bounds
  // `missing`. Empty where that could make more extrema than the samples show.
  //
  // Between samples an eighth of the shortest wave apart the true one lies half a step away at most. There it exceeds
  // the sample by (step^2/8) max|f''|, and of second differences of such a wave that is at most 0.14; twice that is
  // taken.
  template <class Function>
  std::optional<Extremum> extremum(double sign, const Bounds& missing, const Function& at) const {
    constexpr double reach = 0.28;
    constexpr Index together = 8;  // of which all lengths are multiples
    const double step = two_pi / static_cast<double>(N_);
    const double top = (sign > 0 ? max_ : -min_) - 2 * missing.f, least = top - reach * most_bent_;
    const double* g = g_.data() + 2;
    const auto highest = [&](Index j) { return (sign * Eigen::Array<double, together, 1>::Map(g + j)).maxCoeff(); };
    const auto bend = [&](Index j) { return sign * (g[j - 1] - 2 * g[j] + g[j + 1]); };
    Extremum best{-sign * HUGE_VAL, 0};
    for (Index j = 0; j < N_; ++j) {
      if (j % together == 0 && !(highest(j) >= least)) {
        j += together - 1;
        continue;
      }
      const double here = sign * g[j];
      if (!(here >= least)) continue;
      const double before = sign * g[j - 1], after = sign * g[j + 1];
      if (!(here >= before && here >= after)) continue;
      const std::array<double, 3> bends = {bend(j - 1), bend(j), bend(j + 1)};
      if (!(here - reach * std::min({bends[0], bends[1], bends[2]}) >= top)) continue;
      if (missing.f2 > 0 && !(std::max({bends[0], bends[1], bends[2]}) < -2 * step * step * missing.f2)) return {};
      const double vertex = bends[1] < 0 ? (before - after) / (2 * bends[1]) : 0;
      const Extremum found = climbed(at, step * (static_cast<double>(j) + vertex), step, sign);
      if (sign * found.value > sign * best.value) best = found;
    }
    return best;
  }

 private:
  Index N_;
  Eigen::VectorXd g_;
  double most_bent_, min_, max_;
};

// Shares of f'' that grids leave out, one after the other until the extrema are clear.
constexpr double first_share = 1e-2;
constexpr Index samples_per_wave = 8;

const Extremum& larger(const Range& r) { return std::abs(r.max.value) >= std::abs(r.min.value) ? r.max : r.min; }

// All on one grid.
std::vector<Range> ranges_of(const FourierSeries& series, Index first, Index count) {
  thread_local Workspace memory;
  const Components f(series, first, count, memory);
  std::vector<std::optional<Extremum>> min(static_cast<std::size_t>(count)), max = min;
  const auto sought = [&](Index i) { return !min[static_cast<std::size_t>(i)] || !max[static_cast<std::size_t>(i)]; };
  for (Index i = 0; i < count; ++i)
    if (const double mean = f.mean(i); f.above(i, 0).f <= eps / 2 * std::abs(mean))
      min[static_cast<std::size_t>(i)] = max[static_cast<std::size_t>(i)] = Extremum{mean, 0};
  for (double share = first_share;; share *= share) {
    Index K = -1;
    for (Index i = 0; i < count; ++i)
      if (sought(i)) K = std::max(K, f.enough(i, share));
    if (K < 0) break;
    const Eigen::Map<Eigen::MatrixXd> samples = f.samples(K, samples_per_wave);
    for (Index i = 0; i < count; ++i) {
      if (!sought(i)) continue;
      const Bounds missing = f.above(i, K);
      const Turn turn(samples.col(i));
      const auto at = [&](double tau) { return f.at(i, tau); };
      if (auto& of = min[static_cast<std::size_t>(i)]; !of) of = turn.extremum(-1, missing, at);
      if (auto& of = max[static_cast<std::size_t>(i)]; !of) of = turn.extremum(1, missing, at);
    }
  }
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < min.size(); ++i) ranges.push_back({*min[i], *max[i]});
  return ranges;
}

}  // namespace

std::vector<Range> ranges(const FourierSeries& series) { return ranges_of(series, 0, series.num_components()); }

Range range(const FourierSeries& series, Index component) { return ranges_of(series, component, 1).front(); }

Extremum max_abs(const FourierSeries& series, Index component) {
  const Range r = range(series, component);
  return {std::abs(larger(r).value), larger(r).crank_angle};
}

Eigen::VectorXd largest_values(const FourierSeries& series) {
  Eigen::VectorXd values(series.num_components());
  Index i = 0;
  for (const Range& r : ranges(series)) values(i++) = std::abs(larger(r).value);
  return values;
}

// Of the square g = sum f_i^2, whose shortest wave is half as long. Where f is known but for r,
//     |f^2 - (f - r)^2| <= 2 |f| |r|,    |(f^2 - (f - r)^2)''| <= 2 (|f''| |r| + 2 |f'| |r'| + |f| |r''|).
Extremum largest_length(const FourierSeries& series) {
  if (series.num_harmonics() < 0) return {};
  if (series.num_components() == 1) return max_abs(series, 0);
  thread_local Workspace memory;
  const Components f(series, 0, series.num_components(), memory);
  const auto at = [&](double tau) {
    Jet g{0, 0, 0, 0};
    for (Index i = 0; i < series.num_components(); ++i) {
      const Jet x = f.at(i, tau);
      g.f += x.f * x.f;
      g.f1 += 2 * x.f * x.f1;
      g.f2 += 2 * (x.f1 * x.f1 + x.f * x.f2);
      g.f3 += 2 * (3 * x.f1 * x.f2 + x.f * x.f3);
    }
    return g;
  };
  Bounds whole = f.above(f.all(), 0);
  for (Index i = 0; i < series.num_components(); ++i) whole.f += std::abs(f.mean(i));
  std::optional<Extremum> peak;
  for (double share = first_share; !peak; share *= share) {
    const Index K = f.enough(f.all(), share);
    const Bounds r = f.above(f.all(), K);
    const Bounds missing{2 * whole.f * r.f, 0, 2 * (whole.f2 * r.f + 2 * whole.f1 * r.f1 + whole.f * r.f2)};
    auto samples = f.samples(K, 2 * samples_per_wave);
    samples.col(0) = samples.rowwise().squaredNorm();  // row by row in place
    peak = Turn(samples.col(0)).extremum(1, missing, at);
  }
  return {std::sqrt(peak->value), peak->crank_angle};
}

}  // namespace hb::fourier
