#include "hb/analysis/theory_error.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "hb/engine/steady/rough_state.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/dense.hpp"
#include "lib/exact/exact_forces.hpp"
#include "lib/rod/shear.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Harmonics of q smaller than `negligible` of the largest are left out; products of three are looked at of those above
// `cubed`, at least so many; `tolerance` is asked of the correction.
struct Accuracy {
  double negligible, cubed, tolerance;
  Index least_cubed;
};
constexpr Accuracy of_theory_error{3e-6, 1e-4, 2e-4, 7};
// Enough to see whether the second correction matters.
constexpr Accuracy of_second_look{1e-3, 1e-2, 1e-2, 5};
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

// Harmonics of q above so much of the largest.
Index harmonics_above(const FourierSeries& q, double relative) {
  const FourierSeries all(MatrixXd(q.c.cwiseAbs2().colwise().maxCoeff().cwiseSqrt()).cast<std::complex<double>>());
  return fourier::significant_harmonics(all, relative);
}

std::vector<FourierSeries> cut_responses(std::span<const LinearRod> rods, double negligible) {
  std::vector<FourierSeries> q;
  for (const LinearRod& rod : rods) q.push_back(fourier::resized(*rod.q, harmonics_above(*rod.q, negligible)));
  return q;
}

// Angles at which the harmonics of q are apart, and products of three do not fold onto them.
Index num_samples(const std::vector<FourierSeries>& q, const Accuracy& accuracy) {
  Index H = 0, cubed = accuracy.least_cubed;
  for (const FourierSeries& series : q) {
    H = std::max(H, series.num_harmonics());
    cubed = std::max(cubed, harmonics_above(series, accuracy.cubed));
  }
  return fourier::fast_length(std::max(2 * H + 2, 4 * cubed + 2));
}

// Values at N angles, an even number, of a series with any number of harmonics: at those angles harmonic k is k - N,
// too.
MatrixXd values(const FourierSeries& series, Index N) {
  fourier::RealTransform& transform = fourier::thread_transform(N, series.num_components());
  auto spectrum = transform.spectrum();
  spectrum.setZero();
  spectrum.row(0) = series.c.col(0).transpose();
  for (Index k = 1; k <= series.num_harmonics(); ++k) {
    const Index m = k % N;
    if (m == 0 || 2 * m == N)
      spectrum.row(m) += 2 * series.c.col(k).real().transpose();
    else if (2 * m < N)
      spectrum.row(m) += series.c.col(k).transpose();
    else
      spectrum.row(N - m) += series.c.col(k).adjoint();
  }
  transform.backward();
  return transform.samples().transpose();
}

// C without the highest harmonics that are small beside the mean stiffnesses of the modes they couple.
FourierSeries without_small(const FourierSeries& C, Index I, double relative) {
  const Eigen::VectorXd mean = Eigen::Map<const Eigen::MatrixXcd>(C.c.col(0).data(), I, I).diagonal().cwiseAbs();
  const MatrixXd largest = relative * (mean.cwiseSqrt() * mean.cwiseSqrt().transpose());
  const Eigen::Map<const Eigen::VectorXd> allowed(largest.data(), I * I);
  const auto small = [&](Index k) { return (C.c.col(k).cwiseAbs2().array() <= allowed.array().square()).all(); };
  Index H = C.num_harmonics();
  while (H > 0 && small(H)) --H;
  return H == C.num_harmonics() ? C : fourier::resized(C, H);
}

// A linear rod at one speed, without what shear adds: the exact model has none.
struct Compared {
  MatrixXd M, B;
  FourierSeries C, h;

  Compared(const HillSystem& system, double speed)
      : M(system.mass), B(system.damping), C(stiffness_at(system, speed)), h(load_at(system, speed)) {}
};

// M q'' + B q' + C q - h at the samples.
MatrixXd linear_residual(const Compared& rod, const MatrixXd& q, const MatrixXd& q1, const MatrixXd& q2) {
  const Index I = q.rows(), N = q.cols();
  MatrixXd r = rod.M * q2 + rod.B * q1;
  const MatrixXd C = values(rod.C, N);
  for (Index j = 0; j < N; ++j) r.col(j) += Eigen::Map<const MatrixXd>(C.col(j).data(), I, I).lazyProduct(q.col(j));
  if (rod.h.c.size() > 0) r -= values(rod.h, N);
  return r;
}

// One linear rod's answers to loads at one speed.
class Answers {
 public:
  // C at the speed.
  Answers(const HillSystem& system, const FourierSeries& C, double speed, double tolerance)
      : speed_(speed),
        unloaded_{system.mass, system.damping, {without_small(C, system.num_modes(), 0.1 * tolerance), {}, {}}, {}},
        rough_(unloaded_, speed) {}

