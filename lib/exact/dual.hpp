// Forward differentiation in several directions at once: numbers with their derivatives, at several crank angles.
#pragma once

#include <array>
#include <cstddef>

#include "lib/lanes.hpp"

namespace hb {

template <std::size_t n>
struct Dual {
  static constexpr std::size_t directions = n;
  using Slopes = std::array<Lanes, n>;
  Lanes value;
  Slopes slope;

  Dual() = default;
  Dual(const Lanes& v) : value(v) {}  // NOLINT(google-explicit-constructor): a constant

  // value and, in every direction, slope(direction)
  template <class Slope>
  static Dual with(const Lanes& value, const Slope& slope) {
    Dual result(value);
    for (std::size_t d = 0; d < n; ++d) result.slope[d] = slope(d);
    return result;
  }
};

template <std::size_t n>
Dual<n> operator-(const Dual<n>& a) {
  return Dual<n>::with(-a.value, [&](std::size_t d) { return -a.slope[d]; });
}
template <std::size_t n>
Dual<n> operator+(const Dual<n>& a, const Dual<n>& b) {
  return Dual<n>::with(a.value + b.value, [&](std::size_t d) { return a.slope[d] + b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator-(const Dual<n>& a, const Dual<n>& b) {
  return Dual<n>::with(a.value - b.value, [&](std::size_t d) { return a.slope[d] - b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator*(const Dual<n>& a, const Dual<n>& b) {
  return Dual<n>::with(a.value * b.value, [&](std::size_t d) { return a.value * b.slope[d] + b.value * a.slope[d]; });
}
template <std::size_t n>
Dual<n> operator*(const Lanes& a, const Dual<n>& b) {
  return Dual<n>::with(a * b.value, [&](std::size_t d) { return a * b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator*(const Dual<n>& a, const Lanes& b) {
  return b * a;
}
template <std::size_t n>
Dual<n> operator+(const Lanes& a, const Dual<n>& b) {
  return Dual<n>::with(a + b.value, [&](std::size_t d) { return b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator+(const Dual<n>& a, const Lanes& b) {
  return b + a;
}
template <std::size_t n>
Dual<n> operator-(const Dual<n>& a, const Lanes& b) {
  return -b + a;
}
template <std::size_t n>
Dual<n> operator-(const Lanes& a, const Dual<n>& b) {
  return Dual<n>::with(a - b.value, [&](std::size_t d) { return -b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator/(const Dual<n>& a, const Dual<n>& b) {
  const Lanes inverse = 1.0 / b.value, quotient = a.value * inverse;
  return Dual<n>::with(quotient, [&](std::size_t d) { return inverse * (a.slope[d] - quotient * b.slope[d]); });
}
template <std::size_t n>
Dual<n> operator/(const Lanes& a, const Dual<n>& b) {
  const Lanes inverse = 1.0 / b.value, quotient = a * inverse, turned = -(inverse * quotient);
  return Dual<n>::with(quotient, [&](std::size_t d) { return turned * b.slope[d]; });
}
template <std::size_t n>
Dual<n> operator/(const Dual<n>& a, const Lanes& b) {
  return (1.0 / b) * a;
}
template <std::size_t n>
Dual<n> sqrt(const Dual<n>& a) {
  const Lanes root = sqrt(a.value), half = 0.5 / root;
  return Dual<n>::with(root, [&](std::size_t d) { return half * a.slope[d]; });
}

inline const Lanes& value_of(const Lanes& a) { return a; }
template <std::size_t n>
const Lanes& value_of(const Dual<n>& a) {
  return a.value;
}

// A vector of the plane as a complex number x + i y over any scalar (std::complex is for floating-point numbers only).
template <class T>
struct Plane {
  T x{}, y{};
};

template <class T>
Plane<T> operator+(const Plane<T>& a, const Plane<T>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <class T>
Plane<T> operator-(const Plane<T>& a, const Plane<T>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <class T>
Plane<T> operator*(const Plane<T>& a, const Plane<T>& b) {
  return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x};
}
template <class T>
Plane<T> operator*(const T& a, const Plane<T>& b) {
  return {a * b.x, a * b.y};
}
template <class T>
Plane<T> conj(const Plane<T>& a) {
  return {a.x, -a.y};
}
// i a
template <class T>
Plane<T> turned(const Plane<T>& a) {
  return {-a.y, a.x};
}
template <class T>
T norm(const Plane<T>& a) {
  return a.x * a.x + a.y * a.y;
}
// Re(conj(a) b), Im(conj(a) b)
template <class T>
T dot(const Plane<T>& a, const Plane<T>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class T>
T cross(const Plane<T>& a, const Plane<T>& b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace hb
