// Numbers of 113 bits (GCC's __float128) and the little linear algebra that the reference needs.
#pragma once

#include <quadmath.h>

#include <cstddef>
#include <vector>

namespace hb::attack {

__extension__ using Quad = __float128;

// re + i im; std::complex is specified for the standard types only.
struct QuadComplex {
  Quad re = 0, im = 0;
};
inline QuadComplex operator+(QuadComplex a, QuadComplex b) { return {a.re + b.re, a.im + b.im}; }
inline QuadComplex operator-(QuadComplex a, QuadComplex b) { return {a.re - b.re, a.im - b.im}; }
inline QuadComplex operator*(QuadComplex a, QuadComplex b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline QuadComplex operator*(Quad a, QuadComplex b) { return {a * b.re, a * b.im}; }
inline QuadComplex conj(QuadComplex a) { return {a.re, -a.im}; }
inline Quad abs(QuadComplex a) { return hypotq(a.re, a.im); }
inline QuadComplex operator/(QuadComplex a, QuadComplex b) {
  const Quad size = b.re * b.re + b.im * b.im;
  return (1 / size) * (a * conj(b));
}
QuadComplex sqrt(QuadComplex z);

// Dense, column-major.
template <class Number>
struct Dense {
  std::size_t rows = 0, cols = 0;
  std::vector<Number> entries;

  Dense() = default;
  Dense(std::size_t m, std::size_t n) : rows(m), cols(n), entries(m * n, Number{}) {}
  Number& operator()(std::size_t i, std::size_t j) { return entries[i + rows * j]; }
  const Number& operator()(std::size_t i, std::size_t j) const { return entries[i + rows * j]; }
};
using QuadMatrix = Dense<Quad>;

QuadMatrix identity(std::size_t n);
QuadMatrix operator*(const QuadMatrix& A, const QuadMatrix& B);
QuadMatrix transposed(const QuadMatrix& A);
// X with A X = B, by elimination with pivots.
QuadMatrix solve(QuadMatrix A, QuadMatrix B);
// A = Q R by Householder reflections; A becomes R.
QuadMatrix orthogonalise(QuadMatrix& A);
// Eigenvalues by the complex QR algorithm with Wilkinson's shifts (Golub & Van Loan, Matrix Computations, 7.5).
std::vector<QuadComplex> eigenvalues(const QuadMatrix& A);

}  // namespace hb::attack
