#include "hb/engine/steady/mode_factors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

// Harmonics p of mode i's own coupling: with D(n) the smallest, sum_{|m| > p} |E_m| is small beside |D(n)
// D(n+p+1)|^1/2.
Index own_harmonics(const Operator& A, Index i) {
  // Couplings between the modes of a slender rod are as large.
  constexpr double small = 0.02;
  constexpr Index most = 16;
  const WeightedSystem& s = A.system();
  const auto& D = A.D();
  const Index H = A.num_harmonics(), top = std::min({H, s.P, most}), entry = i * (s.I + 1);
  Index n = 0;
  for (Index k = 1; k <= H; ++k)
    if (std::norm(D(k, i)) < std::norm(D(n, i))) n = k;
  const double least = std::max(modulus(D(n, i)), 1e-8 * A.magnitude()(n, i));
  double rest = 2 * moduli(s.K.row(entry).rightCols(s.P - top)).sum();
  Index p = top;
  for (; p > 0; --p) {
    rest += 2 * modulus(s.K(entry, p));
    const double beside = n + p <= H ? modulus(D(n + p, i)) : A.magnitude()(H, i);
    if (!(rest <= small * std::sqrt(least * beside))) break;
  }
  return p;
}

}  // namespace

ModeFactors::ModeFactors(const Operator& A) : H_(A.num_harmonics()) {
  const Index I = A.num_modes();
  Index most = 0;
  for (Index first = 0; first < I; first += Lanes::width) {
    end_if_wished();
    Band& band = bands_.emplace_back();
    band.first = first;
    band.count = std::min(Lanes::width, I - first);
    for (Index i = first; i < first + band.count; ++i) band.p = std::max(band.p, own_harmonics(A, i));
    most = std::max(most, band.p);
    assemble(A, band);
    factorise(A, band);
  }
  unknowns_.resize(std::size_t(H_ + 1 + most));
}

// Of a mode's column a vector holds the numbers of `together` harmonics, those of all lanes make a square.
template <class To>
void ModeFactors::gather(const Spectrum& x, const Band& band, const To& to) const {
  constexpr Index together = width / 2;
  static_assert(width % 2 == 0);
  std::array<const double*, std::size_t(width)> columns;
  for (Index c = 0; c < width; ++c)
    columns[std::size_t(c)] = reinterpret_cast<const double*>(x.col(band.mode(c)).data());
  Index k = 0;
  for (; k + together <= H_ + 1; k += together) {
    Lanes numbers[width];
    for (Index c = 0; c < width; ++c) numbers[c] = Lanes::load(columns[std::size_t(c)] + 2 * k);
    transpose(numbers);
    for (Index j = 0; j < together; ++j) to(k + j, Complex{numbers[2 * j], numbers[2 * j + 1]});
  }
  for (; k <= H_; ++k)
    to(k, Complex{Lanes::of([&](Index c) { return columns[std::size_t(c)][2 * k]; }),
                  Lanes::of([&](Index c) { return columns[std::size_t(c)][2 * k + 1]; })});
}

template <class From>
void ModeFactors::scatter(const From& from, const Band& band, Spectrum& x) const {
  constexpr Index together = width / 2;
  std::array<double*, std::size_t(width)> columns;
  for (Index c = 0; c < width; ++c) columns[std::size_t(c)] = reinterpret_cast<double*>(x.col(band.mode(c)).data());
  Index k = 0;
  for (; k + together <= H_ + 1; k += together) {
    Lanes numbers[width];
    for (Index j = 0; j < together; ++j) {
      numbers[2 * j] = from(k + j).re;
      numbers[2 * j + 1] = from(k + j).im;
    }
    transpose(numbers);
    for (Index c = 0; c < band.count; ++c) numbers[c].store(columns[std::size_t(c)] + 2 * k);
  }
  for (; k <= H_; ++k) {
    const Lanes::Values re = from(k).re.values(), im = from(k).im.values();
    for (std::size_t c = 0; c < std::size_t(band.count); ++c) {
      columns[c][2 * k] = re[c];
      columns[c][2 * k + 1] = im[c];
    }
  }
}

