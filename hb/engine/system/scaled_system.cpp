#include "hb/engine/system/scaled_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/fourier/moduli.hpp"
#include "lib/modulus.hpp"
#include "lib/parts.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

bool is_diagonal(const Eigen::MatrixXd& A) {
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      if (i != j && A(i, j) != 0) return false;
  return true;
}

bool is_symmetric(const Eigen::MatrixXd& A) { return (A - A.transpose()).norm() <= 8 * eps * A.norm(); }

Eigen::MatrixXd mean_of(const FourierSeries& matrices, Eigen::Index I) {
  return matrices.c.col(0).real().reshaped(I, I);
}

// Off-diagonal part relative to the diagonal, sqrt(|a_ik a_ki| / |a_ii a_kk|), largest.
double coupling(const Eigen::MatrixXd& A) {
  double largest = 0;
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index k = 0; k < i; ++k) {
      const double diagonal = std::sqrt(std::abs(A(i, i) * A(k, k)));
      const double off = std::sqrt(std::abs(A(i, k) * A(k, i)));
      largest = std::max(largest, off == 0 ? 0 : off / std::max(diagonal, 1e-300));
    }
  return largest;
}

// L A T, with the same roundings where L and T are diagonal.
Eigen::MatrixXd between(const Eigen::MatrixXd& L, const Eigen::MatrixXd& A, const Eigen::MatrixXd& T) {
  if (is_diagonal(L) && is_diagonal(T)) return L.diagonal().asDiagonal() * A * T.diagonal().asDiagonal();
  return L * A * T;
}

// Every matrix coefficient c_k becomes left * c_k * right.
FourierSeries transformed(const FourierSeries& matrices, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
  const Eigen::Index I = left.rows();
  if (is_diagonal(left) && is_diagonal(right)) {
    const Eigen::MatrixXd factors = left.diagonal() * right.diagonal().transpose();
    end_if_wished();
    return FourierSeries(with_rows_times(factors, matrices.c));
  }
  FourierSeries result = matrices;
  for (Eigen::Index k = 0; k < matrices.c.cols(); ++k) {
    end_if_wished();
    const Eigen::Map<const Eigen::MatrixXcd> coefficient(matrices.c.col(k).data(), I, I);
    const Eigen::MatrixXcd product = left * coefficient * right;
    result.c.col(k) = Eigen::Map<const Eigen::VectorXcd>(product.data(), I * I);
  }
  return result;
}

FourierSeries cut(FourierSeries series, Eigen::Index num_harmonics) {
  return num_harmonics == series.num_harmonics() ? std::move(series) : fourier::resized(series, num_harmonics);
}

// Drops trailing harmonics that are below rounding in every component, relative to sqrt(k_ii k_kk) of the mean; of a
// mode whose own stiffness is small beside its couplings these, at most sqrt(2) times too large, count. Other modes'
// stiffnesses do not: they may be 1e20 times as large.
constexpr double rounding_of_stiffness = 1e-17, least_of_couplings = 1e-8;
FourierSeries without_rounding(FourierSeries K, Eigen::Index I) {
  Eigen::ArrayXd most = Eigen::ArrayXd::Zero(2 * I * I);  // of real and imaginary parts in turn
  for (Eigen::Index k = 0; k < K.c.cols(); ++k) most = most.max(parts(K.c).col(k).abs());
  const Eigen::MatrixXd largest = most.reshaped(2, I * I).matrix().colwise().norm().reshaped(I, I);
  const Eigen::VectorXd couplings = largest.rowwise().maxCoeff().cwiseMax(largest.colwise().maxCoeff().transpose());
  const Eigen::VectorXd scale =
      mean_of(K, I).diagonal().cwiseAbs().cwiseMax(couplings * least_of_couplings).cwiseSqrt();
  const Eigen::ArrayXd rounding = (rounding_of_stiffness * scale * scale.transpose()).reshaped();
  Eigen::Index H = K.num_harmonics();
  while (H > 0 && (moduli(K.c.col(H)).array() <= rounding).all()) --H;
  return cut(std::move(K), H);
}

