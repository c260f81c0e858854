#include "tests/support/dense_harmonic_balance.hpp"

#include <Eigen/LU>
#include <cmath>

namespace hb::reference {

namespace {

// Coefficient of cos m tau (and sin m tau) of one component at one speed.
void cos_sin(const std::array<FourierSeries, 3>& powers, long double speed, Eigen::Index component, Eigen::Index m,
             long double& cosine, long double& sine) {
  cosine = sine = 0;
  long double factor = 1;
  for (const FourierSeries& part : powers) {
    if (m < part.c.cols()) {
      const long double twice = m == 0 ? 1 : 2;
      cosine += factor * twice * static_cast<long double>(part.c(component, m).real());
      if (m > 0) sine -= factor * twice * static_cast<long double>(part.c(component, m).imag());
    }
    factor *= speed;
  }
}

// Of A x = b: a factorisation in double, refined with residuals in long double. last_change: of x, relative.
Vector refined_solution(Matrix A, Vector b, long double& last_change) {
  const Eigen::Index n = A.rows();
  // Rows and columns scaled by powers of two before the factorisation.
  Vector row(n), column(n);
  for (Eigen::Index i = 0; i < n; ++i) row(i) = std::exp2(-std::round(std::log2(A.row(i).cwiseAbs().maxCoeff())));
  A = row.asDiagonal() * A;
  b = row.asDiagonal() * b;
  const long double load = b.cwiseAbs().maxCoeff();
  b /= load;
  for (Eigen::Index i = 0; i < n; ++i) column(i) = std::exp2(-std::round(std::log2(A.col(i).cwiseAbs().maxCoeff())));
  A = A * column.asDiagonal();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(A.cast<double>());
  Vector x = Vector::Zero(n), r = b;
  long double last = HUGE_VALL;
  for (int refinement = 0; refinement < 12; ++refinement) {
    const long double size = r.cwiseAbs().maxCoeff();
    if (size == 0) break;
    const Vector change = lu.solve((r / size).cast<double>()).cast<long double>() * size;
    const long double now = change.cwiseAbs().maxCoeff();
    if (refinement > 2 && !(now < last / 2)) break;
    last = now;
    x += change;
    last_change = now / x.cwiseAbs().maxCoeff();
    r = b - A * x;
  }
  return column.asDiagonal() * x * load;
}

}  // namespace

Response dense_harmonic_balance(const HillSystem& system, double speed, Eigen::Index H) {
  const Eigen::Index I = system.num_modes(), n = I * (2 * H + 1);
  Eigen::Index P = 0;
  for (const FourierSeries& part : system.stiffness) P = std::max(P, part.num_harmonics());
  const long double Omega = speed;
  const auto cos_at = [I](Eigen::Index i, Eigen::Index k) { return k == 0 ? i : I * (2 * k - 1) + i; };
  const auto sin_at = [I](Eigen::Index i, Eigen::Index k) { return I * 2 * k + i; };

  Matrix A = Matrix::Zero(n, n);
  Vector b = Vector::Zero(n);
  for (Eigen::Index k = 0; k <= H; ++k) {
    const long double w = Omega * static_cast<long double>(k);
    for (Eigen::Index i = 0; i < I; ++i) {
      for (Eigen::Index j = 0; j < I; ++j) {
        A(cos_at(i, k), cos_at(j, k)) -= w * w * system.mass(i, j);
        if (k == 0) continue;
        A(sin_at(i, k), sin_at(j, k)) -= w * w * system.mass(i, j);
        A(cos_at(i, k), sin_at(j, k)) += w * system.damping(i, j);
        A(sin_at(i, k), cos_at(j, k)) -= w * system.damping(i, j);
      }
      long double hc, hs;
      cos_sin(system.load, Omega, i, k, hc, hs);
      b(cos_at(i, k)) = hc;
      if (k > 0) b(sin_at(i, k)) = hs;
    }
  }
  // cos m cos l = (cos(m+l) + cos(m-l))/2, sin m cos l = (sin(m+l) + sin(m-l))/2, and so on.
  for (Eigen::Index m = 0; m <= P; ++m)
    for (Eigen::Index j = 0; j < I; ++j)
      for (Eigen::Index i = 0; i < I; ++i) {
        long double c, s;
        cos_sin(system.stiffness, Omega, i + I * j, m, c, s);
        if (c == 0 && s == 0) continue;
        for (Eigen::Index l = 0; l <= H; ++l) {
          const Eigen::Index sum = m + l, difference = std::abs(m - l);
          const long double sign = m >= l ? 1 : -1;  // sin((m-l) tau) = sign sin(|m-l| tau)
          if (sum <= H) {
            A(cos_at(i, sum), cos_at(j, l)) += c / 2;
            if (sum > 0) A(sin_at(i, sum), cos_at(j, l)) += s / 2;
            if (l > 0) {
              A(sin_at(i, sum), sin_at(j, l)) += c / 2;
              A(cos_at(i, sum), sin_at(j, l)) -= s / 2;
            }
          }
          if (difference <= H) {
            A(cos_at(i, difference), cos_at(j, l)) += c / 2;
            if (difference > 0) A(sin_at(i, difference), cos_at(j, l)) += sign * s / 2;
            if (l > 0) {
              if (difference > 0) A(sin_at(i, difference), sin_at(j, l)) -= sign * c / 2;
              A(cos_at(i, difference), sin_at(j, l)) += s / 2;
            }
          }
        }
      }

  Response response;
  const Vector x = refined_solution(std::move(A), std::move(b), response.change);
  response.cosine = Matrix::Zero(I, H + 1);
  response.sine = Matrix::Zero(I, H + 1);
  for (Eigen::Index k = 0; k <= H; ++k)
    for (Eigen::Index i = 0; i < I; ++i) {
      response.cosine(i, k) = x(cos_at(i, k));
      if (k > 0) response.sine(i, k) = x(sin_at(i, k));
    }
  return response;
}

double true_error(const FourierSeries& q, const Response& reference) {
  const Eigen::Index I = reference.cosine.rows();
  const Eigen::Index H = std::max(q.num_harmonics(), reference.cosine.cols() - 1);
  const long double unit = reference.cosine.cwiseAbs().maxCoeff() + reference.sine.cwiseAbs().maxCoeff();
  FourierSeries error(I, H), exact(I, H);
  for (Eigen::Index k = 0; k <= H; ++k)
    for (Eigen::Index i = 0; i < I; ++i) {
      const long double half = k == 0 ? 1 : 0.5L;
      long double re = 0, im = 0;
      if (k < reference.cosine.cols()) {
        re = half * reference.cosine(i, k) / unit;
        im = k == 0 ? 0 : -half * reference.sine(i, k) / unit;
      }
      exact.c(i, k) = {static_cast<double>(re), static_cast<double>(im)};
      if (k <= q.num_harmonics()) {
        re -= static_cast<long double>(q.c(i, k).real()) / unit;
        im -= static_cast<long double>(q.c(i, k).imag()) / unit;
      }
      error.c(i, k) = {static_cast<double>(re), static_cast<double>(im)};
    }
  // The denominator to its last digit: samples miss peaks by more than tight bounds forgive.
  double largest = 0;
  for (Eigen::Index i = 0; i < I; ++i) largest = std::max(largest, fourier::max_abs(exact, i).value);
  return fourier::synthesise(error, 4 * (H + 1) + 64).cwiseAbs().maxCoeff() / largest;
}

}  // namespace hb::reference
