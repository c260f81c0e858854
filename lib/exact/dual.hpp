// Forward differentiation in eight directions at once: a value with its derivatives, one vector register.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace hb {

struct Dual {
  using Slopes = Eigen::Array<double, 8, 1>;
  double value = 0;
  Slopes slope = Slopes::Zero();

  Dual() = default;
  Dual(double v) : value(v) {}  // NOLINT(google-explicit-constructor): a constant
  Dual(double v, const Slopes& s) : value(v), slope(s) {}
};

inline Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
inline Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
inline Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.value * b.slope + b.value * a.slope};
}
inline Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.slope}; }
inline Dual operator*(const Dual& a, double b) { return b * a; }
inline Dual operator+(double a, const Dual& b) { return {a + b.value, b.slope}; }
inline Dual operator+(const Dual& a, double b) { return b + a; }
inline Dual operator-(const Dual& a, double b) { return {a.value - b, a.slope}; }
inline Dual operator-(double a, const Dual& b) { return {a - b.value, -b.slope}; }
inline Dual operator/(const Dual& a, const Dual& b) {
  const double inverse = 1 / b.value, quotient = a.value * inverse;
  return {quotient, inverse * (a.slope - quotient * b.slope)};
}
inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.value);
  return {root, 0.5 / root * a.slope};
}

inline double value_of(double a) { return a; }
inline double value_of(const Dual& a) { return a.value; }

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
