#include "hb/analysis/theory_error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/theory_correction.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "hb/engine/steady/rough_state.hpp"
#include "lib/dense.hpp"
#include "lib/exact/exact_forces.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Harmonics of q smaller than `negligible` of the largest are left out; products are looked at of those above `cubed`
// and of as many as the rods' varying stiffness has above `varying`, at least so many; `tolerance` is asked of the
// correction.
struct Accuracy {
  double negligible, cubed, varying, tolerance;
  Index least_cubed;
};
constexpr Accuracy of_theory_error{3e-6, 1e-2, 1e-3, 2e-4, 7};
// Enough to see whether the second correction matters.
constexpr Accuracy of_second_look{1e-3, 1e-2, 1, 1e-2, 5};
// Below the first, of the correction times the amplification next to the nearest resonance, one correction shows the
// change to within a tenth (by random linkages); so it does where the second one differs by less than the other.
constexpr double harmless = 0.015, most_second = 0.085;
// Above the first the second correction, and those after it, are amplified so much that it must be smaller.
constexpr double amplified = 1, most_amplified = 0.03;
// Beyond the theory the change may lie below all the same where the resonance is sharper than that.
constexpr double sharp = 10;
// From a first correction as large as this it does not: of 254 changes to motions found on random linkages from there,
// none was below 0.09.
constexpr double not_followed = 0.5;
// The first correction's size is the theory error of q, (T2), where it is this near to that of the change followed.
constexpr double same_size = 0.05;

std::vector<FourierSeries> cut_responses(std::span<const LinearRod> rods, double negligible) {
  std::vector<FourierSeries> q;
  for (const LinearRod& rod : rods)
    q.push_back(fourier::resized(*rod.q, fourier::significant_harmonics(*rod.q, negligible)));
  return q;
}

// Angles at which the harmonics of q are apart, and products of the large ones do not fold onto them.
Index num_samples(const TheoryCorrection& correction, const std::vector<FourierSeries>& q, const Accuracy& accuracy) {
  Index H = 0, cubed = std::max(accuracy.least_cubed, correction.stiffness_harmonics(accuracy.varying));
  for (const FourierSeries& series : q) {
    H = std::max(H, series.num_harmonics());
    cubed = std::max(cubed, fourier::significant_harmonics(series, accuracy.cubed));
  }
  return fourier::fast_length(std::max(2 * H + 2, 4 * cubed + 2));
}

double ratio(double change, double size) { return change == 0 ? 0 : change / size; }

// Values at four angles a wave of so many harmonics, I x N; they are at least so much of the largest.
MatrixXd over_the_turn(const FourierSeries& q, Index harmonics) {
  return fourier::synthesise(q, fourier::fast_length(4 * harmonics + 4));
}
constexpr double least_sampled = 0.7;

// The components that can have the largest |q_i|: its mean square is no larger than the square of the largest, and
// that no larger than the square of the sum over all harmonics.
FourierSeries leading_components(const FourierSeries& q) {
  const MatrixXd squares = q.c.cwiseAbs2();
  const Eigen::VectorXd mean_square = 2 * squares.rowwise().sum() - squares.col(0),
                        most = 2 * squares.cwiseSqrt().rowwise().sum() - squares.col(0).cwiseSqrt();
  const double least = 0.9 * mean_square.maxCoeff();
  std::vector<Index> leading;
  for (Index i = 0; i < q.num_components(); ++i)
    if (!(most(i) * most(i) < least)) leading.push_back(i);
  return FourierSeries(Eigen::MatrixXcd(q.c(leading, Eigen::all)));
}

double sampled_size(const FourierSeries& q) {
  return dense::largest(over_the_turn(leading_components(q), q.num_harmonics()));
}

// Largest |q_i| over the turn, of components that can have it.
double largest_value(const FourierSeries& q, const MatrixXd& samples) {
  const Eigen::VectorXd largest = samples.cwiseAbs().rowwise().maxCoeff();
  double value = 0;
  for (Index i = 0; i < q.num_components(); ++i)
    if (!(largest(i) < least_sampled * largest.maxCoeff())) value = std::max(value, fourier::max_abs(q, i).value);
  return value;
}

double size(const FourierSeries& q) {
  const FourierSeries leading = leading_components(q);
  return largest_value(leading, over_the_turn(leading, q.num_harmonics()));
}

