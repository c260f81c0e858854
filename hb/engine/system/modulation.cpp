#include "hb/engine/system/modulation.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/lanes.hpp"
#include "lib/parts.hpp"
#include "lib/workspace.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// Whether the harmonics above the mean of every entry are, but for `relative` of the largest, the sums of the
// functions, whose terms are not much larger than the sum: sums over the turn would lose that much to rounding. Real
// and imaginary parts in turn, as they stand in K; some are looked at twice.
template <class Length>
bool tells(Modulation& modulation, const FourierSeries& K, double relative, Length r) {
  constexpr Index width = Lanes::width;
  constexpr double largest_terms = 16;
  const Index P = modulation.functions.rows(), entries = K.num_components(), n = 2 * entries;
  thread_local Workspace kept;
  auto room = kept.matrix(std::max(n, width), (P + 1) * r + 3);
  auto functions = room.topLeftCorner(width, (P + 1) * r);  // last: shares of one group of entries
  auto largest = room.col((P + 1) * r), left = room.col((P + 1) * r + 1), left_out = room.col((P + 1) * r + 2);
  for (Index k = 0; k < P; ++k)
    for (Index m = 0; m < r; ++m)
      for (Index lane = 0; lane < width; ++lane)
        functions(lane, r * k + m) =
            lane % 2 == 0 ? modulation.functions(k, m).real() : modulation.functions(k, m).imag();
  for (Index first = 0; first < n; first += width) {
    const Index begin = std::min(first, n - width);
    for (Index m = 0; m < r; ++m)
      for (Index lane = 0; lane < width; ++lane) functions(lane, r * P + m) = modulation.shares((begin + lane) / 2, m);
    Lanes most, most_left, all_left;
    for (Index k = 0; k < P; ++k) {
      const Lanes given = Lanes::load(parts(K.c).col(k + 1).data() + begin);
      Lanes rest = given;
      for (Index m = 0; m < r; ++m)
        rest -= Lanes::load(&functions(0, r * P + m)) * Lanes::load(&functions(0, r * k + m));
      most = max(most, abs(given));
      most_left = max(most_left, abs(rest));
      all_left += abs(rest);
    }
    most.store(&largest(begin));
    most_left.store(&left(begin));
    all_left.store(&left_out(begin));
  }
  const Eigen::VectorXd peaks = modulation.functions.cwiseAbs2().colwise().maxCoeff().cwiseSqrt().transpose();
  modulation.left_out.resize(entries);
  for (Index q = 0; q < entries; ++q) {
    double terms = 0;
    for (Index m = 0; m < r; ++m) terms += std::abs(modulation.shares(q, m)) * peaks(m);
    const double size = std::max(largest(2 * q), largest(2 * q + 1));
    modulation.left_out(q) = 2 * (left_out(2 * q) + left_out(2 * q + 1));
    if (!(std::max(left(2 * q), left(2 * q + 1)) <= relative * size && terms <= largest_terms * size &&
          std::isfinite(modulation.left_out(q))))
      return false;
  }
  return true;
}

}  // namespace

Eigen::Map<MatrixXd> Modulation::samples(Index N) const {
  fourier::RealTransform& transform = fourier::thread_transform(N, functions.cols());
  auto spectrum = transform.spectrum();
  spectrum.row(0).setZero();
  spectrum.middleRows(1, functions.rows()) = functions;
  spectrum.bottomRows(spectrum.rows() - 1 - functions.rows()).setZero();
  transform.backward();
  return transform.samples();
}

// Gauss's elimination of the entries, each a row of its first harmonics: the next function is what is left of the entry
// that has most left of itself, its shares are told by its largest harmonic. All harmonics then show whether that is
// all there is to them.
Modulation modulation_of(const FourierSeries& K, Index num_modes) {
  constexpr Index first_harmonics = 4, most_functions = 8;
  constexpr double enough = 4 * eps;
  const Index P = K.num_harmonics(), I = num_modes, n = I * I, looked_at = std::min(P, first_harmonics);
  const Index most = std::min(most_functions, I * (I + 1) / 4);
  if (most < 1 || P < 1) return {};
  thread_local Workspace kept;
  auto room = kept.matrix(n, 2 * looked_at + 2);
  auto left = room.leftCols(2 * looked_at);
  auto size = room.col(2 * looked_at), most_left = room.col(2 * looked_at + 1);
  for (Index k = 0; k < looked_at; ++k) {
    left.col(2 * k) = K.c.col(k + 1).real();
    left.col(2 * k + 1) = K.c.col(k + 1).imag();
  }
  const auto look = [&](auto&& largest) {
    largest = left.col(0).cwiseAbs();
    for (Index c = 1; c < left.cols(); ++c) largest = largest.cwiseMax(left.col(c).cwiseAbs());
  };
  look(size);
  Modulation modulation{Eigen::MatrixXcd(P, most), MatrixXd(n, most)};
  Index found = 0;
  for (;; ++found) {
    look(most_left);
    Index next = -1;
    double farthest = enough;
    for (Index q = 0; q < n; ++q)
      if (most_left(q) > farthest * size(q)) farthest = most_left(q) / size(q), next = q;
    if (next < 0) break;
    if (found == most || !std::isfinite(farthest)) return {};
    Index largest = 0;
    left.row(next).cwiseAbs().maxCoeff(&largest);
    auto shares = modulation.shares.col(found);
    shares = left.col(largest) / left(next, largest);
    shares(next) = 1;
    for (Index c = 0; c < left.cols(); ++c) {
      const double here = left(next, c);
      left.col(c) -= here * shares;
      left(next, c) = 0;
    }
    auto function = modulation.functions.col(found);
    function = K.c.row(next).tail(P).transpose();
    for (Index m = 0; m < found; ++m) function -= modulation.shares(next, m) * modulation.functions.col(m);
  }
  if (found == 0) return {};
  modulation.functions.conservativeResize(Eigen::NoChange, found);
  modulation.shares.conservativeResize(Eigen::NoChange, found);
  bool all = false;
  with_functions(found, [&](auto r) { all = tells(modulation, K, enough, r); });
  return all ? modulation : Modulation();
}

}  // namespace hb
