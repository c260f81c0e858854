// Deflection and bending moment of an elastic link: kept modes plus the quasi-static tail,
//     w = sum_{i<=I} q_i sin(i pi x/l) + sum_{i>I} p^_i / (i pi/l)^4 sin(i pi x/l),   (1 + alpha_c d/dt) p^ = p,
// p_i the sine coefficients of the load that (3.3) puts on the rod with the kept modes' deflection w_I,
//     p = -f0 - f1 x + [ (f4 + f3 x - f2 x^2/2) w_I' ]' + f2 w_I.
// The tail is the static deflection of a pinned-pinned beam under p^, in closed form, minus its first I sine terms.
// The f4 term has none beyond I. So w is a sum of products of a shape (of x) and a time function:
//     sin(i pi x/l)  q_i,     y_0  f0^,     y_1  f1^,     y_3k  (f3 q_k)^,     y_2k  (f2 q_k)^.
// With shear (lib/README.md (S8)) 1/(i pi/l)^4 becomes 1/(i pi/l)^4 + 1/(S (i pi/l)^2) in w; the bending moment is that
// of the shapes without shear with p_i, the rotation of the sections, in place of q_i.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "lib/constants.hpp"
#include "lib/fourier/transpose.hpp"
#include "lib/fourier/waves.hpp"
#include "lib/rod/rod.hpp"
#include "lib/rod/rod_functional.hpp"
#include "lib/rod/rod_shapes.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"
#include "lib/workspace.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

FourierSeries coefficients_at(const RodCoefficients& rod, double speed) {
  Eigen::Index H = 0;
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  FourierSeries sum(5, H);
  double factor = 1;
  for (const FourierSeries& f : rod.f) {
    if (f.c.size() > 0) sum.c.leftCols(f.c.cols()) += factor * f.c;
    factor *= speed;
  }
  return sum;
}

constexpr Eigen::Index samples_per_wave = 8;

// Angles that transforms are fast for.
Eigen::Index angles_from(Eigen::Index N) {
  constexpr Eigen::Index fewest = 64;
  return fourier::fast_length(std::max(N, fewest));
}

// f_3 q_k, then f_2 q_k, with all of their H harmonics.
Eigen::Map<const Eigen::MatrixXcd> products_with(const FourierSeries& f, const FourierSeries& q, Eigen::Index H) {
  const Eigen::Index I = q.num_components(), N = angles_from(2 * H + 2);
  fourier::RealTransform& factors = fourier::thread_transform(N, I + 2);
  auto spectrum = factors.spectrum();
  spectrum.setZero();
  spectrum.topLeftCorner(f.c.cols(), 2) = f.c.middleRows(2, 2).transpose();
  spectrum.topRightCorner(q.c.cols(), I) = q.c.transpose();
  factors.backward();
  end_if_wished();
  fourier::RealTransform& products = fourier::thread_transform(N, 2 * I);
  const Eigen::MatrixXd samples = factors.samples();  // with two modes both transforms are the same
  for (Eigen::Index k = 0; k < I; ++k) {
    products.samples().col(k) = samples.col(1).cwiseProduct(samples.col(2 + k));
    products.samples().col(I + k) = samples.col(0).cwiseProduct(samples.col(2 + k));
  }
  products.forward();
  end_if_wished();
  return {products.spectrum().data(), N / 2 + 1, 2 * I};
}

// Without harmonics that are rounding in every component.
void drop_rounding(FourierSeries& T) {
  constexpr double rounding = 1e-16;
  const Eigen::Index n = T.num_components();
  const Eigen::ArrayXXd parts =  // real and imaginary ones in turn
      Eigen::Map<const Eigen::ArrayXXd>(reinterpret_cast<const double*>(T.c.data()), 2 * n, T.c.cols()).abs();
  Eigen::ArrayXd floor = parts.rowwise().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) floor.segment<2>(2 * i) = rounding * floor.segment<2>(2 * i).maxCoeff();
  Eigen::Index H = T.num_harmonics();
  while (H > 0 && (parts.col(H) <= floor).all()) --H;
  T.c.conservativeResize(Eigen::NoChange, H + 1);
}

