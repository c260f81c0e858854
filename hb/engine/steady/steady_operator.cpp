#include "hb/engine/steady/steady_operator.hpp"

#include <array>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/parts.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

double power_of_two_near(double x) { return std::exp2(std::round(std::log2(x))); }

}  // namespace

Eigen::VectorXd wiener_norms(const Spectrum& x) {
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(x.cols());
  for (Eigen::Index i = 0; i < x.cols() && x.rows() > 0; ++i) norms(i) = 2 * moduli(x.col(i)).sum() - modulus(x(0, i));
  return norms;
}

WeightedSystem weighted(const ScaledSystem& system) {
  WeightedSystem s;
  const Eigen::Index I = system.num_modes();
  s.I = I;
  s.P = system.K.num_harmonics();
  s.weight.resize(I);
  for (Eigen::Index i = 0; i < I; ++i) s.weight(i) = power_of_two_near(system.T.col(i).cwiseAbs().maxCoeff());
  const Eigen::MatrixXd ratio = s.weight * s.weight.cwiseInverse().transpose();
  end_if_wished();
  s.K = with_rows_times(ratio, system.K.c);
  if (system.modulation.found())
    s.modulation = {system.modulation.functions, ratio.reshaped().asDiagonal() * system.modulation.shares, {}};
  end_if_wished();
  s.K_rounding = Eigen::MatrixXd::Zero(I, I);
  s.f_rounding = Eigen::VectorXd::Zero(I);
  if (system.K_rounding.size() > 0) s.K_rounding = system.K_rounding.cwiseProduct(ratio);
  s.G = system.G.cwiseProduct(ratio);
  s.G_off = s.G;
  s.G_off.diagonal().setZero();
  s.diagonal_damping = system.diagonal_damping;
  s.mean = system.mean_diagonal();
  if (system.f_rounding.size() > 0) s.f_rounding = s.weight.cwiseProduct(system.f_rounding);
  if (system.load_scale != 0) s.f = (s.weight.asDiagonal() * system.f.c).transpose();

  const Eigen::VectorXd norms = sums_of_moduli(s.K, 0, 1) + 2 * sums_of_moduli(s.K, 1, s.P);
  Eigen::MatrixXd E = Eigen::Map<const Eigen::MatrixXd>(norms.data(), I, I);
  E.diagonal() -= s.mean.cwiseAbs();
  s.coupling = E.rowwise().sum();
  s.across = s.G_off.cwiseAbs().rowwise().sum();
  Eigen::MatrixXd mean = s.K.col(0).real().reshaped(I, I);
  mean.diagonal().setZero();
  s.within = mean.cwiseAbs().rowwise().sum();
  s.symmetric = !s.modulation.found();
  for (Eigen::Index j = 0; j < I; ++j)
    for (Eigen::Index i = j + 1; i < I; ++i) s.symmetric = s.symmetric && s.K.row(i + I * j) == s.K.row(j + I * i);
  return s;
}

Eigen::MatrixXcd WeightedSystem::block(Eigen::Index k) const {
  Eigen::MatrixXcd B =
      K.col(0).reshaped(I, I) + std::complex<double>(0, static_cast<double>(k)) * G_off.cast<std::complex<double>>();
  for (Eigen::Index i = 0; i < I; ++i) B(i, i) = D(i, k);
  return B;
}

double WeightedSystem::coupled_within(Eigen::Index k) const {
  double largest = 0;
  for (Eigen::Index i = 0; i < I; ++i)
    if (const double sum = within(i) + static_cast<double>(k) * across(i); sum > 0)
      largest = std::max(largest, sum / modulus(D(i, k)));
  return largest;
}

Operator::Operator(const WeightedSystem& system, Eigen::Index num_harmonics)
    : system_(&system),
      H_(num_harmonics),
      D_(num_harmonics + 1, system.I),
      magnitude_(num_harmonics + 1, system.I),
      noise_(Eigen::VectorXd::Zero(system.I)) {
  for (Eigen::Index i = 0; i < system.I; ++i)
    for (Eigen::Index k = 0; k <= H_; ++k) {
      D_(k, i) = system.D(i, k);
      magnitude_(k, i) = system.magnitude(i, k);
    }
}

