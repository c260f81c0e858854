#include "hb/engine/time/time_integration.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "hb/engine/time/sundials_session.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

const char* to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::automatic:
      return "automatic";
    case Integrator::adams:
      return "CVODE Adams";
    case Integrator::bdf:
      return "CVODE BDF";
    case Integrator::collocation:
      return "Radau collocation";
  }
  return "";
}

ScaledMotion::ScaledMotion(const TimeDomainSystem& system)
    : system_(system), tau_(std::numeric_limits<double>::quiet_NaN()) {
  const Eigen::Index I = system.num_modes();
  const double Omega = system.speed;
  mass_inverse_ = dense::inverse(system.mass);
  C_.resize(I, I);
  h_.resize(I);
  // Sizes over the turn: |K_ii| for the frequencies, |h_i| against stiffness and inertia for the response.
  constexpr int num_looks = 64;
  const Eigen::ArrayXd inertia = mass_inverse_.diagonal().array().abs();
  Eigen::ArrayXd stiffness = Eigen::ArrayXd::Zero(I), response = Eigen::ArrayXd::Zero(I);
  for (int j = 0; j < num_looks; ++j) {
    system.evaluate(2 * std::numbers::pi * j / num_looks, C_, h_);
    stiffness += (mass_inverse_ * C_).diagonal().array().abs() / (Omega * Omega * num_looks);
    const Eigen::ArrayXd force = (mass_inverse_ * h_).array().abs() / (Omega * Omega);
    response = response.max(force);
  }
  w_ = stiffness.sqrt().max(1.0);
  q_scale_ = (response / (1 + stiffness)).maxCoeff();
  G_ = w_.cwiseInverse().asDiagonal() * (mass_inverse_ * system.damping / Omega) * w_.asDiagonal();
}

void ScaledMotion::evaluate(double tau) {
  if (tau == tau_) return;
  tau_ = tau;
  ++evaluations_;
  system_.evaluate(tau, C_, h_);
  const double Omega2 = system_.speed * system_.speed;
  K_.noalias() = mass_inverse_ * C_;
  K_ = w_.cwiseInverse().asDiagonal() * K_ / Omega2;
  if (loaded())
    f_ = (mass_inverse_ * h_).cwiseQuotient(w_) / (Omega2 * q_scale_);
  else
    f_.setZero(w_.size());
}

Eigen::VectorXcd ScaledMotion::frozen_eigenvalues(double tau) {
  evaluate(tau);
  const Eigen::Index I = num_modes();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2 * I, 2 * I);
  J.topRightCorner(I, I) = w_.asDiagonal();
  J.bottomLeftCorner(I, I) = -K_;
  J.bottomRightCorner(I, I) = -G_;
  return dense::eigenvalues(J);
}

namespace {

// ---- CVODE ----

struct Problem {
  ScaledMotion& motion;
  const Eigen::VectorXd& load;
  Deadline deadline;
  void* cvode = nullptr;
  bool late = false;

  Eigen::Index rows() const { return 2 * motion.num_modes(); }
  Eigen::Map<Eigen::MatrixXd> matrix(N_Vector y) const { return {N_VGetArrayPointer(y), rows(), load.size()}; }
};

int right_hand_side(realtype tau, N_Vector y, N_Vector slope, void* data) {
  auto& problem = *static_cast<Problem*>(data);
  if (std::chrono::steady_clock::now() > problem.deadline || stop_wished()) {
    problem.late = true;
    return -1;
  }
  ScaledMotion& motion = problem.motion;
  motion.evaluate(tau);
  const Eigen::Index I = motion.num_modes();
  const auto Y = problem.matrix(y);
  auto D = problem.matrix(slope);
  D.topRows(I) = motion.w().asDiagonal() * Y.bottomRows(I);
  D.bottomRows(I).noalias() = -motion.K() * Y.topRows(I);
  D.bottomRows(I).noalias() -= motion.G() * Y.bottomRows(I);
  D.bottomRows(I).noalias() += motion.f() * problem.load.transpose();
  return D.allFinite() ? 0 : -1;
}

// Newton's matrix (1 - gamma J) is exact and the same for every column. With J of the first-order form,
//   dx - gamma W dv = bx,   dv + gamma (K dx + G dv) = bv   =>   (1 + gamma G + gamma^2 K W) dv = bv - gamma K bx.
int solve_newton(SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, realtype) {
  auto& problem = *static_cast<Problem*>(solver->content);
  const auto place = newton_place(problem.cvode);
  if (!place) return SUNLS_PACKAGE_FAIL_UNREC;
  const auto [tau, gamma] = *place;
  ScaledMotion& motion = problem.motion;
  motion.evaluate(tau);
  const Eigen::Index I = motion.num_modes();
  const Eigen::VectorXd& w = motion.w();
  const Eigen::MatrixXd A =
      Eigen::MatrixXd::Identity(I, I) + gamma * motion.G() + gamma * gamma * motion.K() * w.asDiagonal();
  const auto B = problem.matrix(b);
  auto X = problem.matrix(x);
  const Eigen::MatrixXd right = B.bottomRows(I) - gamma * motion.K() * B.topRows(I);
  X.bottomRows(I) = dense::Lu<double>(A).solve(right);
  X.topRows(I) = B.topRows(I) + gamma * w.asDiagonal() * X.bottomRows(I);
  return SUNLS_SUCCESS;
}

}  // namespace

