// Another project's view: both libraries through the installed package, the Fourier transform and a scaled system.
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "hb/engine/system/scaled_system.hpp"
#include "hb/lib/fourier/fourier.hpp"

int main() {
  // f(tau) = 1 + cos tau + sin 2 tau: c_0 = 1, c_1 = 1/2, c_2 = -i/2.
  const int N = 16;
  Eigen::MatrixXd samples(1, N);
  for (int j = 0; j < N; ++j) {
    const double tau = 2 * M_PI * j / N;
    samples(0, j) = 1 + std::cos(tau) + std::sin(2 * tau);
  }
  const hb::FourierSeries f = hb::fourier::analyse(samples);
  const double error =
      std::abs(f.c(0, 0) - 1.0) + std::abs(f.c(0, 1) - 0.5) + std::abs(f.c(0, 2) - std::complex<double>(0, -0.5));

  // 4 q'' + 36 q = 0 at Omega = 1.5: w^2 = (36/4)/1.5^2 = 4.
  hb::HillSystem oscillator;
  oscillator.mass = Eigen::MatrixXd::Constant(1, 1, 4);
  oscillator.damping = Eigen::MatrixXd::Zero(1, 1);
  oscillator.stiffness[0] = hb::FourierSeries(Eigen::MatrixXcd::Constant(1, 1, 36));
  const double w2 = hb::scale_system(oscillator, 1.5).mean_diagonal()(0);

  const bool right = error <= 1e-14 && std::abs(w2 - 4) <= 1e-14;
  std::cout << (right ? "right\n" : "wrong\n");
  return right ? EXIT_SUCCESS : EXIT_FAILURE;
}
