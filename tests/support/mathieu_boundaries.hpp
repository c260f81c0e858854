// Characteristic values of Mathieu's equation x'' + (a - 2 q cos 2t) x = 0 in long double: eigenvalues of the symmetric
// tridiagonal matrices of its Fourier recurrences, by bisection on Sturm's count.
#pragma once

#include <cmath>
#include <vector>

namespace hb::reference {

class MathieuMatrix {
 public:
  // Solutions even or odd in t, of period pi or (`half`) antiperiodic in pi.
  MathieuMatrix(bool even, bool half, long double q) {
    const int size = 60 + int(std::sqrt(q));
    for (int k = 0; k < size; ++k) {
      const long double n = half ? 2 * k + 1 : (even ? 2 * k : 2 * k + 2);
      diagonal_.push_back(n * n);
      coupling2_.push_back(q * q);
    }
    if (half) diagonal_[0] += even ? q : -q;
    if (even && !half) coupling2_[0] = 2 * q * q;
  }
  // Eigenvalue number `index`, ascending from 0.
  long double eigenvalue(int index) const {
    long double low = -1e5L, high = 1e5L;
    for (int step = 0; step < 120; ++step) {
      const long double middle = (low + high) / 2;
      (below(middle) > index ? high : low) = middle;
    }
    return (low + high) / 2;
  }

 private:
  int below(long double a) const {
    int count = 0;
    long double pivot = diagonal_[0] - a;
    for (std::size_t k = 0;;) {
      if (pivot < 0) ++count;
      if (++k == diagonal_.size()) return count;
      pivot = diagonal_[k] - a - coupling2_[k - 1] / (pivot == 0 ? 1e-4900L : pivot);
    }
  }
  std::vector<long double> diagonal_, coupling2_;
};

// a_m and b_m of the usual notation: motion is stable between a_m and b_{m+1}, unstable between b_m and a_m.
inline long double mathieu_a(int m, long double q) { return MathieuMatrix(true, m % 2 == 1, q).eigenvalue(m / 2); }
inline long double mathieu_b(int m, long double q) {
  return MathieuMatrix(false, m % 2 == 1, q).eigenvalue((m - 1) / 2);
}

}  // namespace hb::reference
