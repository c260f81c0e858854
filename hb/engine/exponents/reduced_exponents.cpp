#include "hb/engine/exponents/reduced_exponents.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "hb/engine/exponents/mathieu_determinant.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/scalar_hill.hpp"
#include "hb/engine/exponents/turn_exponents.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// Error allowed at an exponent: relative to it, or to a hundredth of the crank's speed if it is smaller.
double allowed(double tolerance, cplx s) { return tolerance * std::max(std::abs(s.real()), 0.01); }

// At the others than the leading one: relative to them, or to the crank's speed.
double further_allowed(double tolerance, cplx s) { return std::max(tolerance, 1e-9) * std::max(std::abs(s), 1.0); }

// Harmonics of alpha and beta that the cells of a propagation have to resolve: the others together, each averaged over
// its own short period, move no exponent by more than `negligible`.
Index resolved_harmonics(const ReducedSystem& reduced, double negligible) {
  Index k = std::max(reduced.alpha.num_harmonics(), reduced.beta.num_harmonics());
  for (double sum = 0; k > 0; --k) {
    if (k < reduced.alpha.c.cols()) sum += 2 * reduced.alpha.c.col(k).cwiseAbs().maxCoeff() / double(k);
    if (k < reduced.beta.c.cols()) sum += 2 * reduced.beta.c.col(k).cwiseAbs().maxCoeff();
    if (!(sum <= negligible)) break;
  }
  return k;
}

// Of one mode by its phase function; empty if that does not settle.
std::optional<Exponents> by_phase(const ReducedSystem& reduced, double tolerance) {
  const double frequency = std::sqrt(std::abs(reduced.alpha.c(0, 0)));
  const double wanted =
      std::max(0.5 * tolerance * std::max(std::abs(reduced.beta.c(0, 0).real()) / 2, 0.01), 1e-12 * frequency);
  const auto pair = phase_exponents(reduced.alpha, reduced.beta, reduced.alpha_error(0), reduced.beta_error(0), wanted);
  if (!pair) return std::nullopt;
  Exponents result;
  result.s.assign(pair->s.begin(), pair->s.end());
  result.error.assign(pair->error.begin(), pair->error.end());
  result.imaginary_error = result.error;
  result.converged = true;
  return result;
}

// Of one mode with a single harmonic and constant damping by Hill's determinant.
std::optional<Exponents> by_determinant(const ReducedSystem& reduced, double tolerance) {
  if (reduced.num_modes != 1 || reduced.alpha.num_harmonics() != 1 || reduced.beta.num_harmonics() != 0)
    return std::nullopt;
  const auto pair = mathieu_exponents({.w2 = reduced.alpha.c(0, 0).real(),
                                       .q = std::abs(reduced.alpha.c(0, 1)),
                                       .b = reduced.beta.c(0, 0).real(),
                                       .stiffness_error = reduced.alpha_error(0),
                                       .damping_error = reduced.beta_error(0)});
  if (!pair) return std::nullopt;
  Exponents result;
  result.s.assign(pair->s.begin(), pair->s.end());
  result.error.assign(pair->error.begin(), pair->error.end());
  result.imaginary_error = result.error;
  result.converged = pair->error[0] <= allowed(tolerance, pair->s[0]);
  return result;
}

// About the frequencies of the modes kept, which balance the coordinates.
VectorXd mode_sizes(const ReducedSystem& reduced) {
  const Index m = reduced.num_modes;
  VectorXd W(m);
  for (Index i = 0; i < m; ++i) W(i) = std::max(1.0, std::sqrt(std::abs(reduced.alpha.c(i + m * i, 0))));
  return W;
}

// Fastest frequency kept: sqrt of the largest row sum of |alpha| in balanced coordinates.
double fastest_frequency(const ReducedSystem& reduced, const VectorXd& W) {
  const Index m = reduced.num_modes;
  double fastest2 = 1;
  for (Index i = 0; i < m; ++i) {
    double row = 0;
    for (Index j = 0; j < m; ++j) row += fourier::wiener_norm(reduced.alpha, i + m * j) / (W(i) * W(j)) * W(i) * W(i);
    fastest2 = std::max(fastest2, row);
  }
  return std::sqrt(fastest2);
}