const Operator::Nodes& Operator::nodes(Eigen::Index N) {
  for (const Nodes& there : nodes_)
    if (there.N == N) return there;
  Nodes& store = nodes_.emplace_back();
  constexpr std::size_t at_once = 16;
  const Eigen::Index I = system_->I, P = system_->P;
  store.N = N;
  store.E.resize(static_cast<std::size_t>(I * I * N / together));
  if (system_->modulation.found()) {
    by_modulation(N, store.E);
    return store;
  }
  const auto put = [&](Eigen::Index i, Eigen::Index j, const double* samples) {
    for (Eigen::Index n = 0; n < N; n += together)
      store.E[static_cast<std::size_t>(I * I * n / together + I * i + j)] = Eigen::Map<const Neighbours>(samples + n);
  };
  std::vector<std::pair<Eigen::Index, Eigen::Index>> entries;
  for (Eigen::Index j = 0; j < I; ++j)
    for (Eigen::Index i = system_->symmetric ? j : 0; i < I; ++i) entries.emplace_back(i, j);
  for (std::size_t first = 0; first < entries.size(); first += at_once) {
    end_if_wished();
    const auto count = static_cast<Eigen::Index>(std::min(at_once, entries.size() - first));
    fourier::RealTransform& fft = fourier::thread_transform(N, count);
    auto spectrum = fft.spectrum();
    spectrum.bottomRows(N / 2 - P).setZero();
    for (Eigen::Index c = 0; c < count; ++c) {
      const auto [i, j] = entries[first + static_cast<std::size_t>(c)];
      spectrum.col(c).head(P + 1) = system_->K.row(i + I * j);
      if (i == j) spectrum(0, c) = 0;
    }
    fft.backward();
    for (Eigen::Index c = 0; c < count; ++c) {
      const auto [i, j] = entries[first + static_cast<std::size_t>(c)];
      put(i, j, fft.samples().col(c).data());
      if (system_->symmetric && i != j) put(j, i, fft.samples().col(c).data());
    }
  }
  return store;
}

// Mean and shares of E_11, E_12, ... one after the other.
void Operator::by_modulation(Eigen::Index N, std::vector<Neighbours>& E) const {
  const Eigen::Index I = system_->I, entries = I * I;
  const Modulation& modulation = system_->modulation;
  Eigen::MatrixXd numbers(modulation.functions.cols() + 1, entries);
  for (Eigen::Index i = 0; i < I; ++i)
    for (Eigen::Index j = 0; j < I; ++j) {
      auto entry = numbers.col(I * i + j);
      entry(0) = i == j ? 0 : system_->K(i + I * j, 0).real();
      entry.tail(entry.size() - 1) = modulation.shares.row(i + I * j).transpose();
    }
  const auto functions = modulation.samples(N);
  with_functions(functions.cols(), [&](auto r) {
    constexpr Eigen::Index most = 8;
    std::array<Neighbours, most> g;
    Neighbours* entry = E.data();
    for (Eigen::Index n = 0; n < N; n += together) {
      for (Eigen::Index m = 0; m < r; ++m)
        g[static_cast<std::size_t>(m)] = functions.col(m).template segment<together>(n).array();
      const double* number = numbers.data();
      for (Eigen::Index q = 0; q < entries; ++q, ++entry) {
        Neighbours sum = Neighbours::Constant(*number++);
        for (Eigen::Index m = 0; m < r; ++m) sum += *number++ * g[static_cast<std::size_t>(m)];
        *entry = sum;
      }
    }
  });
}

void Operator::couple(const Spectrum& x, Eigen::Index num_rows, Spectrum& result) {
  couple(x, num_rows, false, result);
}

// hb/engine/README.md (S3).
void Operator::couple(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result) {
  constexpr Eigen::Index few_products = 8;  // for one number of a result, a guess from the transforms' overhead
  end_if_wished();
  ++num_products_;
  if (system_->I * (2 * system_->P + 1) <= few_products)
    convolve(x, num_rows, full, result);
  else
    multiply(x, num_rows, full, result);
  if (!system_->diagonal_damping) {
    const Eigen::Index top = std::min(x.rows() - 1, num_rows);
    for (Eigen::Index k = 1; k <= top; ++k)
      result.row(k) += std::complex<double>(0, static_cast<double>(k)) *
                       (x.row(k) * system_->G_off.transpose().cast<std::complex<double>>());
  }
}

// (E x)_k = sum over m = -P..P of E_m x_{k-m}, E_-m and x_-m the conjugates; row 0 is real. Rounding of a sum of so
// many products, at most that of the sum of their sizes.
void Operator::convolve(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result) {
  const Eigen::Index I = system_->I, P = system_->P, X = x.rows() - 1;
  result.setZero(num_rows + 1, I);
  for (Eigen::Index j = 0; j < I; ++j)
    for (Eigen::Index i = 0; i < I; ++i)
      for (Eigen::Index m = -P; m <= P; ++m) {
        if (m == 0 && i == j) continue;
        const std::complex<double> E = system_->K(i + I * j, std::abs(m)), factor = m < 0 ? std::conj(E) : E;
        const Eigen::Index first = std::max<Eigen::Index>(0, m - X), last = std::min(num_rows, X + m);
        for (Eigen::Index k = first; k <= last; ++k) {
          const std::complex<double> other = k >= m ? x(k - m, j) : std::conj(x(m - k, j));
          result(k, i) += std::complex<double>(factor.real() * other.real() - factor.imag() * other.imag(),
                                               factor.real() * other.imag() + factor.imag() * other.real());
        }
      }
  result.row(0) = result.row(0).real().cast<std::complex<double>>();
  if (full) noise_ = static_cast<double>(I * (2 * P + 1) + 2) * eps * moduli(x).maxCoeff() * system_->coupling;
}