// Sum over the powers of Omega and all harmonics of the size of every component: what rounding errors are relative to.
Eigen::VectorXd sizes(const std::array<FourierSeries, 3>& powers, Eigen::Index num_components, double speed) {
  Eigen::ArrayXd sums = Eigen::ArrayXd::Zero(2 * num_components);  // of real and imaginary parts in turn
  double factor = 2;
  for (const FourierSeries& part : powers) {
    end_if_wished();
    for (Eigen::Index k = 0; k < part.c.cols(); ++k) sums += factor * parts(part.c).col(k).abs();
    factor *= speed;
  }
  return sums.matrix().reshaped(2, num_components).colwise().sum().transpose();
}

// The part of the mean in half of that.
Eigen::VectorXd mean_sizes(const std::array<FourierSeries, 3>& powers, Eigen::Index num_components, double speed) {
  Eigen::VectorXd size = Eigen::VectorXd::Zero(num_components);
  double factor = 1;
  for (const FourierSeries& part : powers) {
    if (part.c.size() > 0) size += factor * part.c.col(0).real().cwiseAbs();
    factor *= speed;
  }
  return size;
}

bool is_power_of_two(double x) {
  int exponent = 0;
  return std::frexp(std::abs(x), &exponent) == 0.5;
}

// Rounding errors of the stiffness where L and T are diagonal, relative to the size of each component, in epsilon:
// half an epsilon for each operation that is not exact.
double scaling_steps(const HillSystem& system, const Eigen::VectorXd& T, double speed) {
  constexpr double sampled = 1;  // harmonics left out, sums over harmonics
  double steps = sampled;
  if (!is_power_of_two(speed)) steps += 1.5;  // Omega^2, its inverse and the product
  if (!std::all_of(T.begin(), T.end(), is_power_of_two)) steps += 3;  // two roots, inverses and products
  if (system.stiffness[1].c.size() > 0 || system.stiffness[2].c.size() > 0) steps += 2;  // powers of Omega added
  return steps;
}

// See ScaledSystem::conservative, in the coordinates of the given system.
Eigen::Array<bool, Eigen::Dynamic, 1> conservative_modes(const HillSystem& system) {
  const Eigen::Index I = system.num_modes();
  Eigen::Array<bool, Eigen::Dynamic, 1> result = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(I, true);
  for (Eigen::Index j = 0; j < I; ++j) {
    end_if_wished();
    for (Eigen::Index i = j; i >= 0; --i) {
      if (!result(i) && !result(j)) continue;
      bool here = system.mass(i, j) == system.mass(j, i) && system.damping(i, j) == -system.damping(j, i);
      for (const FourierSeries& part : system.stiffness)
        here = here && (part.c.size() == 0 || part.c.row(i + I * j) == part.c.row(j + I * i));
      if (!here) result(i) = result(j) = false;
    }
  }
  return result;
}

// What B and C are given wrong by, in the errors of G and K.
void add_given(const GivenErrors& given, const Eigen::MatrixXd& L, ScaledSystem& scaled) {
  const double speed = scaled.speed;
  const auto add = [&](const Eigen::MatrixXd& error, double scale, Eigen::MatrixXd& bound) {
    if (error.size() > 0) bound += scale * L.cwiseAbs() * error * scaled.T.cwiseAbs();
  };
  scaled.G_error = Eigen::MatrixXd::Zero(L.rows(), L.rows());
  add(given.damping, 1 / speed, scaled.G_error);
  add(given.stiffness, 1 / (speed * speed), scaled.K_rounding);
}

// Turns to the eigenvectors of the mean stiffness where that leaves far less coupling in stiffness and damping together
// (factor by experience: a diagonal damping matrix is worth keeping).
void turn_to_eigenvectors(const Eigen::MatrixXd& mean, const Eigen::MatrixXd& damping, Eigen::MatrixXd& L,
                          Eigen::MatrixXd& T) {
  const Eigen::MatrixXd K0 = between(L, mean, T);
  if (!is_symmetric(K0)) return;
  const Eigen::MatrixXd B0 = between(L, damping, T), Q = dense::symmetric_eigenpairs(K0).vectors;
  if (!(coupling(Q.transpose() * B0 * Q) < 0.1 * (coupling(K0) + coupling(B0)))) return;
  L = Q.transpose() * L;
  T = T * Q;
}

void require_speed(double speed) {
  if (!(speed > 0 && std::isfinite(speed)))
    throw std::invalid_argument("scale_system: speed must be positive and finite, is " + std::to_string(speed));
}

// L M T = 1.
struct MassFactors {
  Eigen::MatrixXd L, T;
};

