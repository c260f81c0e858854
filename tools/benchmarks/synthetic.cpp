#include "synthetic.hpp"

#include <cmath>

namespace hb::benchmarks {

HillSystem synthetic(Eigen::Index I) {
  HillSystem s;
  s.mass = Eigen::MatrixXd::Identity(I, I);
  s.damping = Eigen::MatrixXd::Zero(I, I);
  s.stiffness[0] = FourierSeries(I * I, 2);
  s.load[0] = FourierSeries(I, 3);
  for (Eigen::Index i = 0; i < I; ++i) {
    const double w = 2.3 * static_cast<double>(i + 1);
    s.damping(i, i) = 0.02 * w;
    s.stiffness[0].c(i + I * i, 0) = w * w;
    for (Eigen::Index k = 0; k <= 3; ++k) s.load[0].c(i, k) = 1.0 / static_cast<double>((i + 1) * (k + 1));
    for (Eigen::Index j = 0; j < I; ++j)
      for (Eigen::Index k = 1; k <= 2; ++k)
        s.stiffness[0].c(i + I * j, k) +=
            0.05 * 5.29 * static_cast<double>((i + 1) * (j + 1)) / static_cast<double>(k * (1 + std::abs(i - j)));
  }
  return s;
}

}  // namespace hb::benchmarks