Trajectory integrate_cvode(ScaledMotion& motion, Integrator method, double tolerance, double tau0,
                           const Eigen::MatrixXd& Y0, const Eigen::VectorXd& load, std::span<const double> outputs,
                           Deadline deadline) {
  SundialsSession sundials(method, Y0.size());
  Problem problem{motion, load, deadline, sundials.cvode()};
  problem.matrix(sundials.y()) = Y0;
  sundials.start({right_hand_side, solve_newton, &problem}, tau0, tolerance, outputs.back());
  return sundials.follow(
      outputs, [&](N_Vector y) { return problem.matrix(y); },
      [&](std::string word) -> SundialsSession::Failure {
        if (!problem.late) return {IntegrationStatus::failed, std::move(word)};
        end_if_wished();
        return {IntegrationStatus::time_limit, "time limit"};
      });
}

namespace {

// ---- Radau IIA collocation ----

constexpr Eigen::Index num_stages = 9;

// P_n on (-1, 1) and its derivative.
std::pair<double, double> legendre(Eigen::Index n, double s) {
  if (n == 0) return {1, 0};
  double p0 = 1, p1 = s, d0 = 0, d1 = 1;
  for (Eigen::Index k = 2; k <= n; ++k) {
    const double kk = static_cast<double>(k);
    const double p2 = ((2 * kk - 1) * s * p1 - (kk - 1) * p0) / kk, d2 = d0 + (2 * kk - 1) * p1;
    p0 = std::exchange(p1, p2);
    d0 = std::exchange(d1, d2);
  }
  return {p1, d1};
}

// Nodes c: roots of P_s(2c-1) - P_(s-1)(2c-1), the last one c = 1. A_ij = int_0^c_i L_j: integration of the Lagrange
// polynomials, here by solving A V = R with V_jk = P_k(2 c_j - 1), R_ik = int_0^c_i P_k (2c-1) dc. A2 = A A.
struct RadauTableau {
  Eigen::VectorXd c{num_stages};
  Eigen::MatrixXd A, A2;

  RadauTableau() {
    for (Eigen::Index j = 0; j < num_stages - 1; ++j) {
      double s =
          -std::cos(std::numbers::pi * (static_cast<double>(j) + 0.75) / (static_cast<double>(num_stages) + 0.25));
      for (int step = 0; step < 30; ++step) {
        const auto [p, d] = legendre(num_stages, s);
        const auto [p1, d1] = legendre(num_stages - 1, s);
        // Newton with the roots already found, and the one at s = 1, divided out.
        double sum = 1 / (s - 1);
        for (Eigen::Index k = 0; k < j; ++k) sum += 1 / (s - (2 * c(k) - 1));
        const double ratio = (p - p1) / (d - d1);
        const double change = ratio / (1 - ratio * sum);
        s -= change;
        if (std::abs(change) <= 1e-16) break;
      }
      c(j) = (s + 1) / 2;
    }
    c(num_stages - 1) = 1;
    Eigen::MatrixXd V(num_stages, num_stages), R(num_stages, num_stages);
    for (Eigen::Index i = 0; i < num_stages; ++i) {
      const double s = 2 * c(i) - 1;
      for (Eigen::Index k = 0; k < num_stages; ++k) {
        V(i, k) = legendre(k, s).first;
        // int P_k ds = (P_(k+1) - P_(k-1))/(2k+1), zero at s = -1; dc = ds/2.
        R(i, k) = k == 0
                      ? (s + 1) / 2
                      : (legendre(k + 1, s).first - legendre(k - 1, s).first) / (2 * (2 * static_cast<double>(k) + 1));
      }
    }
    A = dense::Lu<double>(V.transpose()).solve(R.transpose()).transpose();
    A2 = A * A;
  }
};

const RadauTableau& radau() {
  static const RadauTableau tableau;
  return tableau;
}

}  // namespace

