#include "hb/engine/exponents/mode_line.hpp"

#include <algorithm>
#include <cmath>

#include "lib/lanes.hpp"

namespace hb::mode_lines {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd at_angles(const FourierSeries& series, Index M) {
  const Index harmonics = 1 + std::min(series.num_harmonics(), (M - 1) / 2);
  fourier::RealTransform& transform = fourier::thread_transform(M, series.num_components());
  auto spectrum = transform.spectrum();
  spectrum.topRows(harmonics) = series.c.leftCols(harmonics).transpose();
  spectrum.bottomRows(spectrum.rows() - harmonics).setZero();
  transform.backward();
  return transform.samples();
}

LoneModes LoneModes::part(Index first, Index count) const {
  const auto columns = [&](const MatrixXd& all) { return all.middleCols(first, count); };
  return {damping.segment(first, count),
          mean_frequency.segment(first, count),
          columns(frequency),
          columns(rate),
          columns(left_out),
          columns(cosine),
          columns(sine),
          columns(weight)};
}

// psi^2 = k - b^2/4; with u = psi'/(2 psi) this is the phase function of k - r, r = u^2 - u' = 3 u^2 - psi''/(2 psi).
std::optional<LoneModes> lone_modes(const MatrixXd& stiffness, const VectorXd& damping) {
  const Index n = damping.size(), M = stiffness.rows();
  const auto b = damping.transpose();
  LoneModes modes;
  modes.damping = damping;
  const MatrixXd squared = stiffness.rowwise() - (b.cwiseAbs2() / 4);
  if (!(squared.minCoeff() > 0)) return std::nullopt;
  modes.frequency = squared.cwiseSqrt();
  modes.weight = (2 * modes.frequency).cwiseInverse().cwiseSqrt();
  modes.mean_frequency = modes.frequency.colwise().mean();

  fourier::SplitTransform psi(M, n), derived(M, 3 * n);  // int psi, psi', psi''
  psi.samples() = modes.frequency;
  psi.forward();
  const auto from_re = psi.re(), from_im = psi.im();
  auto re = derived.re(), im = derived.im();
  for (const Index k : {Index(0), M / 2}) {
    re.col(k).setZero();
    im.col(k).setZero();
  }
  for (Index k = 1; k < M / 2; ++k)
    for (Index i = 0; i < n; ++i) {
      const double order = static_cast<double>(k);
      re(i, k) = from_im(i, k) / order;
      im(i, k) = -from_re(i, k) / order;
      re(n + i, k) = -order * from_im(i, k);
      im(n + i, k) = order * from_re(i, k);
      re(2 * n + i, k) = -order * order * from_re(i, k);
      im(2 * n + i, k) = -order * order * from_im(i, k);
    }
  derived.backward();
  const auto samples = derived.samples();
  modes.cosine = samples.leftCols(n).array().cos();
  modes.sine = samples.leftCols(n).array().sin();
  const MatrixXd u = samples.middleCols(n, n).cwiseQuotient(2 * modes.frequency);
  modes.rate = (-u).rowwise() - b / 2;
  modes.left_out = 3 * u.cwiseAbs2() - samples.rightCols(n).cwiseQuotient(2 * modes.frequency);
  return modes;
}

Coupling::Coupling(const LoneModes& modes, const MatrixXd& alpha, const MatrixXd& beta)
    : a(alpha.rows(), alpha.cols()), b(a.rows(), a.cols()) {
  const Index n = modes.num_modes();
  ArrayXd both(a.rows());
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index q = i + n * j;
      both = modes.weight.col(i).array() * modes.weight.col(j).array();
      a.col(q) = both * (alpha.col(q).array() + beta.col(q).array() * modes.rate.col(j).array());
      b.col(q) = both * beta.col(q).array() * modes.frequency.col(j).array();
    }
}

namespace {

using In = const double* __restrict;
using Out = double* __restrict;

// z <- z e^{i angle}
void turn(Index M, In cosine, In sine, Out re, Out im) {
  for (Index t = 0; t < M; ++t) {
    const double x = re[t], y = im[t];
    re[t] = cosine[t] * x - sine[t] * y;
    im[t] = cosine[t] * y + sine[t] * x;
  }
}

// z <- +-i g - i g_l z
void load(Index M, double sign, In g_re, In g_im, In own_re, In own_im, Out re, Out im) {
  for (Index t = 0; t < M; ++t) {
    const double x = re[t], y = im[t];
    re[t] = own_im[t] * x + own_re[t] * y - sign * g_im[t];
    im[t] = own_im[t] * y - own_re[t] * x + sign * g_re[t];
  }
}

// g_i = sum_j a_ij s_j + i b_ij d_j
void add_up(Index n, Index M, In a, In b, In sum, In difference, Out effect) {
  const Index imaginary = n * M;
  for (Index i = 0; i < n; ++i)
    for (Index t = 0; t < M; t += Lanes::width) {
      Lanes re, im;
      for (Index j = 0; j < n; ++j) {
        const Index q = t + M * (i + n * j), own = t + M * j;
        const Lanes a_ij = Lanes::load(a + q), b_ij = Lanes::load(b + q);
        re += a_ij * Lanes::load(sum + own) - b_ij * Lanes::load(difference + imaginary + own);
        im += a_ij * Lanes::load(sum + imaginary + own) + b_ij * Lanes::load(difference + own);
      }
      re.store(effect + t + M * i);
      im.store(effect + imaginary + t + M * i);
    }
}

}  // namespace

