#include "tools/attack/quad_floquet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace hb::attack {

namespace {

const Quad two_pi = 8 * atanq(1);

// x'' + G x' + K(tau) x = 0, tau in radians of crank angle, x = q.
struct Equation {
  std::size_t I = 0;
  QuadMatrix G;
  std::vector<QuadMatrix> cosine, sine;  // K = sum_k cosine_k cos k tau + sine_k sin k tau
};

QuadMatrix quad(const Eigen::MatrixXd& A) {
  QuadMatrix Q(std::size_t(A.rows()), std::size_t(A.cols()));
  for (std::size_t i = 0; i < Q.entries.size(); ++i) Q.entries[i] = A(Eigen::Index(i));
  return Q;
}

Equation equation(const HillSystem& system, double speed) {
  Equation e;
  e.I = std::size_t(system.num_modes());
  const Quad Omega = speed;
  const QuadMatrix inverse = solve(quad(system.mass), identity(e.I));
  const auto scaled = [](QuadMatrix A, Quad factor) {
    for (Quad& a : A.entries) a *= factor;
    return A;
  };
  e.G = scaled(inverse * quad(system.damping), 1 / Omega);
  Eigen::Index P = 0;
  for (const FourierSeries& part : system.stiffness) P = std::max(P, part.num_harmonics());
  for (Eigen::Index k = 0; k <= P; ++k) {
    QuadMatrix c(e.I, e.I), s(e.I, e.I);
    Quad factor = 1 / (Omega * Omega);
    for (const FourierSeries& part : system.stiffness) {
      if (k < part.c.cols())
        for (std::size_t i = 0; i < e.I * e.I; ++i) {
          c.entries[i] += factor * Quad(part.c(Eigen::Index(i), k).real()) * (k > 0 ? 2 : 1);
          if (k > 0) s.entries[i] -= factor * 2 * Quad(part.c(Eigen::Index(i), k).imag());
        }
      factor *= Omega;
    }
    e.cosine.push_back(inverse * c);
    e.sine.push_back(inverse * s);
  }
  return e;
}

// K's Taylor coefficients at tau: sum_k k^j/j! [c_k cos(k tau + j pi/2) + s_k sin(k tau + j pi/2)].
std::vector<QuadMatrix> taylor(const Equation& e, Quad tau, int order) {
  std::vector<QuadMatrix> K(std::size_t(order), QuadMatrix(e.I, e.I));
  for (std::size_t k = 0; k < e.cosine.size(); ++k) {
    const Quad cosine = cosq(Quad(k) * tau), sine = sinq(Quad(k) * tau);
    Quad power = 1;
    for (int j = 0; j < order; ++j) {
      const Quad c = j % 4 == 0 ? cosine : j % 4 == 1 ? -sine : j % 4 == 2 ? -cosine : sine;
      const Quad s = j % 4 == 0 ? sine : j % 4 == 1 ? cosine : j % 4 == 2 ? -sine : -cosine;
      for (std::size_t i = 0; i < e.I * e.I; ++i)
        K[std::size_t(j)].entries[i] += power * (c * e.cosine[k].entries[i] + s * e.sine[k].entries[i]);
      power *= Quad(k) / (j + 1);
      if (power == 0) break;
    }
  }
  return K;
}

// Maps of (W q, q') over the cells of one turn: (n+2)(n+1) x_(n+2) = -(n+1) G x_(n+1) - sum_j K_j x_(n-j).
std::vector<QuadMatrix> cell_maps(const Equation& e, int cells, int order, Quad start, const std::vector<Quad>& W) {
  const std::size_t I = e.I;
  const Quad h = two_pi / cells;
  std::vector<QuadMatrix> maps;
  for (int n = 0; n < cells; ++n) {
    const std::vector<QuadMatrix> K = taylor(e, start + n * h, order);
    std::vector<QuadMatrix> x(std::size_t(order) + 1, QuadMatrix(I, 2 * I));
    for (std::size_t i = 0; i < I; ++i) x[0](i, i) = x[1](i, I + i) = 1;
    for (int k = 0; k + 2 <= order; ++k) {
      QuadMatrix& next = x[std::size_t(k) + 2];
      next = e.G * x[std::size_t(k) + 1];
      for (Quad& a : next.entries) a *= k + 1;
      for (int j = 0; j <= k; ++j) {
        const QuadMatrix& Kj = K[std::size_t(j)];
        const QuadMatrix& xj = x[std::size_t(k - j)];
        for (std::size_t b = 0; b < 2 * I; ++b)
          for (std::size_t a = 0; a < I; ++a) {
            const Quad factor = xj(a, b);
            if (factor == 0) continue;
            for (std::size_t r = 0; r < I; ++r) next(r, b) += Kj(r, a) * factor;
          }
      }
      for (Quad& a : next.entries) a *= Quad(-1) / ((k + 2) * (k + 1));
    }
    QuadMatrix map(2 * I, 2 * I);
    for (std::size_t b = 0; b < 2 * I; ++b)
      for (std::size_t a = 0; a < I; ++a) {
        Quad q = 0, v = 0;
        for (int k = order; k >= 0; --k) {
          q = q * h + x[std::size_t(k)](a, b);
          if (k > 0) v = v * h + k * x[std::size_t(k)](a, b);
        }
        const Quad by = b < I ? 1 / W[b] : 1;
        map(a, b) = q * W[a] * by;
        map(I + a, b) = v * by;
      }
    maps.push_back(std::move(map));
  }
  return maps;
}

// Q_i R_i = Phi_i Q_(i-1) until leading subspaces that grow apart by more than a factor of twenty return to themselves;
// exponents are those of the products of the diagonal blocks.
std::vector<QuadComplex> exponents(const std::vector<QuadMatrix>& maps) {
  const std::size_t n = maps.front().rows;
  constexpr int most_sweeps = 60;
  const Quad apart = logq(20), settled = 1e-30;
  QuadMatrix Q(n, n);
  for (std::size_t i = 0; i < n; ++i) Q(i % 2 == 0 ? i / 2 : n / 2 + i / 2, i) = 1;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const QuadMatrix start = Q;
    std::vector<QuadMatrix> R;
    std::vector<Quad> logs(n, 0);
    for (const QuadMatrix& map : maps) {
      QuadMatrix A = map * Q;
      Q = orthogonalise(A);
      for (std::size_t i = 0; i < n; ++i) logs[i] += logq(fabsq(A(i, i)) + scalbnq(1, -13000));
      R.push_back(std::move(A));
    }
    const QuadMatrix turned = transposed(start) * Q;
    std::vector<std::size_t> ends;
    bool done = sweep > 0;
    for (std::size_t j = 1; j < n; ++j) {
      if (!(logs[j - 1] - logs[j] > apart)) continue;
      Quad below = 0;
      for (std::size_t c = 0; c < j; ++c)
        for (std::size_t r = j; r < n; ++r) below += turned(r, c) * turned(r, c);
      done = done && sqrtq(below) <= settled;
      ends.push_back(j);
    }
    if (!done) continue;
    ends.push_back(n);
    std::vector<QuadComplex> result;
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      const std::size_t p = end - begin;
      QuadMatrix product = identity(p);
      Quad log_size = 0;
      for (const QuadMatrix& map : R) {
        QuadMatrix block(p, p);
        for (std::size_t i = 0; i < p; ++i)
          for (std::size_t j = 0; j < p; ++j) block(i, j) = map(begin + i, begin + j);
        product = block * product;
        Quad size = 0;
        for (const Quad a : product.entries) size = std::max(size, fabsq(a));
        for (Quad& a : product.entries) a /= size;
        log_size += logq(size);
      }
      QuadMatrix back(p, p);
      for (std::size_t i = 0; i < p; ++i)
        for (std::size_t j = 0; j < p; ++j) back(i, j) = turned(begin + i, begin + j);
      for (const QuadComplex mu : eigenvalues(back * product))
        result.push_back({(logq(abs(mu)) + log_size) / two_pi, atan2q(mu.im, mu.re) / two_pi});
      begin = end;
    }
    return result;
  }
  throw std::runtime_error("reference: the QR sweeps do not settle");
}

}  // namespace