// The time functions beside the shapes of the deflection, in their order.
FourierSeries time_functions(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q) {
  const Eigen::Index I = q.num_components();
  const FourierSeries f = coefficients_at(rod, speed);
  const Eigen::Index H = q.num_harmonics() + f.num_harmonics();
  FourierSeries T;
  T.c.resize(3 * I + 2, H + 1);
  T.c.topRows(I + 2).setZero();
  T.c.topLeftCorner(I, q.c.cols()) = q.c;
  T.c.block(I, 0, 2, f.c.cols()) = f.c.topRows(2);
  T.c.bottomRows(2 * I) = products_with(f, q, H).topRows(H + 1).transpose();
  for (Eigen::Index n = 1; n <= H; ++n)
    T.c.col(n).tail(2 * I + 2) *= 1.0 / Complex(1, static_cast<double>(n) * speed * link.elastic->internal_damping);
  drop_rounding(T);
  return T;
}

// Those beside the shapes of the bending moment: the sections' rotations for q.
FourierSeries moment_functions(const Body& link, double speed, const FourierSeries& q, FourierSeries T) {
  T.c.topRows(q.num_components()) = fourier::resized(rotation_coordinates(link, speed, q), T.num_harmonics()).c;
  return T;
}

Eigen::MatrixXd shape_matrix(const RodShapes& shapes, const Eigen::Ref<const Eigen::VectorXd>& x, int order) {
  Eigen::MatrixXd rows(x.size(), shapes.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) rows.row(j) = shapes.values(x(j), order);
  return rows;
}

// What depends on the shapes and the places along the rod alone.
struct ShapeTable {
  double length;
  Eigen::Index num_modes;
  double flexibility;  // in shear
  Eigen::VectorXd x;
  RodShapes shapes;
  Eigen::MatrixXd deflection, curvature;  // orders 0 and 2 at x
  Eigen::RowVectorXd largest_deflection, largest_curvature;  // of each shape over x

  ShapeTable(double l, Eigen::Index I, double shear, const Eigen::Ref<const Eigen::VectorXd>& places)
      : length(l),
        num_modes(I),
        flexibility(shear),
        x(places),
        shapes(l, I, shear),
        deflection(shape_matrix(shapes, x, 0)),
        curvature(shape_matrix(shapes, x, 2)),
        largest_deflection(deflection.cwiseAbs().colwise().maxCoeff()),
        largest_curvature(curvature.cwiseAbs().colwise().maxCoeff()) {}
};

// Kept by each thread for the rods it met last. Valid until the next call.
const ShapeTable& shape_table(double length, Eigen::Index num_modes, double flexibility,
                              const Eigen::Ref<const Eigen::VectorXd>& x) {
  constexpr std::size_t most = 16;
  thread_local std::deque<ShapeTable> tables;
  for (const ShapeTable& table : tables)
    if (table.length == length && table.num_modes == num_modes && table.flexibility == flexibility &&
        table.x.size() == x.size() && table.x == x)
      return table;
  if (tables.size() == most) tables.pop_front();
  return tables.emplace_back(length, num_modes, flexibility, x);
}

// sign * F and its derivatives over (s = x/l, tau), F = d^order w/dx^order.
struct Surface {
  const RodShapes& shapes;
  const FourierSeries& T;
  double l;
  int order;
  double sign;

  struct Jet {
    double F;
    Eigen::Vector2d gradient;
    Eigen::Matrix2d hessian;
  };

