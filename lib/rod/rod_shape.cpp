// Largest deflection and bending moment over rod and turn, and both at one place and angle as functionals: sums of the
// terms of lib/rod/rod_terms.hpp.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/constants.hpp"
#include "lib/fourier/transpose.hpp"
#include "lib/fourier/waves.hpp"
#include "lib/parts.hpp"
#include "lib/rod/rod.hpp"
#include "lib/rod/rod_functional.hpp"
#include "lib/rod/rod_shapes.hpp"
#include "lib/rod/rod_terms.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"
#include "lib/workspace.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;
using rod_terms::Angles;

constexpr Eigen::Index samples_per_wave = 8;

using fourier::WavesOfFour;

// What the harmonics of T are at an angle: Re and Im of each function side by side, the harmonics down, as many as
// `WavesOfFour` take, of the mean a half.
Eigen::MatrixXd harmonics_down(const FourierSeries& T, Eigen::Index H) {
  constexpr Eigen::Index together = WavesOfFour::Four::SizeAtCompileTime;
  const Eigen::Index count = H + 1;
  Eigen::MatrixXd down((count + together - 1) / together * together, 2 * T.num_components());
  fourier::transpose(parts(T.c).matrix().leftCols(count), down.topRows(count));
  down.bottomRows(down.rows() - count).setZero();
  down.row(0) *= 0.5;
  return down;
}

// sign * F and its derivatives over (s = x/l, tau), F = d^order w/dx^order.
struct Surface {
  const RodShapes& shapes;
  const Eigen::MatrixXd& T;  // harmonics_down
  double l;
  int order;
  double sign;

  struct Jet {
    double F;
    Eigen::Vector2d gradient;
    Eigen::Matrix2d hessian;
  };

  // With e^{ik tau} = c + i s and a + i b = sum of the functions' T_k times their shapes the terms of k are
  //     2 (a c - b s),   -2 k (a s + b c),   -2 k^2 (a c - b s).
  Jet at(double s, double tau) const {
    using Four = WavesOfFour::Four;
    const Eigen::MatrixXd shape = shapes.values(s * l, order, 3);
    Four F = Four::Zero(), F_tau = F, F_tautau = F, F_s = F, F_stau = F, F_ss = F;
    WavesOfFour waves(tau, false);
    for (Eigen::Index first = 0; first < T.rows(); first += F.size(), waves.advance()) {
      Four a0 = Four::Zero(), b0 = a0, a1 = a0, b1 = a0, a2 = a0, b2 = a0;  // with the shapes' derivatives 0 to 2
      for (Eigen::Index i = 0; i < shape.cols(); ++i) {
        const Four re = Four::Map(&T(first, 2 * i)), im = Four::Map(&T(first, 2 * i + 1));
        a0 += shape(0, i) * re;
        b0 += shape(0, i) * im;
        a1 += shape(1, i) * re;
        b1 += shape(1, i) * im;
        a2 += shape(2, i) * re;
        b2 += shape(2, i) * im;
      }
      const Four &cosine = waves.cosines(), &sine = waves.sines(), &k = waves.k();
      const Four here = a0 * cosine - b0 * sine;
      F += here;
      F_tau -= k * (a0 * sine + b0 * cosine);
      F_tautau -= k * k * here;
      F_s += a1 * cosine - b1 * sine;
      F_stau -= k * (a1 * sine + b1 * cosine);
      F_ss += a2 * cosine - b2 * sine;
    }
    const double unit = 2 * sign;
    Jet jet{unit * F.sum(), {unit * l * F_s.sum(), unit * F_tau.sum()}, {}};
    jet.hessian << l * l * F_ss.sum(), l * F_stau.sum(), l * F_stau.sum(), F_tautau.sum();
    jet.hessian *= unit;
    return jet;
  }
};

struct Summit {
  RodPeak peak;
  double curvature;  // over the turn
};

