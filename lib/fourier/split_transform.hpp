// Real FFT of several columns whose spectra lie side by side, real and imaginary parts apart: what is done to one
// harmonic of all columns is work on neighbouring numbers.
#pragma once

#include <Eigen/Core>

#include "lib/fourier/short_transform.hpp"

namespace hb::fourier {

class SplitTransform {
 public:
  // N >= 16 of fast_length.
  SplitTransform(Eigen::Index num_samples, Eigen::Index num_columns);

  // N x n, column per function.
  Eigen::Map<Eigen::MatrixXd> samples() { return {data_.data(), N_, n_}; }
  Eigen::Map<const Eigen::MatrixXd> samples() const { return {data_.data(), N_, n_}; }
  // Rows >= n x (N/2 + 1): of harmonic k of column j at (j, k), normalised. Rows from n on count for nothing.
  Eigen::Map<Eigen::MatrixXd> re() { return {re_data(), rows_, N_ / 2 + 1}; }
  Eigen::Map<Eigen::MatrixXd> im() { return {im_data(), rows_, N_ / 2 + 1}; }
  void forward();  // samples -> re, im; samples are kept
  void backward();  // re, im -> samples; the spectrum is kept

 private:
  double* re_data() { return data_.data() + N_ * n_; }
  double* im_data() { return re_data() + rows_ * (N_ / 2 + 1); }

  Eigen::Index N_, n_, rows_;
  const ShortTransform* short_;  // none: N is too long for it
  Eigen::VectorXd data_;
};

}  // namespace hb::fourier