// Arithmetic of a turn's propagation, in some unit.
double work(const ReducedSystem& reduced, double cells) {
  return cells * (std::pow(double(reduced.num_modes), 3) + 100);
}
constexpr double most_further_work = 1e6;  // about a second's, for other exponents than the leading one

// Cells to begin with.
Index first_cells(const ReducedSystem& reduced, double fastest, double tolerance, bool leading_only) {
  // A harmonic that is a multiple of the number of cells leaves the same error in every cell: two numbers of cells may
  // agree by chance.
  constexpr Index fewest_cells = 12;
  Index least =
      std::max({fewest_cells, Index(std::ceil(0.8 * fastest)), resolved_harmonics(reduced, 1e-3 * tolerance) + 1});
  const auto needed = [&](Index mode, double error) {  // as oscillator_error tells
    const Index own = mode + reduced.num_modes * mode;
    const double w2 = reduced.alpha.c(own, 0).real(), b = reduced.beta.c(own, 0).real();
    const double cells = w2 > b * b ? oscillator_cells(std::sqrt(w2), error) : 0;
    return cells < 8.0 * double(least) ? cells : 0;
  };
  const auto decay = [&](Index mode) { return -reduced.beta.c(mode + reduced.num_modes * mode, 0).real() / 2; };
  if (reduced.num_modes == 1) {
    if (reduced.alpha.c(0, 0).real() > 0)
      least = std::max(least, Index(std::ceil(needed(0, allowed(tolerance, decay(0))))));
    return radau_cells(least);
  }
  // Of several, coupled, hardly fewer than each one alone.
  double all = 0;
  for (Index i = 0; i < reduced.num_modes; ++i) all = std::max(all, needed(i, allowed(tolerance, decay(i))));
  Index cells = radau_cells(least);
  while (double(radau_cells(cells + 1)) <= all) cells = radau_cells(cells + 1);
  // Where all are wanted, at least what each one's oscillator needs.
  for (Index i = 0; i < reduced.num_modes && !leading_only; ++i) {
    const Index own = radau_cells(Index(std::ceil(needed(i, further_allowed(tolerance, decay(i))))));
    if (work(reduced, double(own)) < most_further_work) cells = std::max(cells, own);
  }
  return cells;
}

// Exponents with so many cells, and how much each differs from those with fewer.
struct Cells {
  TurnMaps maps;
  TurnExponents turn;
  std::vector<double> change, turned;  // the second one of the imaginary part; empty: nothing to compare with
};

// `changed`: with truncation at what the number of cells changes. The others: with what should be left of it.
struct TruncatedErrors {
  std::vector<double> changed, left, imaginary;
};

// fine.change and fine.turned from the nearest exponents of `coarse`; returned is the number of each.
std::vector<std::size_t> compare(const Cells& coarse, Cells& fine) {
  const std::size_t n = fine.turn.s.size();
  fine.change.assign(n, HUGE_VAL);
  fine.turned.assign(n, HUGE_VAL);
  std::vector<std::size_t> nearest(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < coarse.turn.s.size(); ++k) {
      const cplx apart = fine.turn.s[i] - coarse.turn.s[k];
      const double turn = std::abs(apart.imag() - std::round(apart.imag()));
      const double distance = std::hypot(apart.real(), turn);
      if (!(distance < fine.change[i])) continue;
      fine.change[i] = distance;
      fine.turned[i] = turn;
      nearest[i] = k;
    }
  return nearest;
}

// log of what a vector that has gone around once grows by in each of so many equal parts of the next turn.
VectorXd growth_by_parts(const TurnMaps& maps, Index parts) {
  const Index n = maps.num_states(), N = maps.num_cells;
  VectorXd v = VectorXd::Ones(n), growth = VectorXd::Zero(parts);
  for (Index i = 0; i < 2 * N; ++i) {
    v = (maps.cells.middleCols(n * (i % N), n) * v).eval();
    const double size = v.norm();
    v /= size;
    if (i >= N) growth((i - N) * parts / N) += std::log(size);
  }
  return growth;
}

