// Transposes in blocks: columns whose distance is a power of two would drive each other out of the cache.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of vector types as arguments of templates

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
  using Vector = Eigen::internal::packet_traits<double>::type;
  constexpr Eigen::Index width = Eigen::internal::packet_traits<double>::size;
  const Eigen::Index rows = from.rows() / width * width, cols = from.cols() / width * width;
  Eigen::internal::PacketBlock<Vector, static_cast<int>(width)> block;
  for (Eigen::Index i = 0; i < rows; i += width)
    for (Eigen::Index j = 0; j < cols; j += width) {
      for (Eigen::Index c = 0; c < width; ++c)
        block.packet[c] = Eigen::internal::ploadu<Vector>(&from.coeffRef(i, j + c));
      Eigen::internal::ptranspose(block);
      for (Eigen::Index c = 0; c < width; ++c) Eigen::internal::pstoreu(&to.coeffRef(j, i + c), block.packet[c]);
    }
  transpose_singly(from.rightCols(from.cols() - cols), to.bottomRows(from.cols() - cols));
  transpose_singly(from.bottomLeftCorner(from.rows() - rows, cols), to.topRightCorner(cols, from.rows() - rows));
}

}  // namespace hb::fourier

#pragma GCC diagnostic pop