// With u = x', ' = d/dtau, and accelerations a_j = x'' at the stages,
//   x_j = x + c_j h u + h^2 sum_k A2_jk a_k,   u_j = u + h sum_k A_jk a_k,   a_j + D u_j + K_j x_j = load f_j,
// D = W G W^-1, K and f times W: one linear system of s I unknowns a per cell, the unit matrix for a short one. The
// last stage is the end of the cell. (With displacements as unknowns, the velocity is a difference of nearly equal
// numbers.)
Trajectory integrate_collocation(ScaledMotion& motion, int cells_between, double tau0, const Eigen::MatrixXd& Y0,
                                 const Eigen::VectorXd& load, std::span<const double> outputs, Deadline deadline) {
  const RadauTableau& tableau = radau();
  const Eigen::Index s = num_stages, I = motion.num_modes(), m = Y0.cols();
  const Eigen::VectorXd& w = motion.w();
  const Eigen::MatrixXd damping = w.asDiagonal() * motion.G() * w.cwiseInverse().asDiagonal();
  Eigen::MatrixXd Y = Y0, system(s * I, s * I), right(s * I, m);
  Trajectory trajectory;
  trajectory.states.reserve(outputs.size());
  double start = tau0;
  for (const double end : outputs) {
    const double h = (end - start) / cells_between;
    for (int cell = 0; cell < cells_between; ++cell) {
      end_if_wished();
      if (std::chrono::steady_clock::now() > deadline) {
        trajectory.status = IntegrationStatus::time_limit;
        trajectory.message = "time limit at crank angle " + std::to_string(start + cell * h) + " rad";
        return trajectory;
      }
      const Eigen::MatrixXd x = Y.topRows(I), u = w.asDiagonal() * Y.bottomRows(I);
      for (Eigen::Index j = 0; j < s; ++j) {
        motion.evaluate(start + (cell + tableau.c(j)) * h);
        const Eigen::MatrixXd K = w.asDiagonal() * motion.K();
        for (Eigen::Index k = 0; k < s; ++k)
          system.block(j * I, k * I, I, I) = h * tableau.A(j, k) * damping + h * h * tableau.A2(j, k) * K;
        system.block(j * I, j * I, I, I).diagonal().array() += 1;
        right.middleRows(j * I, I) =
            w.cwiseProduct(motion.f()) * load.transpose() - damping * u - K * (x + tableau.c(j) * h * u);
      }
      // Rows of fast modes are h^2 w^2 larger than the others: equal them before pivoting.
      const Eigen::VectorXd row_scale = system.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
      const Eigen::MatrixXd a =
          dense::Lu<double>(row_scale.asDiagonal() * system).solve(row_scale.asDiagonal() * right);
      Eigen::MatrixXd dx = h * u, du = Eigen::MatrixXd::Zero(I, m);
      for (Eigen::Index k = 0; k < s; ++k) {
        dx += h * h * tableau.A2(s - 1, k) * a.middleRows(k * I, I);
        du += h * tableau.A(s - 1, k) * a.middleRows(k * I, I);
      }
      Y.topRows(I) += dx;
      Y.bottomRows(I) += w.cwiseInverse().asDiagonal() * du;
      ++trajectory.steps;
    }
    if (!Y.allFinite()) {
      trajectory.message = "not finite at crank angle " + std::to_string(end) + " rad";
      return trajectory;
    }
    trajectory.states.push_back(Y);
    start = end;
  }
  trajectory.status = IntegrationStatus::finished;
  return trajectory;
}

Deadline deadline_after(Deadline start, double seconds) {
  return start + std::chrono::duration_cast<Deadline::duration>(std::chrono::duration<double>(std::min(seconds, 1e8)));
}

double error_per_step(Integrator integrator, double tolerance) {
  return (integrator == Integrator::bdf ? 5 : 1) * tolerance;
}

}  // namespace hb
