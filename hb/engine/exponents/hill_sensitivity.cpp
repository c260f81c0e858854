#include "hb/engine/exponents/hill_sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/steady/steady_state.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

// (C x)_k = sum_m C_{k-m} x_m, columns k, m = first..last; C_{-k} = conj C_k.
MatrixXcd coupled(const FourierSeries& C, const MatrixXcd& x) {
  const Index I = x.rows(), n = x.cols(), P = C.num_harmonics();
  MatrixXcd result = MatrixXcd::Zero(I, n);
  for (Index p = 0; p <= P; ++p) {
    const Eigen::Map<const MatrixXcd> c(C.c.col(p).data(), I, I);
    const Index count = n - p;
    if (count <= 0) break;
    result.rightCols(count) += c * x.leftCols(count);
    if (p > 0) result.leftCols(count) += c.conjugate() * x.rightCols(count);
  }
  return result;
}

// Columns -H..H of a real function.
MatrixXcd both_signs(const FourierSeries& f) {
  const Index H = f.num_harmonics();
  MatrixXcd all(f.num_components(), 2 * H + 1);
  all.rightCols(H + 1) = f.c;
  for (Index k = 1; k <= H; ++k) all.col(H - k) = f.c.col(k).conjugate();
  return all;
}

// S(s) x of columns -H..H, every column with its harmonic of `speed`.
MatrixXcd hill_product(const HillSystem& system, double speed, Complex s, const MatrixXcd& x) {
  const Index H = (x.cols() - 1) / 2;
  MatrixXcd result = coupled(stiffness_at(system, speed), x);
  for (Index k = -H; k <= H; ++k) {
    const Complex sigma = s + Complex(0, static_cast<double>(k) * speed);
    result.col(k + H) += sigma * (sigma * (system.mass * x.col(k + H)) + system.damping * x.col(k + H));
  }
  return result;
}

std::optional<FourierSeries> solved(const HillSystem& system, double speed, Index num_harmonics) {
  SteadyOptions options;
  options.method = SteadyMethod::direct;
  options.num_harmonics = static_cast<int>(std::max<Index>(1, num_harmonics));
  SteadyState state = solve_steady_state(system, speed, options);
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return fourier::resized(state.q, num_harmonics);
}

// Hill matrix of x'' + G x' + K x at s per radian of crank angle, harmonics -H..H.
MatrixXcd hill_matrix(const ScaledSystem& system, Complex s, Index H) {
  const Index I = system.num_modes(), n = 2 * H + 1, P = system.K.num_harmonics();
  MatrixXcd A = MatrixXcd::Zero(I * n, I * n);
  for (Index k = 0; k < n; ++k) {
    for (Index m = std::max<Index>(0, k - P); m <= std::min(n - 1, k + P); ++m) {
      const Eigen::Map<const MatrixXcd> K(system.K.c.col(std::abs(k - m)).data(), I, I);
      A.block(I * k, I * m, I, I) = k >= m ? MatrixXcd(K) : MatrixXcd(K.conjugate());
    }
    const Complex sigma = s + Complex(0, static_cast<double>(k - H));
    A.block(I * k, I * k, I, I) += sigma * system.G;
    A.block(I * k, I * k, I, I).diagonal().array() += sigma * sigma;
  }
  return A;
}

// S'(s) x = (2 (s + ik) + G) x_k, or its conjugate transpose.
VectorXcd slope_product(const ScaledSystem& system, Complex s, const VectorXcd& x, bool adjoint) {
  const Index I = system.num_modes(), n = x.size() / I;
  VectorXcd result(x.size());
  for (Index k = 0; k < n; ++k) {
    const Complex twice = 2.0 * (s + Complex(0, static_cast<double>(k - (n - 1) / 2)));
    const auto part = x.segment(I * k, I);
    if (adjoint)
      result.segment(I * k, I) = std::conj(twice) * part + system.G.transpose() * part;
    else
      result.segment(I * k, I) = twice * part + system.G * part;
  }
  return result;
}

// The share of a vector in its outermost harmonics.
double outer_share(const VectorXcd& x, Index I) {
  return std::max(x.head(I).cwiseAbs().maxCoeff(), x.tail(I).cwiseAbs().maxCoeff()) / x.cwiseAbs().maxCoeff();
}

}  // namespace

FourierSeries equation_residual(const HillSystem& system, double speed, const FourierSeries& q) {
  const Index H = q.num_harmonics();
  const MatrixXcd product = hill_product(system, speed, 0, both_signs(q));
  FourierSeries r(MatrixXcd(-product.rightCols(H + 1)));
  const FourierSeries h = load_at(system, speed);
  if (h.c.size() > 0) r.c += fourier::resized(h, H).c;
  return r;
}

std::optional<FourierSeries> solve_linearised(const HillSystem& system, double speed, FourierSeries r,
                                              Index num_harmonics) {
  HillSystem linearised = system;
  linearised.load = {fourier::resized(r, num_harmonics), {}, {}};
  return solved(linearised, speed, num_harmonics);
}

