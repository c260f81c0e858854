#include "hb/analysis/cross_check.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "hb/analysis/accuracy.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/rod/shear.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

double relative(const Eigen::MatrixXd& difference, const Eigen::MatrixXd& reference) {
  const double size = dense::largest(reference);
  return size > 0 ? dense::largest(difference) / size : dense::largest(difference);
}

// Samples at the N angles of the other path; a series with more harmonics than N carries is summed at each angle.
Eigen::MatrixXd samples(const FourierSeries& series, Eigen::Index N) {
  if (N > 2 * series.num_harmonics()) return fourier::synthesise(series, N);
  Eigen::MatrixXd values(series.num_components(), N);
  for (Eigen::Index j = 0; j < N; ++j)
    values.col(j) = fourier::evaluate(series, two_pi * static_cast<double>(j) / static_cast<double>(N));
  return values;
}

// Both paths evaluate the coefficients with their own rounding, some 1e-14 of the largest; a system near resonance
// answers with 1/distance of it. Measured on the six-link mechanism, doubled several times.
double rounding_of_models(const SteadyState& steady) { return 2e-13 / std::max(steady.resonance_distance, 1e-8); }

double distance(std::complex<double> a, std::complex<double> b, double Omega) {
  return std::hypot(a.real() - b.real(), std::remainder(a.imag() - b.imag(), Omega));
}

// Growth rates, then every exponent that one path lists against the nearest of the other; the worst by excess over its
// allowance. Either list may leave out exponents: harmonic balance those that it did not resolve, shooting those below
// `complete_above`. One that is missing there has no partner.
Comparison compare_exponents(const Stability& stability, const ShootingResult& shooting, Eigen::Index num_exponents,
                             double Omega) {
  Comparison worst{"exponents", std::abs(stability.growth_rate - shooting.growth_rate),
                   stability.growth_error + shooting.growth_error + 1e-12 * (Omega + std::abs(shooting.growth_rate))};
  const auto compare = [&](const std::vector<Exponent>& mine, const std::vector<Exponent>& others, double above) {
    if (others.empty()) return;
    for (const Exponent& e : mine) {
      if (!(e.value.real() - e.error >= above)) continue;
      const auto nearest = std::min_element(others.begin(), others.end(), [&](const Exponent& a, const Exponent& b) {
        return distance(a.value, e.value, Omega) - a.error < distance(b.value, e.value, Omega) - b.error;
      });
      const Comparison here{"exponents", distance(nearest->value, e.value, Omega),
                            nearest->error + e.error + 1e-12 * (Omega + std::abs(e.value.real()))};
      if (!(here.difference - here.allowed <= worst.difference - worst.allowed)) worst = here;
    }
  };
  const double lowest = shooting.exponents.empty() ? INFINITY : shooting.complete_above;
  compare(stability.exponents, shooting.exponents, lowest);
  if (static_cast<Eigen::Index>(stability.exponents.size()) == num_exponents)
    compare(shooting.exponents, stability.exponents, -INFINITY);
  return worst;
}

// Largest factors by which an error of the series grows when it is differentiated once and twice: the harmonics left
// out decay at least by e from H to 2H, and then sum n^k e^{-n/H} beyond H is 2H and 5H^2 times the sum for k = 0.
double once(double H) { return 2 * H; }
double twice(double H) { return 5 * H * H; }

double harmonics(const SteadyState& steady) { return std::max(1.0, static_cast<double>(steady.num_harmonics)); }

