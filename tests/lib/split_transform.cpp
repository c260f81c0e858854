// Spectra that lie side by side against those of one column after the other.
#include "lib/fourier/split_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/fourier/fourier.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using hb::fourier::SplitTransform;

MatrixXd functions(Index N, Index n) {
  return MatrixXd::NullaryExpr(N, n,
                               [](Index t, Index j) { return std::sin(double((t + 1) * (t + 3 * j + 2) % 1009)); });
}

SplitTransform transformed(const MatrixXd& f) {
  SplitTransform split(f.rows(), f.cols());
  split.samples() = f;
  split.forward();
  return split;
}

// 8192 is too long for the short transform, 5 and 9 columns fill no vector of 4 or 8.
constexpr Index split_lengths[] = {32, 48, 64, 96, 128, 192, 1024, 4096, 8192},
                split_columns[] = {1, 3, 4, 5, 8, 9, 16};

TEST(SplitTransform, SpectraAreThoseOfEachColumn) {
  for (const Index N : split_lengths)
    for (const Index n : split_columns) {
      const MatrixXd f = functions(N, n);
      SplitTransform split = transformed(f);
      hb::fourier::RealTransform one(N, 1);
      for (Index j = 0; j < n; ++j) {
        one.samples() = f.col(j);
        one.forward();
        const Eigen::VectorXcd c = one.spectrum();
        const double rounding = 4e-16 * std::log2(double(N)) * f.col(j).norm() / std::sqrt(double(N));
        EXPECT_LE((split.re().row(j).transpose() - c.real()).cwiseAbs().maxCoeff(), rounding) << N << " " << n;
        EXPECT_LE((split.im().row(j).transpose() - c.imag()).cwiseAbs().maxCoeff(), rounding) << N << " " << n;
      }
    }
}

TEST(SplitTransform, BackwardUndoesForwardAndKeepsTheSpectrum) {
  for (const Index N : split_lengths)
    for (const Index n : split_columns) {
      const MatrixXd f = functions(N, n);
      SplitTransform split = transformed(f);
      const MatrixXd re = split.re(), im = split.im();
      split.samples().setZero();
      split.backward();
      EXPECT_LE((split.samples() - f).cwiseAbs().maxCoeff(), 1e-15 * std::log2(double(N)) * std::sqrt(double(N)));
      EXPECT_EQ(MatrixXd(split.re()), re);
      EXPECT_EQ(MatrixXd(split.im()), im);
    }
}

}  // namespace