  // What q answer to the load on them given by samples; empty at resonance.
  std::optional<FourierSeries> operator()(const MatrixXd& samples, double tolerance) {
    FourierSeries load = on_unknowns(fourier::analyse(samples), unloaded_.num_modes());
    if (!load.c.allFinite()) return std::nullopt;
    if (const auto q = rough_.solve(load, tolerance)) return ritz_coordinates(*q, samples.rows());
    HillSystem loaded = unloaded_;
    loaded.load[0] = std::move(load);
    const SteadyState state = solve_steady_state(loaded, speed_, {.tolerance = tolerance});
    if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
    return ritz_coordinates(state.q, samples.rows());
  }

 private:
  double speed_;
  HillSystem unloaded_;
  RoughSolver rough_;
};

double ratio(double change, double size) { return change == 0 ? 0 : change / size; }

// Of two series of samples, the largest |sum_i q_i sin(i pi x/l)| over points of the rod, the first over the second.
double deflection_ratio(const MatrixXd& change, const MatrixXd& q) {
  const Index I = q.rows(), points = 4 * I + 4;
  MatrixXd shapes(points + 1, I);
  for (Index k = 0; k <= points; ++k)
    for (Index i = 0; i < I; ++i)
      shapes(k, i) = std::sin(std::numbers::pi * static_cast<double>((i + 1) * k) / static_cast<double>(points));
  return ratio(dense::largest(shapes * change), dense::largest(shapes * q));
}

// Values at four angles a wave are at least so much of the largest.
constexpr double least_sampled = 0.7;

// Largest |q_i| of each component at those.
Eigen::VectorXd sampled_largest(const FourierSeries& q) {
  return fourier::synthesise(q, fourier::fast_length(4 * q.num_harmonics() + 4)).cwiseAbs().rowwise().maxCoeff();
}