void compare_states(RodCheck& rod, bool deflection) {
  const PeriodicOrbit& orbit = rod.shooting.orbit;
  const FourierSeries& series = rod.steady.q;
  const Eigen::Index N = orbit.q.cols();
  const Eigen::MatrixXd q = samples(series, N), q1 = samples(fourier::derivative(series), N);
  const double rounding = rounding_of_models(rod.steady), bound = rod.steady.error_bound;
  rod.q = {"q / max |q|", relative(q - orbit.q, orbit.q), bound + rod.shooting.q_error + rounding};
  const double q_over_q1 = dense::largest(orbit.q1) > 0 ? dense::largest(orbit.q) / dense::largest(orbit.q1) : 1;
  rod.q1 = {"q' / max |q'|", relative(q1 - orbit.q1, orbit.q1),
            once(harmonics(rod.steady)) * q_over_q1 * (bound + rounding) + rod.shooting.q1_error + rounding};
  if (deflection) {
    constexpr int num_x = 33;
    Eigen::MatrixXd shapes(num_x, orbit.q.rows());
    for (Eigen::Index i = 0; i < shapes.cols(); ++i)
      for (int j = 0; j < num_x; ++j)
        shapes(j, i) = std::sin(static_cast<double>(i + 1) * std::numbers::pi * (j + 0.5) / num_x);
    const Eigen::MatrixXd w = shapes * orbit.q;
    // Errors of the modes may add up.
    const double modes = static_cast<double>(orbit.q.rows());
    const double q_over_w = dense::largest(w) > 0 ? dense::largest(orbit.q) / dense::largest(w) : 1;
    rod.deflection = Comparison{"w / max |w|", relative(shapes * (q - orbit.q), w), modes * q_over_w * rod.q.allowed};
  }
  if (rod.marching && rod.marching->status == ShootingStatus::converged) {
    const Eigen::MatrixXd& marched = rod.marching->orbit.q;
    rod.marched = Comparison{"q by marching / max |q|", relative(samples(series, marched.cols()) - marched, marched),
                             bound + rod.marching->q_error + rounding};
  }
}

// Part of the allowance that is used; NaN counts as all of it.
double share(const Comparison& c) {
  const double part = c.difference / std::max(c.allowed, 1e-300);
  return std::isnan(part) ? INFINITY : part;
}

// q_1..q_I of the unknowns that were integrated.
void keep_deflection(PeriodicOrbit& orbit, Eigen::Index num_modes) {
  for (Eigen::MatrixXd* samples : {&orbit.q, &orbit.q1, &orbit.q2})
    if (samples->rows() > num_modes) *samples = samples->topRows(num_modes).eval();
}

}  // namespace

