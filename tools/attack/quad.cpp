#include "tools/attack/quad.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace hb::attack {

QuadComplex sqrt(QuadComplex z) {
  const Quad size = abs(z);
  if (size == 0) return {};
  const Quad re = sqrtq((size + fabsq(z.re)) / 2), im = fabsq(z.im) / (2 * re);
  if (z.re >= 0) return {re, z.im < 0 ? -im : im};
  return {im, z.im < 0 ? -re : re};
}

QuadMatrix identity(std::size_t n) {
  QuadMatrix A(n, n);
  for (std::size_t i = 0; i < n; ++i) A(i, i) = 1;
  return A;
}

QuadMatrix operator*(const QuadMatrix& A, const QuadMatrix& B) {
  QuadMatrix C(A.rows, B.cols);
  for (std::size_t j = 0; j < B.cols; ++j)
    for (std::size_t k = 0; k < A.cols; ++k) {
      const Quad b = B(k, j);
      if (b == 0) continue;
      for (std::size_t i = 0; i < A.rows; ++i) C(i, j) += A(i, k) * b;
    }
  return C;
}

QuadMatrix transposed(const QuadMatrix& A) {
  QuadMatrix T(A.cols, A.rows);
  for (std::size_t i = 0; i < A.rows; ++i)
    for (std::size_t j = 0; j < A.cols; ++j) T(j, i) = A(i, j);
  return T;
}

QuadMatrix solve(QuadMatrix A, QuadMatrix B) {
  const std::size_t n = A.rows;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (fabsq(A(i, k)) > fabsq(A(pivot, k))) pivot = i;
    if (A(pivot, k) == 0) throw std::runtime_error("reference: singular matrix");
    for (std::size_t j = 0; j < n; ++j) std::swap(A(k, j), A(pivot, j));
    for (std::size_t j = 0; j < B.cols; ++j) std::swap(B(k, j), B(pivot, j));
    for (std::size_t i = k + 1; i < n; ++i) {
      const Quad l = A(i, k) / A(k, k);
      for (std::size_t j = k + 1; j < n; ++j) A(i, j) -= l * A(k, j);
      for (std::size_t j = 0; j < B.cols; ++j) B(i, j) -= l * B(k, j);
    }
  }
  for (std::size_t j = 0; j < B.cols; ++j)
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) B(i, j) -= A(i, k) * B(k, j);
      B(i, j) /= A(i, i);
    }
  return B;
}

QuadMatrix orthogonalise(QuadMatrix& A) {
  const std::size_t n = A.rows;
  QuadMatrix Q = identity(n);
  std::vector<Quad> v(n);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    Quad size = 0;
    for (std::size_t i = k; i < n; ++i) size += A(i, k) * A(i, k);
    size = sqrtq(size);
    if (size == 0) continue;
    const Quad end = A(k, k) > 0 ? -size : size;
    for (std::size_t i = k; i < n; ++i) v[i] = A(i, k);
    v[k] -= end;
    Quad squared = 0;
    for (std::size_t i = k; i < n; ++i) squared += v[i] * v[i];
    if (squared == 0) continue;
    for (std::size_t j = k; j < n; ++j) {
      Quad dot = 0;
      for (std::size_t i = k; i < n; ++i) dot += v[i] * A(i, j);
      dot *= 2 / squared;
      for (std::size_t i = k; i < n; ++i) A(i, j) -= dot * v[i];
    }
    for (std::size_t i = k + 1; i < n; ++i) A(i, k) = 0;
    for (std::size_t r = 0; r < n; ++r) {
      Quad dot = 0;
      for (std::size_t i = k; i < n; ++i) dot += Q(r, i) * v[i];
      dot *= 2 / squared;
      for (std::size_t i = k; i < n; ++i) Q(r, i) -= dot * v[i];
    }
  }
  return Q;
}

namespace {

// Rows (and for a similarity columns) k, k + 1 turned so that (a, b) becomes (r, 0): c real, s complex.
struct Rotation {
  Quad c = 1;
  QuadComplex s;
  Rotation(QuadComplex a, QuadComplex b) {
    const Quad size = hypotq(abs(a), abs(b));
    if (abs(b) == 0) return;
    if (abs(a) == 0) {
      c = 0;
      s = {1, 0};
      return;
    }
    c = abs(a) / size;
    s = (1 / (abs(a) * size)) * (a * conj(b));
  }
};

void from_left(Dense<QuadComplex>& A, const Rotation& g, std::size_t i, std::size_t k, std::size_t first) {
  for (std::size_t j = first; j < A.cols; ++j) {
    const QuadComplex a = A(i, j), b = A(k, j);
    A(i, j) = g.c * a + g.s * b;
    A(k, j) = g.c * b - conj(g.s) * a;
  }
}

void from_right(Dense<QuadComplex>& A, const Rotation& g, std::size_t i, std::size_t k, std::size_t last) {
  for (std::size_t j = 0; j < last; ++j) {
    const QuadComplex a = A(j, i), b = A(j, k);
    A(j, i) = g.c * a + conj(g.s) * b;
    A(j, k) = g.c * b - g.s * a;
  }
}

}  // namespace

std::vector<QuadComplex> eigenvalues(const QuadMatrix& real) {
  const Quad epsilon = scalbnq(1, -112);
  const std::size_t n = real.rows;
  Dense<QuadComplex> A(n, n);
  for (std::size_t i = 0; i < n * n; ++i) A.entries[i] = {real.entries[i], 0};
  // To Hessenberg form.
  for (std::size_t k = 0; k + 2 < n; ++k)
    for (std::size_t i = k + 2; i < n; ++i) {
      const Rotation g(A(k + 1, k), A(i, k));
      from_left(A, g, k + 1, i, 0);
      from_right(A, g, k + 1, i, n);
    }
  std::size_t active = n;
  int iterations = 0;
  while (active > 1) {
    std::size_t low = active - 1;
    while (low > 0 && abs(A(low, low - 1)) > epsilon * (abs(A(low, low)) + abs(A(low - 1, low - 1)))) --low;
    if (low > 0) A(low, low - 1) = {};
    if (low == active - 1) {
      --active;
      iterations = 0;
      continue;
    }
    if (++iterations > 200) throw std::runtime_error("reference: the QR algorithm does not converge");
    // The eigenvalue of the last 2 x 2 block nearer to its corner; now and then an exceptional one.
    const std::size_t e = active - 1;
    const QuadComplex a = A(e - 1, e - 1), b = A(e - 1, e), c = A(e, e - 1), d = A(e, e);
    const QuadComplex half = Quad(0.5) * (a - d), root = sqrt(half * half + b * c);
    const QuadComplex plus = d - b * c / (abs(half + root) > abs(half - root) ? half + root : half - root);
    const QuadComplex shift = iterations % 11 == 10        ? d + QuadComplex{abs(c), 0}
                              : abs(half) + abs(root) == 0 ? d
                                                           : plus;
    for (std::size_t i = low; i < active; ++i) A(i, i) = A(i, i) - shift;
    std::vector<Rotation> turns;
    for (std::size_t k = low; k + 1 < active; ++k) {
      turns.emplace_back(A(k, k), A(k + 1, k));
      from_left(A, turns.back(), k, k + 1, k);
    }
    for (std::size_t k = low; k + 1 < active; ++k) from_right(A, turns[k - low], k, k + 1, std::min(active, k + 2));
    for (std::size_t i = low; i < active; ++i) A(i, i) = A(i, i) + shift;
  }
  std::vector<QuadComplex> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = A(i, i);
  return values;
}

}  // namespace hb::attack