// Newton uphill from a grid point; the Hessian is shifted until it is negative definite and the step rises.
Summit climbed(const Surface& surface, double s, double tau) {
  constexpr double settled = 1e-7;  // a last step, which rises by half of its slope
  Surface::Jet here = surface.at(s, tau);
  double shift = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    end_if_wished();
    const double mean = here.hessian.trace() / 2;
    const double spread = std::hypot((here.hessian(0, 0) - here.hessian(1, 1)) / 2, here.hessian(0, 1));
    const double floor = std::max(0.0, mean + spread + 1e-9 * (std::abs(mean) + spread));
    const Eigen::Matrix2d H = here.hessian - (floor + shift) * Eigen::Matrix2d::Identity();
    const double determinant = H.determinant();
    if (!(determinant > 0)) break;
    const Eigen::Vector2d step = -H.inverse() * here.gradient;
    const double s_next = std::clamp(s + step(0), 0.0, 1.0);
    if (!(step.norm() > settled)) {
      here.F += here.gradient.dot(step) / 2;
      s = s_next;
      tau += step(1);
      break;
    }
    const Surface::Jet next = surface.at(s_next, tau + step(1));
    if (next.F >= here.F) {
      s = s_next;
      tau += step(1);
      here = next;
      shift = shift > 1e-6 * spread ? shift / 10 : 0;
    } else {
      shift = std::max(10 * shift, 0.1 * (std::abs(mean) + spread));
    }
  }
  tau = std::fmod(tau, 2 * pi);
  return {{here.F, s * surface.l, tau < 0 ? tau + 2 * pi : tau}, here.hessian(1, 1)};
}

struct Candidate {
  double size;
  double i, j;  // where the parabolas through its neighbours are highest
  double sign;
};

// Between -1/2 and 1/2: the vertex of the parabola through three samples, the middle one the largest.
double vertex(double before, double here, double after) {
  const double bend = before - 2 * here + after;
  return bend < 0 ? (before - after) / (2 * bend) : 0;
}

// F at angles (down) and places along the rod (across).
struct Grid {
  Eigen::Map<Eigen::MatrixXd> F;
  Eigen::VectorXd highest;  // |F| at each angle

  // From shapes at the places and time functions at the angles.
  Grid(const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& time, Workspace& memory)
      : F(memory.matrix(time.rows(), shapes.rows())), highest(time.rows()) {
    for (Eigen::Index j = 0; j < F.rows(); j += Angles::SizeAtCompileTime) {
      Angles most = Angles::Zero();
      for (Eigen::Index i = 0; i < F.cols(); ++i) {
        const Angles here = rod_terms::sum_at(shapes, i, time, j);
        F.col(i).segment<Angles::SizeAtCompileTime>(j) = here;
        most = most.max(here.abs());
      }
      highest.segment<Angles::SizeAtCompileTime>(j) = most;
    }
  }
};

