// Powers of e^{i tau}, for sums of Fourier series at one angle.
#pragma once

#include <Eigen/Core>
#include <complex>

namespace hb::fourier {

// e^{i k tau}, k = 1, 2, ..., by multiplication, afresh every 16: 16 roundings at most.
class Waves {
 public:
  explicit Waves(double tau) : tau_(tau), step_(std::polar(1.0, tau)) {}
  std::complex<double> next() {
    ++k_;
    power_ = k_ % 16 == 0 ? std::polar(1.0, static_cast<double>(k_) * tau_) : power_ * step_;
    return power_;
  }

 private:
  double tau_;
  std::complex<double> step_, power_ = 1;
  Eigen::Index k_ = 0;
};

}  // namespace hb::fourier