double distance(QuadComplex a, QuadComplex b) {
  const Quad turn = remainderq(a.im - b.im, 1);
  return double(hypotq(a.re - b.re, turn));
}

std::vector<ReferenceExponent> reference_exponents(const HillSystem& system, double speed) {
  const Equation e = equation(system, speed);
  // Fastest rate: of K its largest row in coordinates where mean frequencies are alike, of G the largest row.
  std::vector<Quad> W(e.I);
  for (std::size_t i = 0; i < e.I; ++i) W[i] = fmaxq(1, sqrtq(fabsq(e.cosine[0](i, i))));
  Quad fastest = 1, strongest = 0;
  for (std::size_t i = 0; i < e.I; ++i) {
    Quad stiffness = 0, damping = 0;
    for (std::size_t j = 0; j < e.I; ++j) {
      for (std::size_t k = 0; k < e.cosine.size(); ++k)
        stiffness += sqrtq((fabsq(e.cosine[k](i, j)) + fabsq(e.sine[k](i, j))) *
                           (fabsq(e.cosine[k](j, i)) + fabsq(e.sine[k](j, i))));
      damping += sqrtq(fabsq(e.G(i, j) * e.G(j, i)));
    }
    fastest = fmaxq(fastest, sqrtq(stiffness));
    strongest = fmaxq(strongest, damping);
  }
  // (rate h)^order/order! far below 1e-32.
  constexpr int order = 44;
  const double rate = double(fastest + strongest) + 0.5 * double(e.cosine.size());
  const int cells = int(std::ceil(6.3 * rate / 3)) + 6;
  if (cells > 3000) throw std::runtime_error("reference: too many steps");
  const std::vector<QuadComplex> fine = exponents(cell_maps(e, cells + cells / 4 + 2, order, 0, W));
  const std::vector<QuadComplex> other = exponents(cell_maps(e, cells, order + 4, 2.5, W));
  std::vector<ReferenceExponent> result;
  for (const QuadComplex s : fine) {
    double nearest = HUGE_VAL;
    for (const QuadComplex o : other) nearest = std::min(nearest, distance(s, o));
    result.push_back({s, 10 * nearest + 1e-31});
  }
  std::sort(result.begin(), result.end(),
            [](const ReferenceExponent& a, const ReferenceExponent& b) { return a.s.re > b.s.re; });
  return result;
}

}  // namespace hb::attack
