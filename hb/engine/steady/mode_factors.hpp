// Preconditioner of the block Hill system: A without couplings between modes,
//     (M x)_k = D(k) x_k + sum_{0 < |m| <= p} E_m x_{k-m},      |k| <= H,   x_-k = conj x_k,   E_-m = conj E_m,
// for each mode with as many harmonics p of its own coupling as count beside those with others.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "hb/engine/steady/steady_operator.hpp"
#include "lib/lanes.hpp"

namespace hb::steady {

class ModeFactors {
 public:
  explicit ModeFactors(const Operator& A);
  void solve_in_place(Spectrum& x);  // x <- M^-1 x

 private:
  static constexpr Eigen::Index width = Lanes::width;
  // Modes side by side, as many as the machine's vectors hold numbers; lanes that are left repeat the last one.
  struct Complex {
    Lanes re, im;
  };
  // Of harmonics k = H, H-1, ..., -p a row each with columns k+p, ..., k-p of M = L U: left of the diagonal L, whose
  // own is 1, right of it U, on it the inverse of U's. The outermost harmonics are eliminated first, down to p + 1;
  // what this makes of rows -1 .. -p is the conjugate of what it makes of rows 1 .. p.
  struct Band {
    Eigen::Index first = 0, count = 0, p = 0;  // modes first .. first + count - 1
    std::unique_ptr<Complex[]> rows;
    Complex* row(Eigen::Index H, Eigen::Index k) const { return &rows[std::size_t((H - k) * (2 * p + 1) + p)]; }
    Eigen::Index mode(Eigen::Index lane) const { return first + std::min(lane, count - 1); }
  };
  // to(k, x_k of the band's modes), k = 0..H.
  template <class To>
  void gather(const Spectrum& x, const Band& band, const To& to) const;
  // The other way: from(k).
  template <class From>
  void scatter(const From& from, const Band& band, Spectrum& x) const;
  template <class Smallest>
  static Complex regular(const Complex& pivot, const Smallest& smallest);
  void assemble(const Operator& A, Band& band) const;
  void factorise(const Operator& A, Band& band) const;
  void substitute(const Band& band);

  Eigen::Index H_;
  std::vector<Band> bands_;
  std::vector<Complex> unknowns_;  // of one band, harmonics H, H-1, ..., -p
};

}  // namespace hb::steady