// Local maxima of |F| whose samples are no lower than `least`; the highest first, by the parabolas through them.
std::vector<Candidate> candidates_of(const Grid& grid, double least) {
  constexpr std::size_t most = 32;
  const Eigen::Index num_x = grid.F.cols() - 1, N = grid.F.rows();
  const auto size = [&grid](Eigen::Index j, Eigen::Index i) { return std::abs(grid.F(j, i)); };
  const auto sign = [&grid](Eigen::Index j, Eigen::Index i) { return grid.F(j, i) > 0 ? 1.0 : -1.0; };
  std::vector<Candidate> candidates;
  for (Eigen::Index j = 0; j < N; ++j) {
    if (!(grid.highest(j) >= least)) continue;
    const Eigen::Index before = j == 0 ? N - 1 : j - 1, after = j == N - 1 ? 0 : j + 1;
    for (Eigen::Index i = 1; i < num_x; ++i) {
      const double here = size(j, i), below = size(j, i - 1), above = size(j, i + 1);
      const double earlier = size(before, i), later = size(after, i);
      if (!(here >= least && here >= below && here >= above && here >= earlier && here > later)) continue;
      const double along = vertex(below, here, above), onward = vertex(earlier, here, later);
      const double top = here + 0.25 * (along * (above - below) + onward * (later - earlier));
      candidates.push_back({top, static_cast<double>(i) + along, static_cast<double>(j) + onward, sign(j, i)});
    }
  }
  if (candidates.empty()) {  // constant in time
    Eigen::Index i, j;
    const double top = grid.F.cwiseAbs().maxCoeff(&j, &i);
    candidates.push_back({top, static_cast<double>(i), static_cast<double>(j), sign(j, i)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.size > b.size; });
  candidates.resize(std::min(candidates.size(), most));
  return candidates;
}

// Bounds of the harmonics of |F| over the rod, k = 1..H, from the largest value of each shape.
Eigen::ArrayXd harmonic_sizes(const Eigen::RowVectorXd& largest, const FourierSeries& T) {
  const auto c = T.c.rightCols(T.num_harmonics());
  return 2 * (largest * (c.real().cwiseAbs() + c.imag().cwiseAbs())).transpose().array();
}

// The fewest harmonics without which bounds of at most `small` are missing.
Eigen::Index harmonics_above(const Eigen::ArrayXd& size, double small) {
  Eigen::Index H = size.size();
  for (double missing = 0; H > 0; --H)
    if (!((missing += size(H - 1)) <= small)) break;
  return H;
}

// Largest |F| over rod and turn: local maxima of a grid with at least 8 points per wave that come within a tenth of the
// best (a wave's top lies at most 8 % above its samples), each climbed. The grid leaves out harmonics that make up a
// small share of F'' over the turn: the more, the flatter the highest one turns out.
RodPeak peak(const rod_terms::ShapeTable& table, const FourierSeries& T, int order) {
  const Eigen::VectorXd& x = table.x;
  const double l = table.length;
  const Eigen::ArrayXd size = harmonic_sizes(order == 0 ? table.largest_deflection : table.largest_curvature, T);
  const Eigen::ArrayXd bend = size * Eigen::ArrayXd::LinSpaced(size.size(), 1, size.size()).square();
  thread_local Workspace surface_values;
  for (double share = 1e-2;; share *= share) {
    Eigen::Index H = size.size();
    double missing = 0;
    while (H > 0 && missing + bend(H - 1) <= share * bend.sum()) missing += bend(--H);
    const Eigen::MatrixXd time =
        rod_terms::over_turn(fourier::resized(T, H), rod_terms::angles_from(samples_per_wave * (H + 1)));
    end_if_wished();
    const Grid grid(order == 0 ? table.deflection : table.curvature, time, surface_values);
    end_if_wished();
    const double top = grid.highest.maxCoeff();
    if (!(top > 0)) return {};
    const Eigen::MatrixXd telling = harmonics_down(T, harmonics_above(size, eps / 2 * top));
    RodPeak best;
    double curvature = 0;
    for (const Candidate& c : candidates_of(grid, 0.9 * top - size.tail(size.size() - H).sum())) {
      const Surface surface{table.shapes, telling, l, order, c.sign};
      const auto [candidate, its_curvature] =
          climbed(surface, c.i / static_cast<double>(x.size() - 1), two_pi * c.j / static_cast<double>(time.rows()));
      if (candidate.max_abs > best.max_abs) {
        best = candidate;
        curvature = its_curvature;
      }
    }
    if (!(missing > 0) || curvature < -2 * missing) return best;
  }
}

// Twice as many as `samples_per_wave` asks for.
Eigen::VectorXd places_along(double l, Eigen::Index I) {
  return Eigen::VectorXd::LinSpaced(std::max<Eigen::Index>(32, samples_per_wave * I) + 1, 0, l);
}

}  // namespace