// The same by products at the nodes. Errors of products and transforms are independent there, eps log2 N of their size,
// so 1/sqrt(N) of that on every harmonic; twice that is taken.
void Operator::multiply(const Spectrum& x, Eigen::Index num_rows, bool full, Spectrum& result) {
  const Eigen::Index I = system_->I, P = system_->P;
  // Harmonics reach X+P; what is folded back lands above num_rows when N > X + P + num_rows.
  const Eigen::Index X = x.rows() - 1;
  const Eigen::Index N = fourier::fast_length(std::max({X + P + num_rows + 1, 2 * P + 2, 2 * together}));
  const Nodes& at = nodes(N);
  fourier::RealTransform& fft = fourier::thread_transform(N, I);
  auto spectrum = fft.spectrum();
  spectrum.topRows(X + 1) = x;
  spectrum.bottomRows(N / 2 - X).setZero();
  fft.backward();
  auto samples = fft.samples();
  here_.resize(static_cast<std::size_t>(I));
  if (full) noise_.setZero();
  const Neighbours* E = at.E.data();
  for (Eigen::Index n = 0; n < N; n += together) {
    for (Eigen::Index j = 0; j < I; ++j)
      here_[static_cast<std::size_t>(j)] = samples.col(j).segment<together>(n).array();
    for (Eigen::Index i = 0; i < I; ++i, E += I) {
      Neighbours sum = E[0] * here_[0];
      for (Eigen::Index j = 1; j < I; ++j) sum += E[j] * here_[static_cast<std::size_t>(j)];
      samples.col(i).segment<together>(n) = sum;
      if (!full) continue;
      Neighbours size = (E[0] * here_[0]).abs();
      for (Eigen::Index j = 1; j < I; ++j) size += (E[j] * here_[static_cast<std::size_t>(j)]).abs();
      noise_(i) = std::max(noise_(i), size.maxCoeff());
    }
  }
  if (full) noise_ *= 2 * eps * (2 + std::log2(N)) / std::sqrt(N);
  fft.forward();
  result = fft.spectrum().topRows(num_rows + 1);
  result.row(0).imag().setZero();
}

Spectrum Operator::residual(const Spectrum& x) {
  const Eigen::Index F = system_->f.rows() - 1;
  Spectrum r = Spectrum::Zero(std::max(last_row(), F) + 1, system_->I), product;
  r.topRows(F + 1) = system_->f;
  if ((x.array() == 0.0).all()) {
    noise_.setZero();
    return r;
  }
  couple(x, last_row(), true, product);
  r.topRows(last_row() + 1) -= product;
  r.topRows(H_ + 1) -= D_.cwiseProduct(x);
  return r;
}

double Operator::scaled_norm(const Spectrum& r) const {
  const Eigen::MatrixXd size = moduli(r.topRows(H_ + 1)).cwiseQuotient(magnitude_);
  return std::sqrt(2 * size.squaredNorm() - size.row(0).squaredNorm());
}

// Errors of K: data(i) in all, at worst where |D| is least.
Eigen::VectorXd Operator::rounding(const Spectrum& x) const {
  const Eigen::Index I = system_->I;
  const Eigen::VectorXd data = system_->K_rounding * wiener_norms(x) + system_->f_rounding;
  Eigen::VectorXd result = 8 * eps * wiener_norms(x);
  for (Eigen::Index i = 0; i < I; ++i)
    result(i) += data(i) / magnitude_.col(i).minCoeff() + 2 * noise_(i) * magnitude_.col(i).cwiseInverse().sum();
  return result;
}

double largest_over_turn(const Spectrum& x, Eigen::Index* component) {
  const Eigen::Index H = x.rows() - 1, I = x.cols();
  fourier::RealTransform& fft = fourier::thread_transform(fourier::fast_length(4 * (H + 1)), I);
  auto spectrum = fft.spectrum();
  spectrum.setZero();
  spectrum.topRows(H + 1) = x;
  fft.backward();
  double largest = 0;
  for (Eigen::Index i = 0; i < I; ++i) {
    const double here = fft.samples().col(i).cwiseAbs().maxCoeff();
    if (here > largest) {
      largest = here;
      if (component) *component = i;
    }
  }
  return largest;
}

}  // namespace hb::steady