MassFactors mass_factors(const Eigen::MatrixXd& mass) {
  if (is_diagonal(mass) && (mass.diagonal().array() > 0).all()) {
    const Eigen::MatrixXd root = mass.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    return {root, root};
  }
  if (is_symmetric(mass))
    if (const std::optional<Eigen::MatrixXd> root = dense::inverse_square_root(mass)) return {*root, *root};
  return {dense::inverse(mass), Eigen::MatrixXd::Identity(mass.rows(), mass.rows())};
}

// Ascending, of complex ones the real part.
Eigen::VectorXd eigenvalues_of_mean(const Eigen::MatrixXd& K0) {
  const bool symmetric = (K0 - K0.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * dense::largest(K0);
  if (symmetric) return dense::symmetric_eigenpairs(K0).values;
  Eigen::VectorXd values = dense::eigenvalues(K0).real();
  std::sort(values.begin(), values.end());
  return values;
}

// hb/engine/README.md (S2) but for the load, and L. No bounds on rounding.
ScaledSystem scaled_matrices(const HillSystem& system, double speed, Eigen::MatrixXd& L) {
  require_speed(speed);
  const Eigen::Index I = system.num_modes();
  end_if_wished();
  const FourierSeries C = stiffness_at(system, speed);
  end_if_wished();

  auto [left, T] = mass_factors(system.mass);
  L = std::move(left);

  if (I > 1) turn_to_eigenvectors(mean_of(C, I), system.damping, L, T);

  ScaledSystem scaled;
  scaled.speed = speed;
  scaled.T = T;
  scaled.T_inverse = dense::inverse(T);
  scaled.G = between(L, system.damping, T) / speed;
  scaled.diagonal_damping = is_diagonal(scaled.G);
  scaled.K = transformed(C, L, T);
  end_if_wished();
  parts(scaled.K.c) *= 1 / (speed * speed);
  end_if_wished();
  scaled.K = without_rounding(std::move(scaled.K), I);
  scaled.modulation = modulation_of(scaled.K, I);
  return scaled;
}

// f and its rounding errors, of so many steps in epsilon.
void add_load(const HillSystem& system, const Eigen::MatrixXd& L, double steps, ScaledSystem& scaled) {
  const Eigen::Index I = system.num_modes();
  const double speed = scaled.speed;
  scaled.f_rounding = Eigen::VectorXd::Zero(I);
  FourierSeries h = load_at(system, speed);
  if (h.c.size() == 0) return;
  // The load's own scale is taken out first: amplitudes from 1e-200 to 1e200 neither overflow nor vanish.
  const double largest = h.c.real().cwiseAbs().maxCoeff() + h.c.imag().cwiseAbs().maxCoeff();
  if (!(largest > 0)) return;
  h.c *= 1 / largest;  // complex division would square the divisor
  if (I == 1)
    h.c *= L(0, 0);
  else
    h.c = (L * h.c).eval();
  const double scale = fourier::moduli(h.c).maxCoeff();
  h.c *= 1 / scale;
  scaled.load_scale = largest * (scale / (speed * speed));
  scaled.f_rounding = steps * eps * L.cwiseAbs() * (sizes(system.load, I, speed) / largest) / scale;
  const Eigen::Index significant = fourier::significant_harmonics(h, 1e-18);
  scaled.f = cut(std::move(h), significant);
}

Eigen::MatrixXd number(double x) { return Eigen::MatrixXd::Constant(1, 1, x); }

// Of one mode with positive mass, number by number: matrices would cost several times as much as what is in them.
ScaledSystem one_mode(const HillSystem& system, double speed) {
  require_speed(speed);
  end_if_wished();
  const double l = 1 / std::sqrt(system.mass(0, 0));
  ScaledSystem scaled;
  scaled.speed = speed;
  scaled.T = number(l);
  scaled.T_inverse = number(1 / l);
  scaled.G = number(l * system.damping(0, 0) * l / speed);
  scaled.K = stiffness_at(system, speed);
  scaled.K.c *= l * l;
  scaled.K.c *= 1 / (speed * speed);
  const auto size = [&](Eigen::Index k) { return modulus(scaled.K.c(0, k)); };
  Eigen::Index H = scaled.K.num_harmonics();
  double largest = 0;
  for (Eigen::Index k = 0; k <= H; ++k) largest = std::max(largest, size(k));
  const double mean = std::abs(scaled.K.c(0, 0).real()),
               rounding = rounding_of_stiffness * std::max(mean, least_of_couplings * largest);
  while (H > 0 && size(H) <= rounding) --H;
  scaled.K = cut(std::move(scaled.K), H);
  return scaled;
}

bool is_one_mode(const HillSystem& system) { return system.num_modes() == 1 && system.mass(0, 0) > 0; }

void add_bounds_of_one(const HillSystem& system, const GivenErrors& given, ScaledSystem& scaled) {
  const double speed = scaled.speed, b = system.damping(0, 0), l = scaled.T(0, 0);
  scaled.conservative = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(1, b == -b);
  double real = 0, imaginary = 0, mean = 0, factor = 1;  // see sizes, mean_sizes
  for (const FourierSeries& part : system.stiffness) {
    for (Eigen::Index k = 0; k < part.c.cols(); ++k) {
      real += 2 * factor * std::abs(part.c(0, k).real());
      imaginary += 2 * factor * std::abs(part.c(0, k).imag());
    }
    if (part.c.size() > 0) mean += factor * std::abs(part.c(0, 0).real());
    factor *= speed;
  }
  const double steps = scaling_steps(system, scaled.T.diagonal(), speed);
  scaled.K_rounding = number(steps * eps / (speed * speed) * l * (real + imaginary - mean) * l);
  add_given(given, scaled.T, scaled);
}

}  // namespace

