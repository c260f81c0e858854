#include "lib/fourier/split_transform.hpp"

#include "lib/fourier/fourier.hpp"

namespace hb::fourier {

using Eigen::Index;

SplitTransform::SplitTransform(Index num_samples, Index num_columns)
    : N_(num_samples), n_(num_columns), short_(ShortTransform::of_length(std::size_t(num_samples))) {
  const Index width = Index(ShortTransform::lane_width());
  rows_ = (n_ + width - 1) / width * width;
  data_.resize(N_ * n_ + 2 * rows_ * (N_ / 2 + 1));
  if (rows_ == n_) return;
  re().bottomRows(rows_ - n_).setZero();
  im().bottomRows(rows_ - n_).setZero();
}

void SplitTransform::forward() {
  if (short_) {
    short_->forward(data_.data(), re_data(), im_data(), std::size_t(rows_), 1 / double(N_), std::size_t(n_));
    return;
  }
  RealTransform& transform = thread_transform(N_, n_);
  transform.samples() = samples();
  transform.forward();
  re().topRows(n_) = transform.spectrum().real().transpose();
  im().topRows(n_) = transform.spectrum().imag().transpose();
}

void SplitTransform::backward() {
  if (short_) {
    short_->backward(re_data(), im_data(), std::size_t(rows_), data_.data(), std::size_t(n_));
    return;
  }
  RealTransform& transform = thread_transform(N_, n_);
  transform.spectrum().real() = re().topRows(n_).transpose();
  transform.spectrum().imag() = im().topRows(n_).transpose();
  transform.backward();
  samples() = transform.samples();
}

}  // namespace hb::fourier
