#include "hb/engine/exponents/small_matrix.hpp"

#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

template <class Length>
void product(Length n, const double* __restrict A, const double* __restrict B, double* __restrict C) {
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) C[i + j * n] = A[i] * B[j * n];
    for (Index k = 1; k < n; ++k)
      for (Index i = 0; i < n; ++i) C[i + j * n] += A[i + k * n] * B[k + j * n];
  }
}

// x -= beta (v . x) v
template <class Length>
void reflect(Length n, const double* v, double beta, double* x) {
  double dot = 0;
  for (Index i = 0; i < n; ++i) dot += v[i] * x[i];
  dot *= beta;
  for (Index i = 0; i < n; ++i) x[i] -= dot * v[i];
}

// H_k = 1 - beta_k v_k v_k^T turns column k of H_(k-1) .. H_1 A into a multiple of e_k; Q = H_1 .. H_n.
template <class Length>
void householder(Length n, double* A, double* Q, double* V, double* beta) {
  for (Index k = 0; k < n; ++k) {
    double* v = V + k * n;
    double squared = 0;
    for (Index i = 0; i < n; ++i) {
      v[i] = i < k ? 0 : A[i + k * n];
      squared += v[i] * v[i];
    }
    const double norm = std::sqrt(squared), end = v[k] > 0 ? -norm : norm;
    v[k] -= end;
    squared = 0;
    for (Index i = 0; i < n; ++i) squared += v[i] * v[i];
    beta[k] = squared > 0 ? 2 / squared : 0;
    for (Index j = k + 1; j < n; ++j) reflect(n, v, beta[k], A + j * n);
    for (Index i = k; i < n; ++i) A[i + k * n] = 0;
    A[k + k * n] = end;
  }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) Q[i + j * n] = i == j ? 1 : 0;
  for (Index k = n - 1; k >= 0; --k)
    for (Index j = k; j < n; ++j) reflect(n, V + k * n, beta[k], Q + j * n);
}

}  // namespace

void multiply(Index n, const double* A, const double* B, double* C) {
  with_size(n, [&](auto size) { product(size, A, B, C); });
}

void multiply(const MatrixXd& A, const MatrixXd& B, MatrixXd& C) {
  C.resize(A.rows(), A.rows());
  multiply(A.rows(), A.data(), B.data(), C.data());
}

void multiply_columns(const MatrixXd& matrices, Index first, const MatrixXd& B, MatrixXd& C) {
  const Index n = matrices.rows();
  C.resize(n, n);
  multiply(n, matrices.data() + first * n, B.data(), C.data());
}

void orthogonalise(MatrixXd& A, MatrixXd& Q) {
  const Index n = A.rows();
  Q.resize(n, n);
  with_size(n, [&](auto size) {
    if constexpr (std::is_same_v<decltype(size), Index>) {
      std::vector<double> V(static_cast<std::size_t>(n * n)), beta(static_cast<std::size_t>(n));
      householder(size, A.data(), Q.data(), V.data(), beta.data());
    } else {
      constexpr auto count = static_cast<std::size_t>(decltype(size)::value);
      std::array<double, count * count> V;
      std::array<double, count> beta;
      householder(size, A.data(), Q.data(), V.data(), beta.data());
    }
  });
}

}  // namespace hb