// In reversed time, mu(tau) = lambda(-tau):  M^T mu'' + B^T mu' + C(-tau)^T mu = g(-tau).
// hb/engine/README.md (A1).
std::optional<FourierSeries> solve_adjoint(const HillSystem& system, double speed, FourierSeries g,
                                           Index num_harmonics) {
  const Index I = system.num_modes();
  HillSystem adjoint;
  adjoint.mass = system.mass.transpose();
  adjoint.damping = system.damping.transpose();
  for (std::size_t p = 0; p < 3; ++p) {
    adjoint.stiffness[p] = system.stiffness[p];
    for (auto column : adjoint.stiffness[p].c.colwise()) {
      const MatrixXcd c = Eigen::Map<const MatrixXcd>(VectorXcd(column).data(), I, I).adjoint();
      column = c.reshaped();
    }
  }
  adjoint.load[0] = FourierSeries(fourier::resized(g, num_harmonics).c.conjugate());
  std::optional<FourierSeries> mu = solved(adjoint, speed, num_harmonics);
  if (mu) mu->c = mu->c.conjugate().eval();
  return mu;
}

FourierSeries point_functional(Index num_modes, Index num_harmonics, Index mode, double crank_angle) {
  FourierSeries g(num_modes, num_harmonics);
  for (Index k = 0; k <= num_harmonics; ++k) g.c(mode, k) = std::polar(1.0, -static_cast<double>(k) * crank_angle);
  return g;
}

std::optional<FloquetVectors> floquet_vectors(const HillSystem& system, double speed, const Exponent& exponent) {
  constexpr Index most_unknowns = 1200;
  constexpr double decayed = 1e-9;  // outermost harmonics: their square is what the derivative loses
  constexpr double simple = 1e-7;  // |y^H S' x| beside |y| |S' x|: where exponents meet it vanishes
  const ScaledSystem scaled = scale_system(system, speed);
  const Index I = scaled.num_modes();
  // The exponent, or its conjugate, moved by k Omega to the frequency of the motion.
  const double real = exponent.value.real() / speed, imag = exponent.value.imag() / speed,
               frequency = exponent.frequency / speed;
  const double up = imag + std::round(frequency - imag), down = -imag + std::round(frequency + imag);
  const Complex s(real, std::abs(up - frequency) <= std::abs(down - frequency) ? up : down);

  for (Index H = 8; I * (2 * H + 1) <= most_unknowns; H *= 2) {
    const Index n = I * (2 * H + 1);
    // Beside the exponent, so that the matrix is regular. x <- S^-1 S' x gains this factor each time and has the right
    // limit up to its square.
    const Complex beside = s + 1e-9 * (1 + std::abs(s));
    const dense::Lu<Complex> lu(hill_matrix(scaled, beside, H));
    VectorXcd x = VectorXcd::Constant(n, 1e-3), y = x;
    x.segment(I * H, I).setOnes();
    y.segment(I * H, I).setOnes();
    for (int step = 0; step < 3; ++step) {
      x = lu.solve(slope_product(scaled, beside, x, false));
      y = lu.solve_adjoint(slope_product(scaled, beside, y, true));
      x /= x.norm();
      y /= y.norm();
    }
    if (!x.allFinite() || !y.allFinite()) return std::nullopt;
    if (!(std::max(outer_share(x, I), outer_share(y, I)) <= decayed)) continue;
    FloquetVectors vectors;
    vectors.speed = speed;
    vectors.s = s * speed;
    vectors.x = scaled.T * x.reshaped(I, 2 * H + 1);
    // Scaled rows are T^-1 M^-1 times those of the given system, over Omega^2.
    vectors.y = (scaled.T_inverse * dense::inverse(system.mass)).transpose() * y.reshaped(I, 2 * H + 1);
    MatrixXcd slope = system.damping * vectors.x;
    for (Index k = -H; k <= H; ++k)
      slope.col(k + H) +=
          2.0 * (vectors.s + Complex(0, static_cast<double>(k) * speed)) * (system.mass * vectors.x.col(k + H));
    vectors.slope = vectors.y.conjugate().cwiseProduct(slope).sum();
    const double size = vectors.y.cwiseAbs().cwiseProduct(slope.cwiseAbs()).sum();
    if (!(std::abs(vectors.slope) >= simple * size)) return std::nullopt;
    // The vectors must belong to this exponent: their own estimate of it agrees with its error bar.
    const Complex estimate = exponent_nearby(vectors, system);
    const double allowed = 10 * exponent.error + 1e-7 * speed * (1 + std::abs(s)) + 1e3 * eps * std::abs(vectors.s);
    if (!(std::abs(estimate - vectors.s) <= allowed)) return std::nullopt;
    return vectors;
  }
  return std::nullopt;
}

// hb/engine/README.md (A3).
Complex exponent_nearby(const FloquetVectors& vectors, const HillSystem& system) {
  const MatrixXcd product = hill_product(system, vectors.speed, vectors.s, vectors.x);
  return vectors.s - vectors.y.conjugate().cwiseProduct(product).sum() / vectors.slope;
}

}  // namespace hb
