#include "hb/analysis/theory_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hb/engine/steady/steady_state.hpp"
#include "lib/exact/exact_forces.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Harmonics of q smaller than this part of the largest do not change a theory error.
constexpr double negligible = 1e-6;

std::vector<FourierSeries> cut_responses(std::span<const LinearRod> rods) {
  std::vector<FourierSeries> q;
  for (const LinearRod& rod : rods) {
    const FourierSeries all(MatrixXd(rod.q->c.cwiseAbs().colwise().maxCoeff()).cast<std::complex<double>>());
    q.push_back(fourier::resized(*rod.q, fourier::significant_harmonics(all, negligible)));
  }
  return q;
}

// Products of three responses do not fold onto their own harmonics.
Index num_samples(const std::vector<FourierSeries>& q, std::span<const LinearRod> rods) {
  Index H = 8, P = 0;
  for (const FourierSeries& series : q) H = std::max(H, series.num_harmonics());
  for (const LinearRod& rod : rods)
    for (std::size_t p = 0; p < 3; ++p)
      P = std::max({P, rod.system->stiffness[p].num_harmonics(), rod.system->load[p].num_harmonics()});
  return fourier::fast_length(std::max(4 * H + 2, 2 * P + 2));
}

// M q'' + B q' + C q - h at the samples.
MatrixXd linear_residual(const HillSystem& system, double speed, const MatrixXd& q, const MatrixXd& q1,
                         const MatrixXd& q2) {
  const Index I = system.num_modes(), N = q.cols();
  MatrixXd r = system.mass * q2 + system.damping * q1;
  const MatrixXd C = fourier::synthesise(stiffness_at(system, speed), N);
  for (Index j = 0; j < N; ++j) r.col(j).noalias() += Eigen::Map<const MatrixXd>(C.col(j).data(), I, I) * q.col(j);
  const FourierSeries h = load_at(system, speed);
  if (h.c.size() > 0) r -= fourier::synthesise(h, N);
  return r;
}

// What the system answers to the load given by samples; empty at resonance.
std::optional<FourierSeries> response(const HillSystem& system, double speed, const MatrixXd& load) {
  HillSystem loaded = system;
  loaded.load = {fourier::analyse(load), {}, {}};
  if (!loaded.load[0].c.allFinite()) return std::nullopt;
  const SteadyState state = solve_steady_state(loaded, speed, {.tolerance = 1e-5});
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return state.q;
}

double largest(const MatrixXd& values) { return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0.0; }

double ratio(double change, double size) { return change == 0 ? 0 : change / size; }

// Largest |sum_i q_i sin(i pi x/l)| over the samples and points of the rod.
double largest_deflection(const MatrixXd& q) {
  const Index I = q.rows(), points = 8 * I;
  MatrixXd shapes(points + 1, I);
  for (Index k = 0; k <= points; ++k)
    for (Index i = 0; i < I; ++i)
      shapes(k, i) = std::sin(std::numbers::pi * static_cast<double>((i + 1) * k) / static_cast<double>(points));
  return largest(shapes * q);
}

double largest_value(const FourierSeries& q) {
  double value = 0;
  for (Index i = 0; i < q.num_components(); ++i) value = std::max(value, fourier::max_abs(q, i).value);
  return value;
}

// Joint forces and torque of q + dq beside the linear ones.
void compare_forces(const ExactModel& model, double speed, std::span<const LinearRod> rods, const JointForces& linear,
                    TheoryErrors& errors) {
  std::vector<FourierSeries> corrected;
  Index H = linear.torque.num_harmonics();
  for (const JointForce& joint : linear.joints) H = std::max(H, joint.elastic.num_harmonics());
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const FourierSeries& dq = errors.rods[r].correction;
    const Index longest = std::max(dq.num_harmonics(), rods[r].q->num_harmonics());
    corrected.emplace_back(fourier::resized(*rods[r].q, longest).c + fourier::resized(dq, longest).c);
    H = std::max(H, longest);
  }
  const CrankAngles angles(model.linkage(), fourier::fast_length(2 * H + 2));
  const ForceSamples exact = exact_forces(model, speed, angles, ritz_samples(corrected, speed, angles.size()));
  if (exact.breakdown || !exact.values.allFinite()) return;
  const MatrixXd size = force_samples(linear, angles.size()), change = exact.values - size;
  const Index last = size.rows() - 1;
  errors.force = ratio(largest(change.topRows(last)), largest(size.topRows(last)));
  errors.torque = ratio(largest(change.row(last)), largest(size.row(last)));
}

}  // namespace

// Points enough for 1e-3 of the error.
ExactModel theory_model(const Linkage& linkage, const std::vector<Index>& num_modes) {
  std::vector<ExactModel::Rod> rods;
  const std::vector<int> links = elastic_links(linkage);
  for (std::size_t r = 0; r < links.size(); ++r) rods.push_back({links[r], num_modes.at(r)});
  return ExactModel(linkage, rods, *std::max_element(num_modes.begin(), num_modes.end()) + 14);
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
  const std::vector<FourierSeries> q = cut_responses(rods);
  const CrankAngles angles(model.linkage(), num_samples(q, rods));
  const RitzSamples motion = ritz_samples(q, speed, angles.size());
  const ExactResidual exact = model.residual(speed, angles, motion);
  if (exact.breakdown) {
    errors.reason = describe(*exact.breakdown, model.linkage());
    errors.steepest = exact.breakdown->slope;
    return errors;
  }
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const Index first = model.first_mode(r), I = model.rods()[r].num_modes;
    const HillSystem& system = *rods[r].system;
    const MatrixXd own = motion.q.middleRows(first, I);
    const MatrixXd linear =
        linear_residual(system, speed, own, motion.q1.middleRows(first, I), motion.q2.middleRows(first, I));
    std::optional<FourierSeries> dq = response(system, speed, linear - exact.r.middleRows(first, I));
    if (!dq) {
      errors.reason = body_name(model.linkage(), model.rods()[r].link) + " has no periodic solution";
      return errors;
    }
    TheoryErrors::Rod& rod = errors.rods[r];
    rod.q = ratio(largest_value(*dq), largest_value(*rods[r].q));
    const Index N = fourier::fast_length(12 * std::max(q[r].num_harmonics(), dq->num_harmonics()) + 2);
    rod.deflection =
        ratio(largest_deflection(fourier::synthesise(*dq, N)), largest_deflection(fourier::synthesise(q[r], N)));
    rod.correction = std::move(*dq);
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