Line::Line(const LoneModes& modes, const Coupling& coupling, Index l)
    : modes_(modes),
      coupling_(&coupling),
      l_(l),
      n_(modes.num_modes()),
      M_(modes.num_angles()),
      cosine_(M_, 2 * n_),
      sine_(M_, 2 * n_),
      sum_(M_, 2 * n_),
      difference_(M_, 2 * n_),
      effect_(M_, 2 * n_),
      z_(M_, 4 * n_) {
  turn_against();
  invert();
  z_.samples().setZero();
  z_.samples().col(l_).setOnes();
}

double Line::next() {
  couple();
  const double growth = -modes_.damping(l_) / 2 - effect_.col(n_ + l_).mean();
  auto z = z_.samples();
  const Index L = 2 * n_;
  for (Index j = 0; j < L; ++j) {
    load(M_, j < n_ ? 1 : -1, &effect_(0, j % n_), &effect_(0, n_ + j % n_), &effect_(0, l_), &effect_(0, n_ + l_),
         &z(0, j), &z(0, L + j));
    turn(M_, &cosine_(0, j), &sine_(0, j), &z(0, j), &z(0, L + j));
  }
  z_.forward();
  answer();
  z_.backward();
  // Back by e^{-i angle} of the conjugate.
  for (Index j = 0; j < L; ++j) turn(M_, &cosine_(0, j), &sine_(0, j), &z(0, L + j), &z(0, j));
  z.col(l_).setOnes();
  return growth;
}

double Line::mixed() const {
  const auto z = z_.samples();
  const Index L = 2 * n_;
  double largest = 0;
  for (Index j = 0; j < L; ++j)
    if (j != l_) largest = std::max(largest, (z.col(j).array().square() + z.col(L + j).array().square()).maxCoeff());
  return std::sqrt(largest);
}

// Of int (psi_l -+ psi_j - mean).
void Line::turn_against() {
  const auto c = modes_.cosine.col(l_).array(), s = modes_.sine.col(l_).array();
  for (Index j = 0; j < n_; ++j) {
    const auto c_j = modes_.cosine.col(j).array(), s_j = modes_.sine.col(j).array();
    cosine_.col(j) = c * c_j + s * s_j;
    sine_.col(j) = s * c_j - c * s_j;
    cosine_.col(n_ + j) = c * c_j - s * s_j;
    sine_.col(n_ + j) = s * c_j + c * s_j;
  }
}

// Of y' + (mu + i nu) y = f, with the real and the imaginary part of y apart, harmonic by harmonic,
//     y_re = p f_re + q f_im,   y_im = -q f_re + p f_im,   p = (mu + ik)/D,   q = nu/D,   D = (mu + ik)^2 + nu^2.
void Line::invert() {
  const Index H = M_ / 2;
  ArrayXd mu(2 * n_), nu(2 * n_), re, im, per;
  mu << modes_.damping, modes_.damping;
  mu = (mu - modes_.damping(l_)) / 2;
  nu << -modes_.mean_frequency, modes_.mean_frequency;
  nu += modes_.mean_frequency(l_);
  for (MatrixXd* of : {&p_re_, &p_im_, &q_re_, &q_im_}) of->resize(2 * n_, H + 1);
  for (Index k = 0; k < H; ++k) {
    const double order = static_cast<double>(k);
    re = mu.square() + nu.square() - order * order;
    im = 2 * order * mu;
    per = 1 / (re.square() + im.square());
    p_re_.col(k) = (mu * re + order * im) * per;
    p_im_.col(k) = (order * re - mu * im) * per;
    q_re_.col(k) = nu * re * per;
    q_im_.col(k) = -nu * im * per;
  }
  for (MatrixXd* of : {&p_re_, &p_im_, &q_re_, &q_im_}) {
    of->col(H).setZero();
    of->row(l_).setZero();
  }
}

// g
void Line::couple() {
  const auto z = z_.samples();
  const Index L = 2 * n_;
  for (const Index part : {Index(0), Index(1)}) {
    sum_.middleCols(n_ * part, n_) = z.middleCols(L * part, n_) + z.middleCols(L * part + n_, n_);
    difference_.middleCols(n_ * part, n_) = z.middleCols(L * part, n_) - z.middleCols(L * part + n_, n_);
  }
  add_up(n_, M_, coupling_->a.data(), coupling_->b.data(), sum_.data(), difference_.data(), effect_.data());
}

void Line::answer() {
  auto re = z_.re(), im = z_.im();
  const Index L = 2 * n_;
  for (Index k = 0; k < re.cols(); ++k) {
    const auto apply = [L](In p_re, In p_im, In q_re, In q_im, Out x_re, Out x_im, Out y_re, Out y_im) {
      for (Index j = 0; j < L; ++j) {
        const double a = x_re[j], b = x_im[j], c = y_re[j], d = y_im[j];
        x_re[j] = p_re[j] * a - p_im[j] * b + q_re[j] * c - q_im[j] * d;
        x_im[j] = p_re[j] * b + p_im[j] * a + q_re[j] * d + q_im[j] * c;
        y_re[j] = p_re[j] * c - p_im[j] * d - q_re[j] * a + q_im[j] * b;
        y_im[j] = p_re[j] * d + p_im[j] * c - q_re[j] * b - q_im[j] * a;
      }
    };
    apply(&p_re_(0, k), &p_im_(0, k), &q_re_(0, k), &q_im_(0, k), &re(0, k), &im(0, k), &re(L, k), &im(L, k));
  }
}

}  // namespace hb::mode_lines