  // With e^{ik tau} = c + i s and T_k = a + i b the terms of k are
  //     2 (a c - b s),   -2 k (a s + b c),   -2 k^2 (a c - b s).
  Jet at(double s, double tau) const {
    const Eigen::Index n = T.num_components(), H = T.num_harmonics();
    Eigen::Matrix<double, Eigen::Dynamic, 6> waves(H + 1, 6);  // 2 c, 2 s, times 1, k, k^2
    waves.row(0) << 1, 0, 0, 0, 0, 0;
    fourier::Waves next(tau);
    for (Eigen::Index j = 1; j <= H; ++j) {
      const double k = static_cast<double>(j);
      const Complex e = 2.0 * next.next();
      waves.row(j) << e.real(), e.imag(), k * e.real(), k * e.imag(), k * k * e.real(), k * k * e.imag();
    }
    const Eigen::Map<const Eigen::MatrixXd> parts(reinterpret_cast<const double*>(T.c.data()), 2 * n, H + 1);
    const Eigen::Matrix<double, Eigen::Dynamic, 6> sums = parts * waves;
    const Eigen::Map<const Eigen::Matrix<Complex, Eigen::Dynamic, 6>> z(reinterpret_cast<const Complex*>(sums.data()),
                                                                        n, 6);
    Eigen::Matrix<double, Eigen::Dynamic, 3> time(n, 3);  // T, T', T''
    time << z.col(0).real() - z.col(1).imag(), -(z.col(3).real() + z.col(2).imag()), z.col(5).imag() - z.col(4).real();
    const Eigen::Matrix3d values = sign * shapes.values(s * l, order, 3) * time;
    const Eigen::RowVector3d F = values.row(0), F_s = l * values.row(1), F_ss = l * l * values.row(2);
    Jet jet{F(0), {F_s(0), F(1)}, {}};
    jet.hessian << F_ss(0), F_s(1), F_s(1), F(2);
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

// Local maxima of |F| over the grid, rod down and turn across, that are no lower than `least`; the highest first.
std::vector<Candidate> candidates_of(const Eigen::Ref<const Eigen::MatrixXd>& F, double least) {
  constexpr std::size_t most = 32;
  const Eigen::Index num_x = F.rows() - 1, N = F.cols();
  const auto size = [&F](Eigen::Index i, Eigen::Index j) { return std::abs(F(i, j)); };
  const auto sign = [&F](Eigen::Index i, Eigen::Index j) { return F(i, j) > 0 ? 1.0 : -1.0; };
  const Eigen::RowVectorXd highest = F.cwiseAbs().colwise().maxCoeff();
  std::vector<Candidate> candidates;
  for (Eigen::Index j = 0; j < N; ++j) {
    if (!(highest(j) >= least)) continue;
    const Eigen::Index before = j == 0 ? N - 1 : j - 1, after = j == N - 1 ? 0 : j + 1;
    for (Eigen::Index i = 1; i < num_x; ++i) {
      const double here = size(i, j), below = size(i - 1, j), above = size(i + 1, j);
      const double earlier = size(i, before), later = size(i, after);
      if (here >= least && here >= below && here >= above && here >= earlier && here > later)
        candidates.push_back({here, static_cast<double>(i) + vertex(below, here, above),
                              static_cast<double>(j) + vertex(earlier, here, later), sign(i, j)});
    }
  }
  if (candidates.empty()) {  // constant in time
    Eigen::Index i, j;
    const double top = F.cwiseAbs().maxCoeff(&i, &j);
    candidates.push_back({top, static_cast<double>(i), static_cast<double>(j), sign(i, j)});
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

// Largest |F| over rod and turn: local maxima of a grid with at least 8 points per wave that come within a tenth of the
// best (a wave's top lies at most 8 % above its samples), each climbed. The grid leaves out harmonics that make up a
// small share of F'' over the turn: the more, the flatter the highest one turns out.
RodPeak peak(const ShapeTable& table, const FourierSeries& T, int order) {
  const Eigen::VectorXd& x = table.x;
  const double l = table.length;
  const Eigen::ArrayXd size = harmonic_sizes(order == 0 ? table.largest_deflection : table.largest_curvature, T);
  const Eigen::ArrayXd bend = size * Eigen::ArrayXd::LinSpaced(size.size(), 1, size.size()).square();
  thread_local Workspace surface_values;
  for (double share = 1e-2;; share *= share) {
    Eigen::Index H = size.size();
    double missing = 0;
    while (H > 0 && missing + bend(H - 1) <= share * bend.sum()) missing += bend(--H);
    const Eigen::MatrixXd time = fourier::synthesise(fourier::resized(T, H), angles_from(samples_per_wave * (H + 1)));
    end_if_wished();
    Eigen::Map<Eigen::MatrixXd> F = surface_values.matrix(x.size(), time.cols());
    F.noalias() = (order == 0 ? table.deflection : table.curvature) * time;
    end_if_wished();
    const double top = F.cwiseAbs().maxCoeff();
    if (!(top > 0)) return {};
    RodPeak best;
    double curvature = 0;
    for (const Candidate& c : candidates_of(F, 0.9 * top - size.tail(size.size() - H).sum())) {
      const Surface surface{table.shapes, T, l, order, c.sign};
      const auto [candidate, its_curvature] =
          climbed(surface, c.i / static_cast<double>(F.rows() - 1), two_pi * c.j / static_cast<double>(F.cols()));
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
  return Eigen::VectorXd::LinSpaced(std::max<Eigen::Index>(48, samples_per_wave * I) + 1, 0, l);
}

}  // namespace

RodPeak largest_deflection(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q) {
  const Eigen::Index I = q.num_components();
  const ShapeTable& table = shape_table(link.length, I, shear_flexibility(link), places_along(link.length, I));
  return peak(table, time_functions(link, rod, speed, q), 0);
}

RodShape rod_shape(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q) {
  const Eigen::Index I = q.num_components();
  const double l = link.length;
  const Eigen::VectorXd x = places_along(l, I);
  const FourierSeries T = time_functions(link, rod, speed, q);
  RodShape result;
  result.deflection = peak(shape_table(l, I, shear_flexibility(link), x), T, 0);
  const ShapeTable& of_moment = shape_table(l, I, 0, x);
  result.bending_moment =
      link.elastic->shear ? peak(of_moment, moment_functions(link, speed, q, T), 2) : peak(of_moment, T, 2);
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
  const FourierSeries f = coefficients_at(rod, speed);
  const Eigen::Index H = num_harmonics + f.num_harmonics(), N = angles_from(2 * H + 2);
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

namespace {

// Time functions at any number N of angles, where a harmonic k looks like k - N and its conjugate like N - k.
Eigen::MatrixXd over_turn(const FourierSeries& functions, Eigen::Index num_samples) {
  const Eigen::Index N = num_samples, n = functions.num_components();
  fourier::RealTransform& transform = fourier::thread_transform(N, n);
  auto spectrum = transform.spectrum();
  spectrum.setZero();
  for (Eigen::Index k = 0; k <= functions.num_harmonics(); ++k) {
    const Eigen::Index m = k % N;
    const auto c = functions.c.col(k).transpose();
    if (k > 0 && (m == 0 || 2 * m == N))
      spectrum.row(m) += 2 * c.real();
    else if (2 * m < N)
      spectrum.row(m) += c;
    else
      spectrum.row(N - m) += c.conjugate();
  }
  transform.backward();
  Eigen::MatrixXd samples(n, N);
  fourier::transpose(transform.samples(), samples);
  return samples;
}

// Of these time functions of the deflection.
MomentAlong moment_along(const Body& link, double speed, const FourierSeries& q, FourierSeries T,
                         Eigen::Index num_samples) {
  if (link.elastic->shear) T = moment_functions(link, speed, q, std::move(T));
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  return
      [shapes = RodShapes(link.length, q.num_components()), time = Eigen::MatrixXd(EJ * over_turn(T, num_samples))](
          const Eigen::Ref<const Eigen::VectorXd>& x) -> Eigen::MatrixXd { return shape_matrix(shapes, x, 2) * time; };
}

}  // namespace

RodField rod_field(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                   const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Index num_samples) {
  const Eigen::Index I = q.num_components();
  const double EJ = link.elastic->youngs_modulus * link.elastic->second_moment;
  const FourierSeries T = time_functions(link, rod, speed, q);
  Eigen::MatrixXd time = over_turn(T, num_samples);
  RodField field;
  field.w = shape_table(link.length, I, shear_flexibility(link), x).deflection * time;
  if (link.elastic->shear) time = over_turn(moment_functions(link, speed, q, T), num_samples);
  time *= EJ;
  field.bending_moment = shape_table(link.length, I, 0, x).curvature * time;
  return field;
}

MomentAlong bending_moment_along(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                                 Eigen::Index num_samples) {
  return moment_along(link, speed, q, time_functions(link, rod, speed, q), num_samples);
}

}  // namespace hb