// Largest |sum_i q_i sin(i pi x/l)| at the samples and at points of the rod. With s and a the sums of the odd i and of
// the even ones, the larger of those at x and l - x is |s| + |a|. Angles at which sum_i |q_i| is no larger have less.
double largest_deflection(const MatrixXd& samples) {
  const Index I = samples.rows(), points = 2 * I + 2;
  MatrixXd sines(I, points);
  for (Index k = 0; k < points; ++k) {
    const std::complex<double> wave = std::polar(1.0, std::numbers::pi / 2 * double(k + 1) / double(points));
    std::complex<double> power = wave;
    for (Index i = 0; i < I; ++i, power *= wave) sines(i, k) = power.imag();
  }
  const Eigen::VectorXd most = samples.cwiseAbs().colwise().sum();
  double largest = 0;
  const auto look = [&](Index angle) {
    const double* q = &samples(0, angle);
    for (Index k = 0; k < points; ++k) {
      const double* sine = &sines(0, k);
      double sum[2] = {0, 0};
      for (Index i = 0; i < I; ++i) sum[i % 2] += q[i] * sine[i];
      largest = std::max(largest, std::abs(sum[0]) + std::abs(sum[1]));
    }
  };
  Index first = 0;
  most.maxCoeff(&first);
  look(first);
  for (Index angle = 0; angle < most.size(); ++angle)
    if (most(angle) > largest) look(angle);
  return largest;
}

// Joint forces and torque of q + dq beside the linear ones.
void compare_forces(const ExactModel& model, double speed, std::span<const LinearRod> rods, const JointForces& linear,
                    TheoryErrors& errors) {
  std::vector<FourierSeries> corrected;
  Index H = linear.torque.num_harmonics();
  for (const JointForce& joint : linear.joints) H = std::max(H, joint.elastic.num_harmonics());
  for (std::size_t r = 0; r < rods.size(); ++r) {
    corrected.push_back(fourier::sum(*rods[r].q, errors.rods[r].correction));
    H = std::max(H, corrected.back().num_harmonics());
  }
  const CrankAngles angles(model.linkage(), fourier::fast_length(2 * H + 2));
  const ForceSamples exact = exact_forces(model, speed, angles, ritz_samples(corrected, speed, angles.size()));
  if (exact.breakdown || !exact.values.allFinite()) return;
  const MatrixXd size = force_samples(linear, angles.size()), change = exact.values - size;
  const Index last = size.rows() - 1;
  errors.force = ratio(dense::largest(change.topRows(last)), dense::largest(size.topRows(last)));
  errors.torque = ratio(dense::largest(change.row(last)), dense::largest(size.row(last)));
  errors.mean_torque = std::abs(change.row(last).mean());
}

// q + dq with the harmonics that N angles hold.
std::vector<FourierSeries> moved_by(const std::vector<FourierSeries>& q, const std::vector<FourierSeries>& dq,
                                    Index N) {
  std::vector<FourierSeries> moved;
  for (std::size_t r = 0; r < q.size(); ++r) {
    const FourierSeries all = fourier::sum(q[r], dq[r]);
    moved.push_back(fourier::resized(all, std::min((N - 1) / 2, all.num_harmonics())));
  }
  return moved;
}

// Largest change itself, relative to the rod's largest, by a measure of a series.
template <class Measure>
double difference(const std::vector<FourierSeries>& from, const std::vector<FourierSeries>& to,
                  const Measure& measure) {
  double largest = 0;
  for (std::size_t r = 0; r < from.size(); ++r) {
    largest = std::max(largest, ratio(measure(fourier::difference(to[r], from[r])), measure(to[r])));
  }
  return largest;
}

// Whether the change, of this size by samples, is larger than `most`: by these where they leave no doubt.
bool differs_by_more(const std::vector<FourierSeries>& from, const std::vector<FourierSeries>& to, double most,
                     double by_samples) {
  if (by_samples / least_sampled <= most) return false;
  if (by_samples * least_sampled > most) return true;
  return difference(from, to, size) > most;
}