void ModeFactors::assemble(const Operator& A, Band& band) const {
  const WeightedSystem& s = A.system();
  const Index p = band.p;
  band.rows = std::make_unique_for_overwrite<Complex[]>(std::size_t((H_ + 1 + p) * (2 * p + 1)));
  std::vector<Complex> E(std::size_t(2 * p + 1));
  for (Index m = 1; m <= p; ++m) {
    const auto K = [&](Index c) { return s.K(band.mode(c) * (s.I + 1), m); };
    const Complex here{Lanes::of([&](Index c) { return K(c).real(); }),
                       Lanes::of([&](Index c) { return K(c).imag(); })};
    E[std::size_t(p + m)] = here;
    E[std::size_t(p - m)] = {here.re, -here.im};
  }
  const auto put = [&](Index k, const Complex& D) {
    Complex* const row = band.row(H_, k);
    std::copy(E.begin(), E.end(), row - p);
    *row = D;
  };
  gather(A.D(), band, [&](Index k, const Complex& D) {
    put(k, D);
    if (k > 0 && k <= p) put(-k, {D.re, -D.im});
  });
}

// What is no larger than smallest(lane) makes place for that.
template <class Smallest>
ModeFactors::Complex ModeFactors::regular(const Complex& pivot, const Smallest& smallest) {
  Lanes::Values re = pivot.re.values(), im = pivot.im.values();
  for (std::size_t c = 0; c < re.size(); ++c) {
    const double least = smallest(Index(c));
    if (re[c] * re[c] + im[c] * im[c] > least * least) continue;
    re[c] = least;
    im[c] = 0;
  }
  return {Lanes::load(re.data()), Lanes::load(im.data())};
}

// Without exchange of rows; a pivot that vanishes to rounding is replaced by one of that size.
void ModeFactors::factorise(const Operator& A, Band& band) const {
  const Index p = band.p;
  for (Index k = H_; k >= -p; --k) {
    if (k == p)
      for (Index l = 1; l <= p; ++l)
        for (Index m = 1; m <= p; ++m) {
          const Complex& image = band.row(H_, l)[l - m];
          band.row(H_, -l)[m - l] = {image.re, -image.im};
        }
    Complex* const row = band.row(H_, k);
    const Complex pivot = regular(*row, [&](Index c) { return eps * A.magnitude()(std::abs(k), band.mode(c)); });
    const Lanes square = pivot.re * pivot.re + pivot.im * pivot.im;
    *row = {pivot.re / square, -pivot.im / square};
    const Index count = std::min(p, k + p);
    for (Index j = 1; j <= count; ++j) {
      Complex* const other = band.row(H_, k - j) - j;
      *other = {other->re * row->re - other->im * row->im, other->re * row->im + other->im * row->re};
      const Lanes re = other->re, im = other->im;
      for (Index l = 1; l <= count; ++l) {
        other[l].re -= re * row[l].re;
        other[l].re += im * row[l].im;
        other[l].im -= re * row[l].im;
        other[l].im -= im * row[l].re;
      }
    }
  }
}

void ModeFactors::substitute(const Band& band) {
  const Index p = band.p;
  Complex* const x = &unknowns_[std::size_t(H_)];  // of harmonic k at -k
  // Of row k what the unknowns from `first` to `last` places away leave, on one side or the other.
  const auto reduced = [&](Index k, Index first, Index last, Index side) {
    const Complex* const a = band.row(H_, k);
    Complex sum = x[-k];
    for (Index j = first; j <= last; ++j) {
      const Complex &factor = a[side * j], &other = x[-k + side * j];
      sum.re -= factor.re * other.re;
      sum.re += factor.im * other.im;
      sum.im -= factor.re * other.im;
      sum.im -= factor.im * other.re;
    }
    return sum;
  };
  for (Index k = H_; k > p; --k) x[-k] = reduced(k, 1, std::min(p, H_ - k), -1);
  for (Index k = 1; k <= p; ++k) {
    x[-k] = reduced(k, p + 1 - k, std::min(p, H_ - k), -1);
    x[k] = {x[-k].re, -x[-k].im};
  }
  for (Index k = p; k >= -p; --k) x[-k] = reduced(k, 1, std::min(p, p - k), -1);
  for (Index k = -p; k <= H_; ++k) {
    const Complex* row = band.row(H_, k);
    const Complex sum = reduced(k, 1, std::min(p, k + p), 1);
    x[-k] = {sum.re * row->re - sum.im * row->im, sum.re * row->im + sum.im * row->re};
  }
}

void ModeFactors::solve_in_place(Spectrum& x) {
  Complex* const unknowns = &unknowns_[std::size_t(H_)];
  for (const Band& band : bands_) {
    gather(x, band, [&](Index k, const Complex& rhs) { unknowns[-k] = rhs; });
    substitute(band);
    unknowns[0].im = 0;
    scatter([&](Index k) -> const Complex& { return unknowns[-k]; }, band, x);
  }
}

}  // namespace hb::steady
