// Functions of the crank angle sampled over one turn, twice as finely until their Fourier coefficients have decayed.
// Used inside the library by whatever computes along the turn.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "lib/fourier/fourier.hpp"

namespace hb {

// Components of like nature share a group; `unit` makes them comparable there (component * unit). A component that is
// rounding noise beside its group counts as zero, and noise that no longer decays ends the refinement.
struct TurnComponent {
  int group = 0;
  double unit = 1;
};

struct TurnSamplingOptions {
  double tolerance = 1e-16;  // decay wanted, relative to each component's largest coefficient
  Eigen::Index first = 64;  // samples, a power of two
  Eigen::Index last = 1 << 14;
};

struct TurnSeries {
  FourierSeries series;  // components x (H+1), H = N/2 - 1
  std::vector<Eigen::Index> length;  // per component: coefficients above `tolerance` and above rounding; 0: all zero
  Eigen::Index num_samples = 0;  // N
  double tail = 0;  // largest coefficient beyond `length`, relative to the component's largest
  bool reached = false;  // every component has decayed, to `tolerance` or to rounding
};

// Fills columns begin, begin + step, ... of samples (components x N), at tau_j = 2 pi j / N. Each sample is asked for
// once.
using FillSamples = std::function<void(Eigen::MatrixXd& samples, Eigen::Index begin, Eigen::Index step)>;

[[nodiscard]] TurnSeries sample_turn(const std::vector<TurnComponent>& components, const FillSamples& fill,
                                     const TurnSamplingOptions& options);

// Rows first .. first+count of the series, each cut at its length, with as many harmonics as the longest needs.
[[nodiscard]] FourierSeries cut_rows(const TurnSeries& turn, Eigen::Index first, Eigen::Index count);

}  // namespace hb
