// Several neighbouring numbers of a long list at once, their count known when it is compiled.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace hb::slaving {

template <int width>
using Numbers = Eigen::Array<double, width, 1>;
template <int width>
Eigen::Map<const Numbers<width>> at(const double* numbers) {
  return Eigen::Map<const Numbers<width>>(numbers);
}
template <int width>
Eigen::Map<Numbers<width>> at(double* numbers) {
  return Eigen::Map<Numbers<width>>(numbers);
}

// Calls some(width, first) for all of 0..count - 1, several at once.
template <class Some>
void in_groups(Eigen::Index count, const Some& some) {
  Eigen::Index q = 0;
  const auto next = [&]<int width>(std::integral_constant<int, width> together) {
    if (q + width > count) return false;
    some(together, q);
    q += width;
    return true;
  };
  while (next(std::integral_constant<int, 16>())) {
  }
  next(std::integral_constant<int, 8>());
  next(std::integral_constant<int, 4>());
  next(std::integral_constant<int, 2>());
  next(std::integral_constant<int, 1>());
}

}  // namespace hb::slaving