// Forces of both paths on the shooting path's angles. The series' own error reaches the forces through q, q', q''; its
// effect is added up mode by mode, as if every error came in with its worst sign.
JointCheck compare_joints(const Linkage& linkage, const JointForces& series, const std::vector<RodCheck>& rods,
                          const std::vector<int>& links, double speed) {
  const std::vector<ForceLabel> labels = force_labels(linkage);
  Eigen::Index N = 128;
  for (const RodCheck& rod : rods) N = std::max(N, rod.shooting.orbit.q.cols());
  const auto at = [&](const PeriodicOrbit& orbit, int link, Eigen::Index j) {
    const Eigen::Index k = j * orbit.q.cols() / N;
    return LinkDeflection{link, orbit.q.col(k), orbit.q1.col(k), orbit.q2.col(k)};
  };
  constexpr Eigen::Index num_angles = 128;
  const auto n = static_cast<Eigen::Index>(labels.size());
  Eigen::VectorXd size = Eigen::VectorXd::Zero(n), difference = size, own = size, bar = size;
  std::vector<FourierSeries> components(labels.size());
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (labels[k].joint == "torque") components[k] = series.torque;
    for (const JointForce& joint : series.joints)
      if (joint.name == labels[k].joint)
        components[k] = FourierSeries(Eigen::MatrixXcd(joint.elastic.c.row(labels[k].component == "y" ? 1 : 0)));
  }
  for (Eigen::Index a = 0; a < num_angles; ++a) {
    const Eigen::Index j = a * N / num_angles;
    const double tau = two_pi * static_cast<double>(j) / static_cast<double>(N);
    std::vector<LinkDeflection> fine, coarse;
    for (std::size_t r = 0; r < rods.size(); ++r) {
      fine.push_back(at(rods[r].shooting.orbit, links[r], j));
      coarse.push_back(at(rods[r].shooting.coarser, links[r], j));
    }
    const Eigen::VectorXd direct = joint_forces_at(linkage, speed, tau, fine);
    own = own.cwiseMax((direct - joint_forces_at(linkage, speed, tau, coarse)).cwiseAbs());
    size = size.cwiseMax(direct.cwiseAbs());
    for (Eigen::Index k = 0; k < n; ++k) {
      const double value = fourier::evaluate(components[static_cast<std::size_t>(k)], tau)(0);
      difference(k) = std::max(difference(k), std::abs(direct(k) - value));
    }
    if (a % 8 != 0) continue;
    const Eigen::VectorXd rigid = joint_forces_at(linkage, speed, tau, {});
    Eigen::VectorXd effect = Eigen::VectorXd::Zero(n);
    for (std::size_t r = 0; r < rods.size(); ++r) {
      const RodCheck& rod = rods[r];
      const double H = harmonics(rod.steady);
      const double error =
          (rod.steady.error_bound + rounding_of_models(rod.steady)) * dense::largest(rod.shooting.orbit.q);
      const Eigen::Index I = rod.shooting.orbit.q.rows();
      for (Eigen::Index i = 0; i < I; ++i) {
        const Eigen::VectorXd unit = error * Eigen::VectorXd::Unit(I, i), none = Eigen::VectorXd::Zero(I);
        for (const LinkDeflection& wrong :
             {LinkDeflection{links[r], unit, none, none}, LinkDeflection{links[r], none, once(H) * unit, none},
              LinkDeflection{links[r], none, none, twice(H) * unit}})
          effect += (joint_forces_at(linkage, speed, tau, {wrong}) - rigid).cwiseAbs();
      }
    }
    bar = bar.cwiseMax(effect);
  }
  // Forces are compared with the largest force anywhere, the torque with the largest torque; 1e-12 for the rounding of
  // the two ways to solve for them.
  JointCheck check;
  const double force = std::max(size.head(n - 1).maxCoeff(), 1e-300);
  const double torque = std::max(size(n - 1), 1e-300);
  double worst = -1;
  for (Eigen::Index k = 0; k < n; ++k) {
    const bool is_torque = k == n - 1;
    const double scale = is_torque ? torque : force;
    const double arm = is_torque ? force * linkage.crank.body.length / torque : 1;
    const Comparison here{is_torque ? "torque / largest" : "forces / largest", difference(k) / scale,
                          (difference_factor * own(k) + bar(k)) / scale + 1e-12 * std::max(1.0, arm)};
    if (is_torque) {
      check.torque = here;
    } else if (!(share(here) <= worst)) {
      worst = share(here);
      check.forces = here;
      check.worst = labels[static_cast<std::size_t>(k)].joint;
    }
  }
  return check;
}

std::vector<Comparison> RodCheck::comparisons() const {
  std::vector<Comparison> made;
  if (!compared()) return made;
  made = {q, q1};
  for (const std::optional<Comparison>* optional : {&deflection, &marched, &exponents})
    if (*optional) made.push_back(**optional);
  return made;
}

bool RodCheck::opposite_verdicts() const {
  if (!compared() || !stability) return false;
  const Verdict a = stability->verdict, b = shooting.verdict;
  const auto grows = [](Verdict verdict) { return verdict == Verdict::unstable; };
  const auto stays = [](Verdict verdict) { return verdict == Verdict::stable || verdict == Verdict::bounded; };
  return (stays(a) && grows(b)) || (grows(a) && stays(b));
}

bool RodCheck::agrees() const {
  const std::vector<Comparison> made = comparisons();
  return !opposite_verdicts() && std::all_of(made.begin(), made.end(), [](const Comparison& c) { return c.agrees(); });
}

bool SpeedCheck::agrees() const {
  return std::all_of(rods.begin(), rods.end(), [](const RodCheck& rod) { return rod.agrees(); }) &&
         (!joints || joints->agrees());
}

std::optional<WorstComparison> worst_comparison(const std::vector<SpeedCheck>& checks) {
  std::optional<WorstComparison> worst;
  const auto look_at = [&](double speed, const std::string& where, const Comparison& comparison) {
    if (!worst || !(share(comparison) <= share(worst->comparison))) worst = WorstComparison{speed, where, comparison};
  };
  for (const SpeedCheck& check : checks) {
    for (const RodCheck& rod : check.rods)
      for (const Comparison& comparison : rod.comparisons()) look_at(check.speed, rod.name, comparison);
    if (check.joints) {
      look_at(check.speed, check.joints->worst, check.joints->forces);
      look_at(check.speed, "crank", check.joints->torque);
    }
  }
  return worst;
}