Eigen::MatrixXd ScaledSystem::mean_stiffness() const { return mean_of(K, num_modes()); }

Eigen::VectorXd ScaledSystem::mean_diagonal() const {
  const Eigen::Index I = num_modes();
  Eigen::VectorXd diagonal(I);
  for (Eigen::Index i = 0; i < I; ++i) diagonal(i) = K.c(i * (I + 1), 0).real();
  return diagonal;
}

Eigen::VectorXd ScaledSystem::squared_frequencies() const { return eigenvalues_of_mean(mean_stiffness()); }

Eigen::VectorXd squared_frequencies(const HillSystem& system, double speed) {
  require_speed(speed);
  const Eigen::Index I = system.num_modes();
  Eigen::MatrixXd C0 = Eigen::MatrixXd::Zero(I, I);
  double factor = 1 / (speed * speed);
  for (const FourierSeries& part : system.stiffness) {
    if (part.c.size() > 0) C0 += factor * mean_of(part, I);
    factor *= speed;
  }
  const MassFactors factors = mass_factors(system.mass);
  return eigenvalues_of_mean(between(factors.L, C0, factors.T));
}

ScaledSystem scale_unloaded(const HillSystem& system, double speed) {
  if (is_one_mode(system)) return one_mode(system, speed);
  Eigen::MatrixXd L;
  return scaled_matrices(system, speed, L);
}

ScaledSystem scale_system(const HillSystem& system, double speed, const GivenErrors& given) {
  const Eigen::Index I = system.num_modes();
  constexpr double steps_of_scaling = 4;  // adding three powers and the cut
  if (is_one_mode(system)) {
    ScaledSystem scaled = one_mode(system, speed);
    add_bounds_of_one(system, given, scaled);
    add_load(system, scaled.T, steps_of_scaling, scaled);
    return scaled;
  }
  Eigen::MatrixXd L;
  ScaledSystem scaled = scaled_matrices(system, speed, L);
  const Eigen::MatrixXd& T = scaled.T;
  // Adding three powers, products with L and T (none but scaling when they are diagonal), and the cut.
  end_if_wished();
  const bool scaling = is_diagonal(L) && is_diagonal(T);
  scaled.conservative = conservative_modes(system);
  if (!scaling) scaled.conservative.setConstant(scaled.conservative.all());
  const double steps = steps_of_scaling + (scaling ? 0 : 2 * static_cast<double>(I));
  Eigen::VectorXd stiffness_size = sizes(system.stiffness, I * I, speed);
  if (scaling) stiffness_size -= mean_sizes(system.stiffness, I * I, speed);
  const double stiffness_steps = scaling ? scaling_steps(system, T.diagonal(), speed) : steps;
  scaled.K_rounding = stiffness_steps * eps / (speed * speed) * L.cwiseAbs() *
                      Eigen::Map<const Eigen::MatrixXd>(stiffness_size.data(), I, I) * T.cwiseAbs();
  if (scaled.modulation.found()) scaled.K_rounding += scaled.modulation.left_out.reshaped(I, I);
  add_given(given, L, scaled);
  add_load(system, L, steps, scaled);
  return scaled;
}

}  // namespace hb
