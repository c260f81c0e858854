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

// Of four k after each other at a time, afresh every 64.
class WavesOfFour {
 public:
  using Four = Eigen::Array<double, 4, 1>;

  // k = 0 .. 3 at first, or 1 .. 4 `from_one`.
  WavesOfFour(double tau, bool from_one) : tau_(tau), one_(std::polar(1.0, tau)), two_(one_ * one_), k_(0, 1, 2, 3) {
    if (from_one) k_ += 1;
    begin(from_one ? one_ : 1);
  }
  const Four& k() const { return k_; }
  const Four& cosines() const { return c_; }
  const Four& sines() const { return s_; }
  void advance() {
    constexpr Eigen::Index afresh = 64;
    k_ += 4;
    passed_ += 4;
    if (passed_ % afresh == 0) return begin(std::polar(1.0, k_(0) * tau_));
    const std::complex<double> step = two_ * two_;
    const Four turned = step.real() * c_ - step.imag() * s_;
    s_ = step.real() * s_ + step.imag() * c_;
    c_ = turned;
  }

 private:
  void begin(std::complex<double> e) {
    const std::complex<double> e1 = e * one_, e2 = e * two_, e3 = e1 * two_;
    c_ = Four(e.real(), e1.real(), e2.real(), e3.real());
    s_ = Four(e.imag(), e1.imag(), e2.imag(), e3.imag());
  }

  double tau_;
  std::complex<double> one_, two_;
  Four k_, c_, s_;
  Eigen::Index passed_ = 0;
};

}  // namespace hb::fourier