// (T1) at q + dq, roughly, where that changes dq by more than `most` of itself.
std::optional<std::vector<FourierSeries>> second_correction(TheoryCorrection& correction,
                                                            const CrankAngles& first_angles,
                                                            const std::vector<FourierSeries>& dq, double most) {
  const std::vector<FourierSeries> q = cut_responses(correction.rods(), of_second_look.negligible);
  const Index N = num_samples(correction, q, of_second_look);
  std::optional<CrankAngles> own;
  if (N != first_angles.size()) own.emplace(correction.model().linkage(), N);
  const CrankAngles& angles = own ? *own : first_angles;
  Corrections second = correction.at(angles, moved_by(q, dq, angles.size()), of_second_look.tolerance);
  if (second.breakdown || second.singular) return std::nullopt;
  if (!differs_by_more(dq, second.dq, most, difference(dq, second.dq, sampled_size))) return std::nullopt;
  return std::move(second.dq);
}

// (T1) at q + dq until dq settles; empty where it does not.
std::optional<std::vector<FourierSeries>> repeated_corrections(TheoryCorrection& correction, const CrankAngles& angles,
                                                               const std::vector<FourierSeries>& q,
                                                               std::vector<FourierSeries> dq) {
  constexpr int most = 8;
  constexpr double settled = 0.02, slow = 0.7;
  double last = HUGE_VAL;
  for (int step = 0; step < most; ++step) {
    Corrections next = correction.at(angles, moved_by(q, dq, angles.size()), of_theory_error.tolerance);
    if (next.breakdown || next.singular) return std::nullopt;
    const double change = difference(dq, next.dq, sampled_size);
    const bool done = !differs_by_more(dq, next.dq, settled, change);
    dq = std::move(next.dq);
    if (done) return dq;
    if (change > slow * last) return std::nullopt;
    last = change;
  }
  return std::nullopt;
}

// The change to the motion of the exact model that Newton's method finds from q; empty where it finds none soon.
std::optional<std::vector<FourierSeries>> change_by_newton(const ExactModel& model, double speed,
                                                           const std::vector<FourierSeries>& q, double expected) {
  for (const ExactModel::Rod& rod : model.rods())
    if (body_at(model.linkage(), rod.link)->elastic->shear) return std::nullopt;
  Index H = 0;
  for (const FourierSeries& own : q) H = std::max(H, own.num_harmonics());
  FourierSeries start(model.num_modes(), H);
  for (std::size_t r = 0; r < q.size(); ++r)
    start.c.middleRows(model.first_mode(r), q[r].num_components()) = fourier::resized(q[r], H).c;
  // Seconds of work and some 30 MB: near a dead centre the turn has hundreds of harmonics, and the first correction
  // stands.
  constexpr Index most_unknowns = 1200;
  const Index most_harmonics = (most_unknowns / model.num_modes() - 1) / 2;
  if (H > most_harmonics) return std::nullopt;
  constexpr double part = 0.01;  // of the change
  const MotionOptions options{
      .tolerance = part * expected, .max_harmonics = static_cast<int>(most_harmonics), .max_factorisations = 20};
  const std::shared_ptr<const ExactModel> shared(std::shared_ptr<const void>(), &model);
  const PeriodicMotion motion = solve_periodic_motion(exact_system(shared), speed, start, options);
  if (motion.status != MotionStatus::converged) return std::nullopt;
  std::vector<FourierSeries> dq;
  for (std::size_t r = 0; r < q.size(); ++r) {
    const FourierSeries found(motion.q.c.middleRows(model.first_mode(r), q[r].num_components()));
    dq.push_back(fourier::difference(found, q[r]));
  }
  return dq;
}

// Next to a resonance the correction itself moves the resonance: the change itself (T3). The first correction
// stays where the second one is small, and beyond the theory unless the change turns out to lie below.
std::optional<std::vector<FourierSeries>> second_order(TheoryCorrection& correction, const CrankAngles& angles,
                                                       const std::vector<FourierSeries>& q,
                                                       const std::vector<FourierSeries>& dq, double first_error) {
  if (!(first_error < not_followed)) return std::nullopt;
  double amplification = 0;
  for (const LinearRod& rod : correction.rods())
    amplification = std::max(amplification, nearest_amplification(*rod.system, correction.speed()));
  const bool beyond = first_error > theory_error_limit;
  if (amplification * first_error <= (beyond ? sharp : harmless)) return std::nullopt;
  if (beyond) {
    auto change = change_by_newton(correction.model(), correction.speed(), q, theory_error_limit);
    for (std::size_t r = 0; change && r < q.size(); ++r)
      if (!(size((*change)[r]) <= theory_error_limit * size(q[r]))) return std::nullopt;
    return change;
  }
  const auto second =
      second_correction(correction, angles, dq, amplification * first_error > amplified ? most_amplified : most_second);
  if (!second) return std::nullopt;
  auto change = repeated_corrections(correction, angles, q, *second);
  return change ? change : change_by_newton(correction.model(), correction.speed(), q, first_error);
}

}  // namespace

