// Forward differentiation in four directions at once: numbers with their derivatives, at several crank angles.
#pragma once

#include <array>
#include <cstddef>

#include "lib/lanes.hpp"

namespace hb {

struct Dual {
  static constexpr std::size_t directions = 4;
  using Slopes = std::array<Lanes, directions>;
  Lanes value;
  Slopes slope;

  Dual() = default;
  Dual(const Lanes& v) : value(v) {}  // NOLINT(google-explicit-constructor): a constant

  // value and, in every direction, slope(direction)
  template <class Slope>
  static Dual with(const Lanes& value, const Slope& slope) {
    Dual result(value);
    for (std::size_t d = 0; d < directions; ++d) result.slope[d] = slope(d);
    return result;
  }
};

inline Dual operator-(const Dual& a) {
  return Dual::with(-a.value, [&](std::size_t d) { return -a.slope[d]; });
}
inline Dual operator+(const Dual& a, const Dual& b) {
  return Dual::with(a.value + b.value, [&](std::size_t d) { return a.slope[d] + b.slope[d]; });
}
inline Dual operator-(const Dual& a, const Dual& b) {
  return Dual::with(a.value - b.value, [&](std::size_t d) { return a.slope[d] - b.slope[d]; });
}
inline Dual operator*(const Dual& a, const Dual& b) {
  return Dual::with(a.value * b.value, [&](std::size_t d) { return a.value * b.slope[d] + b.value * a.slope[d]; });
}
inline Dual operator*(const Lanes& a, const Dual& b) {
  return Dual::with(a * b.value, [&](std::size_t d) { return a * b.slope[d]; });
}
inline Dual operator*(const Dual& a, const Lanes& b) { return b * a; }
inline Dual operator+(const Lanes& a, const Dual& b) {
  return Dual::with(a + b.value, [&](std::size_t d) { return b.slope[d]; });
}
inline Dual operator+(const Dual& a, const Lanes& b) { return b + a; }
inline Dual operator-(const Dual& a, const Lanes& b) { return -b + a; }
inline Dual operator-(const Lanes& a, const Dual& b) {
  return Dual::with(a - b.value, [&](std::size_t d) { return -b.slope[d]; });
}
inline Dual operator/(const Dual& a, const Dual& b) {
  const Lanes inverse = 1.0 / b.value, quotient = a.value * inverse;
  return Dual::with(quotient, [&](std::size_t d) { return inverse * (a.slope[d] - quotient * b.slope[d]); });
}
inline Dual operator/(const Lanes& a, const Dual& b) {
  const Lanes inverse = 1.0 / b.value, quotient = a * inverse, turned = -(inverse * quotient);
  return Dual::with(quotient, [&](std::size_t d) { return turned * b.slope[d]; });
}
inline Dual operator/(const Dual& a, const Lanes& b) { return (1.0 / b) * a; }
inline Dual sqrt(const Dual& a) {
  const Lanes root = sqrt(a.value), half = 0.5 / root;
  return Dual::with(root, [&](std::size_t d) { return half * a.slope[d]; });
}

inline const Lanes& value_of(const Lanes& a) { return a; }
inline const Lanes& value_of(const Dual& a) { return a.value; }

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