// Largest |q_i| over the turn, of components that can have it.
double largest_value(const FourierSeries& q) {
  const Eigen::VectorXd sampled = sampled_largest(q);
  double value = 0;
  for (Index i = 0; i < q.num_components(); ++i)
    if (!(sampled(i) < least_sampled * sampled.maxCoeff())) value = std::max(value, fourier::max_abs(q, i).value);
  return value;
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

// What is asked, with what all corrections share.
struct Question {
  const ExactModel& model;
  double speed;
  std::span<const LinearRod> rods;
  std::vector<Compared> compared;
  std::vector<Answers> answers;

  Question(const ExactModel& exact, double at_speed, std::span<const LinearRod> linear)
      : model(exact), speed(at_speed), rods(linear) {
    for (std::size_t r = 0; r < rods.size(); ++r) {
      const HillSystem& system = *rods[r].system;
      const Body& link = *body_at(model.linkage(), model.rods()[r].link);
      if (link.elastic->shear) {
        compared.emplace_back(rigid_in_shear(link, system, model.rods()[r].num_modes), speed);
        answers.emplace_back(system, stiffness_at(system, speed), speed, of_theory_error.tolerance);
      } else {
        const Compared& same = compared.emplace_back(system, speed);
        answers.emplace_back(system, same.C, speed, of_theory_error.tolerance);
      }
    }
  }
};

// The exact model at q, and what the linear rods answer to what their model leaves out there (T1).
struct Corrections {
  std::vector<FourierSeries> dq;
  std::optional<ExactBreakdown> breakdown;
  std::optional<std::size_t> singular;  // this rod has no periodic solution
};

Corrections corrections(Question& of, const CrankAngles& angles, const std::vector<FourierSeries>& q,
                        const Accuracy& accuracy) {
  const ExactModel& model = of.model;
  const double speed = of.speed;
  Corrections found;
  const RitzSamples motion = ritz_samples(q, speed, angles.size());
  const ExactResidual exact = model.residual(speed, angles, motion);
  found.breakdown = exact.breakdown;
  for (std::size_t r = 0; r < of.rods.size() && !found.breakdown && !found.singular; ++r) {
    const Index first = model.first_mode(r), I = model.rods()[r].num_modes;
    const MatrixXd linear = linear_residual(of.compared[r], motion.q.middleRows(first, I),
                                            motion.q1.middleRows(first, I), motion.q2.middleRows(first, I));
    std::optional<FourierSeries> dq = of.answers[r](linear - exact.r.middleRows(first, I), accuracy.tolerance);
    if (!dq) found.singular = r;
    if (dq) found.dq.push_back(fourier::resized(*dq, harmonics_above(*dq, 0.1 * accuracy.tolerance)));
  }
  return found;
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

// Largest |dq_i| of each rod.
std::vector<double> sizes(const std::vector<FourierSeries>& dq) {
  std::vector<double> values;
  for (const FourierSeries& own : dq) values.push_back(largest_value(own));
  return values;
}

// Largest change itself, relative to the rod's largest, by either measure of a series.
template <class Measure>
double difference(const std::vector<FourierSeries>& from, const std::vector<FourierSeries>& to,
                  const Measure& measure) {
  double largest = 0;
  for (std::size_t r = 0; r < from.size(); ++r) {
    largest = std::max(largest, ratio(measure(fourier::difference(to[r], from[r])), measure(to[r])));
  }
  return largest;
}

// Whether the change is larger than `most`: by samples where they leave no doubt.
bool differs_by_more(const std::vector<FourierSeries>& from, const std::vector<FourierSeries>& to, double most) {
  const double sampled = difference(from, to, [](const FourierSeries& q) { return sampled_largest(q).maxCoeff(); });
  if (sampled / least_sampled <= most) return false;
  if (sampled * least_sampled > most) return true;
  return difference(from, to, largest_value) > most;
}

// (T1) at q + dq, roughly, changes dq by more than `most` of itself.
bool second_matters(Question& of, const std::vector<FourierSeries>& dq, double most) {
  const std::vector<FourierSeries> q = cut_responses(of.rods, of_second_look.negligible);
  const CrankAngles angles(of.model.linkage(), num_samples(q, of_second_look));
  const Corrections second = corrections(of, angles, moved_by(q, dq, angles.size()), of_second_look);
  return !second.breakdown && !second.singular && differs_by_more(dq, second.dq, most);
}

// (T1) at q + dq until dq settles; empty where it does not.
std::optional<std::vector<FourierSeries>> repeated_corrections(Question& of, const CrankAngles& angles,
                                                               const std::vector<FourierSeries>& q,
                                                               std::vector<FourierSeries> dq) {
  constexpr int most = 8;
  constexpr double settled = 0.02, slow = 0.7;
  double last = HUGE_VAL;
  for (int step = 0; step < most; ++step) {
    Corrections next = corrections(of, angles, moved_by(q, dq, angles.size()), of_theory_error);
    if (next.breakdown || next.singular) return std::nullopt;
    const double change = difference(dq, next.dq, largest_value);
    dq = std::move(next.dq);
    if (change <= settled) return dq;
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
std::optional<std::vector<FourierSeries>> second_order(Question& of, const CrankAngles& angles,
                                                       const std::vector<FourierSeries>& q,
                                                       const std::vector<FourierSeries>& dq, double first_error) {
  if (!(first_error < not_followed)) return std::nullopt;
  double amplification = 0;
  for (const LinearRod& rod : of.rods)
    amplification = std::max(amplification, nearest_amplification(*rod.system, of.speed));
  const bool beyond = first_error > theory_error_limit;
  if (amplification * first_error <= (beyond ? sharp : harmless)) return std::nullopt;
  if (beyond) {
    auto change = change_by_newton(of.model, of.speed, q, theory_error_limit);
    for (std::size_t r = 0; change && r < q.size(); ++r)
      if (!(largest_value((*change)[r]) <= theory_error_limit * largest_value(q[r]))) return std::nullopt;
    return change;
  }
  if (!second_matters(of, dq, amplification * first_error > amplified ? most_amplified : most_second))
    return std::nullopt;
  auto change = repeated_corrections(of, angles, q, dq);
  return change ? change : change_by_newton(of.model, of.speed, q, first_error);
}

}  // namespace

// Points enough for 1e-3 of the error.
ExactModel theory_model(const Linkage& linkage, const std::vector<Index>& num_modes) {
  std::vector<ExactModel::Rod> rods;
  const std::vector<int> links = elastic_links(linkage);
  for (std::size_t r = 0; r < links.size(); ++r) rods.push_back({links[r], num_modes.at(r)});
  return ExactModel(linkage, rods, *std::max_element(num_modes.begin(), num_modes.end()) + 8);
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
  const CrankAngles angles(model.linkage(), num_samples(q, of_theory_error));
  Question question(model, speed, rods);
  Corrections first = corrections(question, angles, q, of_theory_error);
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
  std::vector<double> size, change = sizes(dq);
  double first_error = 0;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    size.push_back(largest_value(q[r]));
    first_error = std::max(first_error, ratio(change[r], size[r]));
  }
  if (auto second = second_order(question, angles, q, dq, first_error)) {
    dq = std::move(*second);
    const std::vector<double> followed = sizes(dq);
    for (std::size_t r = 0; r < rods.size(); ++r)
      if (!(std::abs(followed[r] - change[r]) <= same_size * followed[r])) change[r] = followed[r];
  }
  for (std::size_t r = 0; r < rods.size(); ++r) {
    TheoryErrors::Rod& rod = errors.rods[r];
    rod.q = ratio(change[r], size[r]);
    // Four angles a wave of the smallest harmonics, many of those that count.
    const Index N = fourier::fast_length(4 * std::max(q[r].num_harmonics(), dq[r].num_harmonics()) + 2);
    rod.deflection = deflection_ratio(fourier::synthesise(dq[r], N), fourier::synthesise(q[r], N));
    rod.correction = std::move(dq[r]);
  }
  if (forces != nullptr) compare_forces(model, speed, rods, *forces, errors);
  return errors;
}

double axial_share(const ExactModel& model, std::size_t rod) {
  const Body& body = *body_at(model.linkage(), model.rods()[rod].link);
  const Elastic& elastic = *body.elastic;
  const double l = body.length, E = elastic.youngs_modulus;
  const double bending = std::pow(std::numbers::pi / l, 4) * E * elastic.second_moment / (body.mass / l);
  const double axial = E * elastic.area / l / (body.mass / 3 + model.driven_mass(rod));
  return 4 * bending / axial;
}

}  // namespace hb