ExactModel theory_model(const Linkage& linkage, const std::vector<Index>& num_modes, Index points_beside_modes) {
  std::vector<ExactModel::Rod> rods;
  const std::vector<int> links = elastic_links(linkage);
  for (std::size_t r = 0; r < links.size(); ++r) rods.push_back({links[r], num_modes.at(r)});
  return ExactModel(linkage, rods, *std::max_element(num_modes.begin(), num_modes.end()) + points_beside_modes);
}

TheoryErrors theory_errors(const ExactModel& model, double speed, std::span<const LinearRod> rods,
                           const JointForces* forces) {
  TheoryErrors errors;
  errors.rods.resize(rods.size());
  for (std::size_t r = 0; r < rods.size(); ++r)
    if (rods[r].q == nullptr || rods[r].q->c.size() == 0 || !rods[r].q->c.allFinite()) {
      errors.reason = body_name(model.linkage(), model.rods()[r].link) + " has no periodic solution";
      return errors;
    }
  const std::vector<FourierSeries> q = cut_responses(rods, of_theory_error.negligible);
  TheoryCorrection correction(model, speed, rods, of_theory_error.tolerance);
  const CrankAngles angles(model.linkage(), num_samples(correction, q, of_theory_error));
  Corrections first = correction.at(angles, q, of_theory_error.tolerance);
  if (first.breakdown) {
    errors.reason = describe(*first.breakdown, model.linkage());
    errors.steepest = first.breakdown->slope;
    return errors;
  }
  if (first.singular) {
    errors.reason = body_name(model.linkage(), model.rods()[*first.singular].link) + " has no periodic solution";
    return errors;
  }
  std::vector<FourierSeries>& dq = first.dq;
  const auto harmonics = [&](std::size_t r) { return std::max(q[r].num_harmonics(), dq[r].num_harmonics()); };
  std::vector<MatrixXd> turn, change_turn;
  std::vector<double> largest, change;
  double first_error = 0;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    turn.push_back(over_the_turn(q[r], harmonics(r)));
    change_turn.push_back(over_the_turn(dq[r], harmonics(r)));
    largest.push_back(largest_value(q[r], turn[r]));
    change.push_back(largest_value(dq[r], change_turn[r]));
    first_error = std::max(first_error, ratio(change[r], largest[r]));
  }
  if (auto second = second_order(correction, angles, q, dq, first_error)) {
    dq = std::move(*second);
    for (std::size_t r = 0; r < rods.size(); ++r) {
      change_turn[r] = over_the_turn(dq[r], harmonics(r));
      const double followed = largest_value(dq[r], change_turn[r]);
      if (!(std::abs(followed - change[r]) <= same_size * followed)) change[r] = followed;
    }
  }
  for (std::size_t r = 0; r < rods.size(); ++r) {
    TheoryErrors::Rod& rod = errors.rods[r];
    rod.q = ratio(change[r], largest[r]);
    rod.deflection = ratio(largest_deflection(change_turn[r]), largest_deflection(turn[r]));
    rod.correction = std::move(dq[r]);
  }
  if (forces != nullptr) compare_forces(model, speed, rods, *forces, errors);
  return errors;
}

std::vector<double> axial_shares(const ExactModel& model) {
  const std::vector<double> driven = model.driven_masses();
  std::vector<double> shares;
  for (std::size_t r = 0; r < driven.size(); ++r) {
    const Body& body = *body_at(model.linkage(), model.rods()[r].link);
    const Elastic& elastic = *body.elastic;
    const double l = body.length, E = elastic.youngs_modulus;
    const double bending = std::pow(std::numbers::pi / l, 4) * E * elastic.second_moment / (body.mass / l);
    const double axial = E * elastic.area / l / (body.mass / 3 + driven[r]);
    shares.push_back(4 * bending / axial);
  }
  return shares;
}

}  // namespace hb
