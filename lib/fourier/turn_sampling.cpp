#include "lib/fourier/turn_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/fourier/moduli.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

// What the coefficients of one component say.
struct Decay {
  Eigen::Index length = 0;
  double tail = 0;  // largest coefficient beyond length / largest
  bool reached = false;
};

// max |c_k| over from < k <= to.
double highest(const Eigen::VectorXd& size, Eigen::Index from, Eigen::Index to) {
  return size.segment(from + 1, to - from).maxCoeff();
}

// `scale` is the largest coefficient of the group in this component's units. Rounding leaves a level that no longer
// decays; coefficients that decay geometrically and are already down to 1e-11 of the scale after 3/4 of the spectrum
// fall by orders of magnitude over the last quarter, so a last quarter like the one before is that level.
Decay decay_of(const Eigen::VectorXd& size, double scale, double tolerance) {
  constexpr double noise = 4e-15, level = 1e-11;
  const double largest = size.maxCoeff();
  if (largest <= noise * scale) return {0, scale > 0 ? largest / scale : 0, true};
  const Eigen::Index H = size.size() - 1;
  const double end = highest(size, H - std::max<Eigen::Index>(2, H / 8), H);
  const double before = highest(size, H / 2, H * 3 / 4), last = highest(size, H * 3 / 4, H);
  const bool plateau = before <= level * scale && last >= 0.1 * before;
  // The signal ends where it sinks to 2.5 times the noise's rms: over four neighbours, as single coefficients of noise
  // do stand out.
  const double noise_rms = plateau ? std::sqrt(size.tail(H / 4).squaredNorm() / static_cast<double>(H / 4)) : 0;
  const auto stands_out = [&](Eigen::Index k) {
    if (!(size(k) > tolerance * largest)) return false;
    const Eigen::Index first = std::max<Eigen::Index>(0, k - 3);
    return size.segment(first, 4).squaredNorm() > 4 * std::pow(2.5 * noise_rms, 2);
  };

  Decay decay;
  decay.reached = end <= tolerance * largest || plateau;
  decay.length = size.size();
  while (decay.length > 1 && !stands_out(decay.length - 1)) --decay.length;
  if (decay.length < size.size())
    decay.tail = size.tail(size.size() - decay.length).maxCoeff() / largest;
  else
    decay.tail = end / largest;
  return decay;
}

}  // namespace

TurnSeries sample_turn(const std::vector<TurnComponent>& components, const FillSamples& fill,
                       const TurnSamplingOptions& options) {
  const auto n = static_cast<Eigen::Index>(components.size());
  TurnSeries turn;
  Eigen::MatrixXd samples(n, 0);
  for (Eigen::Index N = options.first; N <= options.last; N *= 2) {
    end_if_wished();
    Eigen::MatrixXd finer(n, N);
    if (samples.cols() == 0) {
      fill(finer, 0, 1);
    } else {
      for (Eigen::Index j = 0; j < samples.cols(); ++j) finer.col(2 * j) = samples.col(j);
      fill(finer, 1, 2);
    }
    samples.swap(finer);
    turn.series = fourier::analyse(samples);
    turn.num_samples = N;

    const Eigen::MatrixXd size = fourier::moduli(turn.series.c);
    std::map<int, double> group_scale;
    for (Eigen::Index i = 0; i < n; ++i) {
      const TurnComponent& component = components[static_cast<std::size_t>(i)];
      double& scale = group_scale[component.group];
      scale = std::max(scale, size.row(i).maxCoeff() * component.unit);
    }
    turn.length.assign(components.size(), 0);
    turn.tail = 0;
    turn.reached = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      const TurnComponent& component = components[static_cast<std::size_t>(i)];
      const Decay decay =
          decay_of(size.row(i).transpose(), group_scale[component.group] / component.unit, options.tolerance);
      turn.length[static_cast<std::size_t>(i)] = decay.length;
      turn.tail = std::max(turn.tail, decay.tail);
      turn.reached = turn.reached && decay.reached;
    }
    if (turn.reached || !samples.allFinite()) break;
  }
  return turn;
}

FourierSeries cut_rows(const TurnSeries& turn, Eigen::Index first, Eigen::Index count) {
  const auto begin = turn.length.begin() + first;
  const Eigen::Index columns = std::max<Eigen::Index>(1, *std::max_element(begin, begin + count));
  FourierSeries rows(count, columns - 1);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index length = turn.length[static_cast<std::size_t>(first + i)];
    rows.c.row(i).head(length) = turn.series.c.row(first + i).head(length);
  }
  return rows;
}

}  // namespace hb
