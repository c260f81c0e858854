// Transposes in blocks: columns whose distance is a power of two would drive each other out of the cache.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "lib/lanes.hpp"

namespace hb::fourier {

// to = from^T, a number at a time.
template <class From, class To>
void transpose_singly(const From& from, To&& to) {
  if (from.cols() == 1) {
    to.row(0) = from.col(0).transpose();
    return;
  }
  constexpr Eigen::Index tile = 8;
  for (Eigen::Index first = 0; first < from.rows(); first += tile) {
    const Eigen::Index end = std::min(first + tile, from.rows());
    for (Eigen::Index j = 0; j < from.cols(); ++j)
      for (Eigen::Index i = first; i < end; ++i) to(j, i) = from(i, j);
  }
}

// Of real numbers, as many at once as the machine's vectors hold.
inline void transpose(const Eigen::Ref<const Eigen::MatrixXd>& from, Eigen::Ref<Eigen::MatrixXd> to) {
  constexpr Eigen::Index width = Lanes::width;
  const Eigen::Index rows = from.rows() / width * width, cols = from.cols() / width * width;
  Lanes block[width];
  for (Eigen::Index i = 0; i < rows; i += width)
    for (Eigen::Index j = 0; j < cols; j += width) {
      for (Eigen::Index c = 0; c < width; ++c) block[c] = Lanes::load(&from.coeffRef(i, j + c));
      transpose(block);
      for (Eigen::Index c = 0; c < width; ++c) block[c].store(&to.coeffRef(j, i + c));
    }
  transpose_singly(from.rightCols(from.cols() - cols), to.bottomRows(from.cols() - cols));
  transpose_singly(from.bottomLeftCorner(from.rows() - rows, cols), to.topRightCorner(cols, from.rows() - rows));
}

}  // namespace hb::fourier