// hb/engine/README.md (E30).
double uncancelled_change(const TurnMaps& coarse, const TurnMaps& fine) {
  const Index parts = std::gcd(coarse.num_cells, fine.num_cells);
  return (growth_by_parts(fine, parts) - growth_by_parts(coarse, parts)).lpNorm<1>() / two_pi;
}

// What may be left of an exponent that still changes by so much.
double unresolved(cplx s, double change) {
  return std::max(2 * change, std::min(4 * change, 0.5 * std::abs(s.real())));
}

// hb/engine/README.md (E17), (E18).
TruncatedErrors errors_from(const Cells& coarse, Cells& fine, bool leading_only) {
  constexpr double asymptotic = 1e-3;  // larger changes do not tell how errors fall
  const std::size_t n = fine.turn.s.size();
  const std::vector<std::size_t> nearest = compare(coarse, fine);
  const double ratio = double(coarse.maps.num_cells) / double(fine.maps.num_cells);
  const double of_order = std::pow(ratio, 15), slower = std::pow(ratio, n > 2 ? 9 : 7.5);
  const double slowest = std::pow(ratio, 6);  // of real multipliers
  const auto real = [&](std::size_t i) { return fine.turn.s[i].imag() == 0 || fine.turn.s[i].imag() == 0.5; };
  double largest = 0;
  for (const double change : fine.change) largest = change < asymptotic ? std::max(largest, change) : largest;
  // One mode has no others to compare with, and of leading ones alone those that would tell may be lost.
  const bool one_mode = fine.maps.num_states() == 2;
  const double in_parts = n > 0 && real(0) && (one_mode || leading_only)
                              ? std::pow(ratio, 3.75) * uncancelled_change(coarse.maps, fine.maps)
                              : 0;
  TruncatedErrors errors;
  for (std::size_t i = 0; i < n; ++i) {
    const double change = fine.change[i], rounding = fine.turn.error[i];
    // Two that agree by chance do not make up for the step before,
    double least = coarse.change.empty() ? 0 : coarse.change[nearest[i]] * of_order;
    errors.changed.push_back(std::max(change, least) + rounding);
    // nor, with real multipliers, for others of that sign and for parts of the turn.
    for (std::size_t k = 0; k < n && real(i); ++k)
      if (fine.turn.s[k].imag() == fine.turn.s[i].imag() && fine.change[k] < asymptotic)
        least = std::max(least, 2 * of_order * fine.change[k]);
    if (i == 0 || one_mode) least = std::max(least, in_parts);
    const bool falls = change < asymptotic;
    errors.left.push_back(
        std::max(falls ? std::min(change, (real(i) ? slowest : slower) * largest) : unresolved(fine.turn.s[i], change),
                 least) +
        rounding);
    errors.imaginary.push_back(
        falls ? std::max({std::min(fine.turned[i], slower * largest), 2 * of_order * change, least}) + rounding
              : errors.left.back());
  }
  return errors;
}

}  // namespace