RodPeak largest_deflection(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q) {
  const Eigen::Index I = q.num_components();
  const rod_terms::ShapeTable& table =
      rod_terms::shape_table(link.length, I, shear_flexibility(link), places_along(link.length, I));
  return peak(table, rod_terms::time_functions(link, rod, speed, q), 0);
}

RodShape rod_shape(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q) {
  const Eigen::Index I = q.num_components();
  const double l = link.length;
  const Eigen::VectorXd x = places_along(l, I);
  const FourierSeries T = rod_terms::time_functions(link, rod, speed, q);
  RodShape result;
  result.deflection = peak(rod_terms::shape_table(l, I, shear_flexibility(link), x), T, 0);
  const rod_terms::ShapeTable& of_moment = rod_terms::shape_table(l, I, 0, x);
  result.bending_moment =
      link.elastic->shear ? peak(of_moment, rod_terms::moment_functions(link, speed, q, T), 2) : peak(of_moment, T, 2);
  result.bending_moment.max_abs *= link.elastic->youngs_modulus * link.elastic->second_moment;
  return result;
}

// With F_n = 1/(1 + in Omega alpha_c), (f q)^(tau) = sum_n F_n e^{in tau} sum_m f_{n-m} q_m: the mean over the turn of
// q with f W, W_n = conj(F_n e^{in tau}).
RodFunctional rod_functional(const Body& link, const RodCoefficients& rod, double speed, Eigen::Index num_modes,
                             Eigen::Index num_harmonics, RodQuantity quantity, double x, double crank_angle) {
  const Eigen::Index I = num_modes;
  const bool moment = quantity == RodQuantity::bending_moment;
  const Eigen::RowVectorXd s =
      (moment ? link.elastic->youngs_modulus * link.elastic->second_moment : 1.0) *
      RodShapes(link.length, I, moment ? 0 : shear_flexibility(link)).values(x, moment ? 2 : 0);
  const FourierSeries f = rod_terms::coefficients_at(rod, speed);
  const Eigen::Index H = num_harmonics + f.num_harmonics(), N = rod_terms::angles_from(2 * H + 2);
  FourierSeries W(1, H), delta(1, num_harmonics);
  for (Eigen::Index n = 0; n <= H; ++n) {
    const Complex wave = std::polar(1.0, -static_cast<double>(n) * crank_angle);
    if (n <= num_harmonics) delta.c(0, n) = wave;
    W.c(0, n) = wave / Complex(1, -static_cast<double>(n) * speed * link.elastic->internal_damping);
  }
  RodFunctional result;
  for (Eigen::Index n = 0; n <= f.num_harmonics(); ++n)
    result.offset += (n > 0 ? 2 : 1) * (std::conj(W.c(0, n)) * (s(I) * f.c(0, n) + s(I + 1) * f.c(1, n))).real();
  const Eigen::MatrixXd samples = fourier::synthesise(f, N);
  const Eigen::RowVectorXd w = fourier::synthesise(W, N).row(0);
  Eigen::MatrixXd products(2, N);
  products.row(0) = samples.row(3).cwiseProduct(w);
  products.row(1) = samples.row(2).cwiseProduct(w);
  const Eigen::MatrixXcd fW = fourier::resized(fourier::analyse(products), num_harmonics).c;
  result.g = FourierSeries(I, num_harmonics);
  for (Eigen::Index k = 0; k < I; ++k)
    result.g.c.row(k) = s(k) * delta.c.row(0) + s(I + 2 + k) * fW.row(0) + s(2 * I + 2 + k) * fW.row(1);
  if (moment && link.elastic->shear)
    for (Eigen::Index n = 0; n <= num_harmonics; ++n)
      result.g.c.col(n).array() +=
          s.head(I).transpose().array() * delta.c(0, n) * (rotation_ratios(link, speed, I, n).conjugate() - 1);
  return result;
}

}  // namespace hb
