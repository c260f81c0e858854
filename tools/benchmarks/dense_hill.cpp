#include "dense_hill.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <cstdlib>

namespace hb::benchmarks {

namespace {

using Index = Eigen::Index;

// Block row k = -H..H, block column m:  D(k) delta_km + K_{k-m},  D(k) = -k^2 + i k G.
Eigen::MatrixXcd hill_matrix(const ScaledSystem& system, int H) {
  const Index I = system.num_modes();
  const int P = static_cast<int>(system.K.num_harmonics());
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(I * (2 * H + 1), I * (2 * H + 1));
  for (int k = -H; k <= H; ++k) {
    for (int m = std::max(-H, k - P); m <= std::min(H, k + P); ++m) {
      const Eigen::MatrixXcd K = system.K.c.col(std::abs(k - m)).reshaped(I, I);
      A.block(I * (k + H), I * (m + H), I, I) = k >= m ? K : Eigen::MatrixXcd(K.conjugate());
    }
    auto D = A.block(I * (k + H), I * (k + H), I, I);
    D += std::complex<double>(0, k) * system.G;
    D.diagonal().array() -= static_cast<double>(k) * k;
  }
  return A;
}

}  // namespace

FourierSeries dense_hill_solution(const ScaledSystem& system, int H, int num_refinements) {
  using LongComplex = std::complex<long double>;
  const Index I = system.num_modes();
  Eigen::VectorXcd f = Eigen::VectorXcd::Zero(I * (2 * H + 1));
  for (int k = -H; k <= H; ++k) {
    if (std::abs(k) > system.f.num_harmonics()) continue;
    const Eigen::VectorXcd f_k = system.f.c.col(std::abs(k));
    f.segment(I * (k + H), I) = k >= 0 ? f_k : Eigen::VectorXcd(f_k.conjugate());
  }

  const Eigen::MatrixXcd A = hill_matrix(system, H);
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(A);
  Eigen::VectorXcd x = lu.solve(f);
  for (int i = 0; i < num_refinements; ++i) {
    const auto residual = (f.cast<LongComplex>() - A.cast<LongComplex>() * x.cast<LongComplex>()).eval();
    x += lu.solve(residual.cast<std::complex<double>>());
  }

  FourierSeries q(I, H);
  for (int k = 0; k <= H; ++k) q.c.col(k) = system.load_scale * (system.T * x.segment(I * (k + H), I));
  return q;
}

double relative_error(const FourierSeries& q, const FourierSeries& reference) {
  const Index H = std::max(q.num_harmonics(), reference.num_harmonics());
  const Index N = 8 * (H + 1);
  const Eigen::MatrixXd a = fourier::synthesise(q, N), b = fourier::synthesise(reference, N);
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

double relative_error(const Eigen::MatrixXd& samples, const FourierSeries& reference) {
  const Eigen::MatrixXd q = fourier::synthesise(reference, std::max<Index>(samples.cols(), 1024));
  const Index stride = q.cols() / samples.cols();
  double error = 0;
  for (Index j = 0; j < samples.cols(); ++j)
    error = std::max(error, (q.col(j * stride) - samples.col(j)).cwiseAbs().maxCoeff());
  return error / q.cwiseAbs().maxCoeff();
}

}  // namespace hb::benchmarks