// Exponents of a reduced system by propagation with growing numbers of cells.
Exponents propagated_exponents(const ReducedSystem& reduced, double tolerance, bool leading_only) {
  const Index m = reduced.num_modes;
  const VectorXd W = mode_sizes(reduced);
  const double fastest = fastest_frequency(reduced, W);

  // Beyond some seconds' work nothing is known.
  constexpr double most_work = 1e8;
  if (!(work(reduced, 0.8 * fastest) < most_work)) {
    Exponents nothing;
    nothing.others_below = HUGE_VAL;
    return nothing;
  }
  const Index least = first_cells(reduced, fastest, tolerance, leading_only), most = std::max<Index>(512, 12 * least);
  constexpr Index most_further = 4;
  Index enough = 0;  // cells for the leading one
  Exponents result;
  std::optional<Cells> coarse;
  bool compared = false;
  // Effect on the real part of the mean damping, which the discriminant takes as given.
  const double damping_error = m == 1 ? reduced.beta_error(0) / 2 : 0;
  for (Index cells = least; cells <= most && work(reduced, double(cells)) < most_work; cells = radau_cells(cells + 1)) {
    TurnMaps maps = radau_turn(reduced.alpha, reduced.beta, m, cells);
    if (!coarse) {
      TurnExponents values = turn_values(maps, leading_only);
      coarse = Cells{std::move(maps), std::move(values), {}, {}};
      continue;
    }
    // Errors of the coefficients over a cell: h d alpha W^-1, h d beta.
    MatrixXd given = MatrixXd::Zero(2 * m, 2 * m);
    const double h = two_pi / double(cells);
    given.bottomLeftCorner(m, m) = h * reduced.alpha_error * W.cwiseInverse().asDiagonal();
    given.bottomRightCorner(m, m) = h * reduced.beta_error;
    TurnExponents turn = turn_exponents(maps, given, leading_only, coarse->turn.subspaces);
    Cells fine{std::move(maps), std::move(turn), {}, {}};
    TruncatedErrors errors = errors_from(*coarse, fine, leading_only);
    // Two that agree by chance do not make up for what one mode's cells leave at its fastest either.
    const double least = m == 1 ? oscillator_error(fastest, double(cells)) : 0;
    // The cells' length and the method's tables are rounded alike in all of them.
    const double alike = eps * fastest;
    for (auto* of : {&errors.changed, &errors.left, &errors.imaginary})
      for (double& error : *of) error = std::max(error, least) + damping_error + alike;
    result.s = fine.turn.s;
    result.others_below = fine.turn.others_below;
    compared = true;
    result.error = errors.left;
    result.imaginary_error = errors.imaginary;
    if (result.s.empty()) break;
    // At rounding more cells gain nothing.
    const auto at_rounding = [&](std::size_t i) { return errors.changed[i] <= 2 * fine.turn.error[i]; };
    result.converged = errors.changed[0] <= allowed(tolerance, fine.turn.s[0]);
    bool done = result.converged || at_rounding(0);
    if (done && enough == 0) enough = cells;
    const bool further =
        !leading_only && cells < most_further * enough && work(reduced, double(cells)) < most_further_work;
    for (std::size_t i = 1; i < fine.turn.s.size() && further; ++i)
      done = done && (at_rounding(i) || errors.changed[i] <= further_allowed(tolerance, fine.turn.s[i]));
    if (done) break;
    coarse = std::move(fine);
  }
  if (!compared) {
    if (coarse) result.s = coarse->turn.s;
    result.error.assign(result.s.size(), HUGE_VAL);
    result.imaginary_error = result.error;
    result.others_below = HUGE_VAL;
  }
  return result;
}

// Exponents of the modes kept by one reduction. A single slow mode is propagated as fast as its phase is found, and
// propagation always settles. Where none is as accurate as asked, the best counts: near a double multiplier +-1 the
// determinant's four factors tell growth far better than a propagated map does.
Exponents reduced_exponents(const ReducedSystem& reduced, double tolerance, bool leading_only) {
  std::optional<Exponents> determinant = by_determinant(reduced, tolerance);
  if (determinant && determinant->converged) return *std::move(determinant);
  const double frequency = std::sqrt(std::abs(reduced.alpha.c(0, 0)));
  const bool phase_may_settle = reduced.num_modes == 1 && frequency > 3;
  constexpr double fast = 8;
  if (phase_may_settle && frequency > fast)
    if (std::optional<Exponents> result = by_phase(reduced, tolerance)) return *std::move(result);
  Exponents result = propagated_exponents(reduced, tolerance, leading_only);
  if (phase_may_settle && !(frequency > fast) && !result.converged)
    if (std::optional<Exponents> better = by_phase(reduced, tolerance)) return *std::move(better);
  if (determinant && !result.converged && (result.s.empty() || determinant->error[0] < result.error[0]))
    return *std::move(determinant);
  return result;
}

}  // namespace hb
