#include "hb/analysis/theory_correction.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/steady/steady_state.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "lib/fourier/transpose.hpp"
#include "lib/rod/shear.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// N x components, at N angles, an even number, of a series with any number of harmonics: at those angles harmonic k is
// k - N, too. Until the thread's next transform.
Eigen::Map<MatrixXd> folded_at(const FourierSeries& series, Index N) {
  fourier::RealTransform& transform = fourier::thread_transform(N, series.num_components());
  auto spectrum = transform.spectrum();
  const Index apart = std::min(1 + series.num_harmonics(), N / 2);
  fourier::transpose_singly(series.c.leftCols(apart), spectrum.topRows(apart));
  spectrum.bottomRows(spectrum.rows() - apart).setZero();
  for (Index k = apart; k <= series.num_harmonics(); ++k) {
    const Index m = k % N;
    if (m == 0 || 2 * m == N)
      spectrum.row(m) += 2 * series.c.col(k).real().transpose();
    else if (2 * m < N)
      spectrum.row(m) += series.c.col(k).transpose();
    else
      spectrum.row(N - m) += series.c.col(k).adjoint();
  }
  transform.backward();
  return transform.samples();
}

// K without the highest harmonics that are small beside the mean stiffnesses of the modes they couple.
FourierSeries cut_stiffness(const FourierSeries& K, Index I, double relative) {
  const Eigen::VectorXd mean = Eigen::Map<const Eigen::MatrixXcd>(K.c.col(0).data(), I, I).diagonal().cwiseAbs();
  const MatrixXd largest = relative * (mean.cwiseSqrt() * mean.cwiseSqrt().transpose());
  const Eigen::Map<const Eigen::VectorXd> allowed(largest.data(), I * I);
  const auto small = [&](Index k) { return (K.c.col(k).cwiseAbs2().array() <= allowed.array().square()).all(); };
  Index H = K.num_harmonics();
  while (H > 0 && small(H)) --H;
  return FourierSeries(Eigen::MatrixXcd(K.c.leftCols(H + 1)));
}

RoughSolver solver_of(const LinearRod& rod, double speed, double tolerance) {
  std::optional<ScaledSystem> own;
  if (rod.scaled == nullptr) own = scale_unloaded(*rod.system, speed);
  const ScaledSystem& all = own ? *own : *rod.scaled;
  FourierSeries K = cut_stiffness(all.K, all.num_modes(), 0.1 * tolerance);
  Modulation modulation;
  if (all.modulation.found() && K.num_harmonics() > 0)
    modulation = {all.modulation.functions.topRows(K.num_harmonics()), all.modulation.shares, {}};
  const ScaledSystem cut{.speed = all.speed,
                         .T = all.T,
                         .T_inverse = {},
                         .G = all.G,
                         .K = std::move(K),
                         .modulation = std::move(modulation),
                         .K_rounding = {},
                         .f_rounding = {},
                         .G_error = {},
                         .f = {},
                         .diagonal_damping = all.diagonal_damping,
                         .conservative = {}};
  return {cut, rod.system->mass};
}

}  // namespace

// M q'' + B q' + C q - h at the samples; C and h there are kept for the next ones.
MatrixXd TheoryCorrection::Compared::residual(const MatrixXd& q, const MatrixXd& q1, const MatrixXd& q2) {
  const Index I = q.rows(), N = q.cols();
  if (C_there.rows() != N) {
    C_there = folded_at(C, N);
    h_there = h.c.size() > 0 ? MatrixXd(folded_at(h, N)) : MatrixXd::Zero(N, I);
  }
  const auto by_angle = [I, N](const MatrixXd& samples) {
    MatrixXd columns(N, I);
    fourier::transpose(samples, columns);
    return columns;
  };
  const MatrixXd along = by_angle(q), along_1 = by_angle(q1), along_2 = by_angle(q2);
  MatrixXd r = -h_there;
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) {
      auto r_i = r.col(i);
      if (M(i, j) == 0 && B(i, j) == 0)
        r_i += C_there.col(i + I * j).cwiseProduct(along.col(j));
      else
        r_i += M(i, j) * along_2.col(j) + B(i, j) * along_1.col(j) + C_there.col(i + I * j).cwiseProduct(along.col(j));
    }
  return r.transpose();
}

TheoryCorrection::TheoryCorrection(const ExactModel& model, double speed, std::span<const LinearRod> rods,
                                   double tolerance)
    : model_(model), speed_(speed), rods_(rods) {
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const Body& link = *body_at(model.linkage(), model.rods()[r].link);
    HillSystem rigid;
    if (link.elastic->shear) rigid = rigid_in_shear(link, *rods[r].system, model.rods()[r].num_modes);
    const HillSystem& of = link.elastic->shear ? rigid : *rods[r].system;
    compared_.push_back({of.mass, of.damping, stiffness_at(of, speed), load_at(of, speed), {}, {}});
    answers_.push_back(solver_of(rods[r], speed, tolerance));
  }
}

Index TheoryCorrection::stiffness_harmonics(double relative) const {
  Index last = 0;
  for (const Compared& rod : compared_) {
    const Eigen::VectorXd squares = rod.C.c.row(0).tail(rod.C.num_harmonics()).cwiseAbs2();
    if (squares.size() == 0) continue;
    const double least = relative * relative * squares.maxCoeff();
    for (Index k = last; k < squares.size(); ++k)
      if (squares(k) > least) last = k + 1;
  }
  return last;
}

std::optional<FourierSeries> TheoryCorrection::answer(std::size_t rod, const MatrixXd& samples, double tolerance) {
  const HillSystem& system = *rods_[rod].system;
  FourierSeries load = on_unknowns(fourier::analyse(samples), system.num_modes());
  if (!load.c.allFinite()) return std::nullopt;
  if (const auto q = answers_[rod].solve(load, tolerance)) return ritz_coordinates(*q, samples.rows());
  const HillSystem loaded{system.mass, system.damping, system.stiffness, {std::move(load)}};
  const SteadyState state = solve_steady_state(loaded, speed_, {.tolerance = tolerance});
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return ritz_coordinates(state.q, samples.rows());
}

Corrections TheoryCorrection::at(const CrankAngles& angles, const std::vector<FourierSeries>& q, double tolerance) {
  Corrections found;
  const RitzSamples motion = ritz_samples(q, speed_, angles.size());
  const ExactResidual exact = model_.residual(speed_, angles, motion);
  found.breakdown = exact.breakdown;
  for (std::size_t r = 0; r < rods_.size() && !found.breakdown && !found.singular; ++r) {
    const Index first = model_.first_mode(r), I = model_.rods()[r].num_modes;
    const MatrixXd linear = compared_[r].residual(motion.q.middleRows(first, I), motion.q1.middleRows(first, I),
                                                  motion.q2.middleRows(first, I));
    std::optional<FourierSeries> dq = answer(r, linear - exact.r.middleRows(first, I), tolerance);
    if (!dq) found.singular = r;
    if (dq) found.dq.push_back(fourier::resized(*dq, fourier::significant_harmonics(*dq, 0.1 * tolerance)));
  }
  return found;
}

}  // namespace hb