SpeedCheck cross_check(const SceneModel& model, double speed, const Settings& settings, const CheckOptions& options) {
  SpeedCheck check;
  check.speed = speed;
  Settings wanted = settings;
  wanted.only.steady = true;
  wanted.only.shape = false;
  const auto start = std::chrono::steady_clock::now();
  SpeedResult series = analyse(model, speed, wanted, true);
  check.seconds_harmonic_balance = seconds_since(start);
  check.shortfalls = series.shortfalls;
  for (const RodResult& rod : series.rods)
    if (rod.stability) check.verdicts.emplace_back(rod.name, rod.stability->verdict);

  bool complete = true;  // joint forces need every rod
  std::vector<int> links;
  for (std::size_t r = 0; r < series.rods.size(); ++r) {
    RodResult& result = series.rods[r];
    if (!result.reported) {
      complete = false;
      continue;
    }
    RodCheck rod;
    rod.name = result.name;
    rod.steady = std::move(*result.steady);
    rod.stability = std::move(result.stability);
    if (series.theory) rod.theory_error = series.theory->rods[r].q;
    const TimeDomainSystem system = model.linkage() != nullptr
                                        ? time_domain_rod(*model.linkage(), result.link, result.num_modes, speed)
                                        : time_domain_system(model.rods[r].system, speed);
    ShootingOptions shooting;
    shooting.tolerance = integration_tolerance(settings);
    shooting.integrator = options.integrator;
    shooting.time_limit = options.time_limit;
    if (options.begin)
      shooting.begin = [&](Integrator integrator, double seconds) { options.begin(rod.name, integrator, seconds); };
    rod.shooting = solve_by_shooting(system, shooting);
    check.seconds_shooting += rod.shooting.seconds;
    keep_deflection(rod.shooting.orbit, result.num_modes);
    keep_deflection(rod.shooting.coarser, result.num_modes);
    const bool unstable = rod.shooting.verdict == Verdict::unstable;
    if (options.march) {
      MarchingOptions marching;
      marching.tolerance = shooting.tolerance;
      marching.integrator = options.integrator;
      marching.time_limit = options.time_limit;
      marching.growth_rate = rod.shooting.verdict == Verdict::undecided ? 0 : rod.shooting.growth_rate;
      rod.marching = march_from_rest(system, marching);
      check.seconds_marching += rod.marching->seconds;
      keep_deflection(rod.marching->orbit, result.num_modes);
      // That an unstable motion is never reached from rest is no shortfall of the integration.
      if (rod.marching->status != ShootingStatus::converged && !unstable)
        check.shortfalls.push_back(rod.name + ": marching: " + rod.marching->message);
    }

    const bool singular = rod.steady.status == SteadyStatus::singular;
    rod.both_singular = singular && rod.shooting.status == ShootingStatus::singular;
    if (rod.both_singular)
      rod.not_compared = "neither path finds a unique periodic solution: they agree";
    else if (rod.shooting.orbit.q.size() == 0 || rod.shooting.coarser.q.size() == 0)
      rod.not_compared = "time integration: " + rod.shooting.message;
    else if (singular)
      rod.not_compared = "harmonic balance finds no unique periodic solution";
    if (rod.shooting.status != ShootingStatus::converged && !rod.both_singular)
      check.shortfalls.push_back(rod.name + ": time integration: " + rod.shooting.message);
    if (rod.compared()) {
      compare_states(rod, model.linkage() != nullptr && settings.only.shape);
      if (rod.stability) rod.exponents = compare_exponents(*rod.stability, rod.shooting, result.num_exponents, speed);
    } else {
      complete = false;
    }
    links.push_back(result.link);
    check.rods.push_back(std::move(rod));
  }
  for (const RodResult& rod : series.rods) check.theory_rods.push_back(rod.name);
  check.theory = std::move(series.theory);
  if (series.forces && complete)
    check.joints = compare_joints(*model.linkage(), *series.forces, check.rods, links, speed);
  return check;
}

}  // namespace hb
