#include "hb/engine/exponents/mode_lines.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/constants.hpp"
#include "lib/fourier/split_transform.hpp"

namespace hb {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace mode_lines {

// M x components, of a series cut to what M angles tell apart.
MatrixXd at_angles(const FourierSeries& series, Index M) {
  const Index harmonics = 1 + std::min(series.num_harmonics(), (M - 1) / 2);
  fourier::RealTransform& transform = fourier::thread_transform(M, series.num_components());
  auto spectrum = transform.spectrum();
  spectrum.topRows(harmonics) = series.c.leftCols(harmonics).transpose();
  spectrum.bottomRows(spectrum.rows() - harmonics).setZero();
  transform.backward();
  return transform.samples();
}

// Modes i alone, x_i'' + b_i x_i' + (k_i - r_i) x_i = 0, at M angles: x_i = psi_i^-1/2 e^{-b_i tau/2 +- i int psi_i}.
struct LoneModes {
  VectorXd damping, mean_frequency;  // b, mean psi
  MatrixXd frequency, rate;  // psi; Re x'/x = -b/2 - psi'/(2 psi); M x n
  MatrixXd left_out;  // r
  MatrixXd cosine, sine;  // of int (psi - mean psi)
  MatrixXd weight;  // (2 psi)^-1/2

  Index num_modes() const { return damping.size(); }
  Index num_angles() const { return frequency.rows(); }

  LoneModes part(Index first, Index count) const {
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
};

// psi^2 = k - b^2/4; with u = psi'/(2 psi) this is the phase function of k - r, r = u^2 - u' = 3 u^2 - psi''/(2 psi).
// Empty where a mode does not oscillate all over the turn.
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

// What modes feel beside what they do alone: g_i = sum_j a_ij (z_j + z_-j) + i b_ij (z_j - z_-j).
struct Coupling {
  MatrixXd a, b;  // M x n*n

  Coupling(const LoneModes& modes, const MatrixXd& alpha, const MatrixXd& beta)
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
};

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

// The line of mode l, z_l = 1, order by order (E24). Lines 0..n-1 are those of the modes, n..2n-1 their conjugates.
class Line {
 public:
  Line(const LoneModes& modes, const Coupling& coupling, Index l)
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

  // Re s, with one order more each time.
  double next() {
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

  // Largest |z_j| of the other lines.
  double mixed() const {
    const auto z = z_.samples();
    const Index L = 2 * n_;
    double largest = 0;
    for (Index j = 0; j < L; ++j)
      if (j != l_) largest = std::max(largest, (z.col(j).array().square() + z.col(L + j).array().square()).maxCoeff());
    return std::sqrt(largest);
  }

  // From here on with another coupling.
  void feel(const Coupling& coupling) { coupling_ = &coupling; }

 private:
  // Of int (psi_l -+ psi_j - mean).
  void turn_against() {
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
  void invert() {
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
  void couple() {
    const auto z = z_.samples();
    const Index L = 2 * n_;
    for (const Index part : {Index(0), Index(1)}) {
      sum_.middleCols(n_ * part, n_) = z.middleCols(L * part, n_) + z.middleCols(L * part + n_, n_);
      difference_.middleCols(n_ * part, n_) = z.middleCols(L * part, n_) - z.middleCols(L * part + n_, n_);
    }
    for (Index i = 0; i < n_; ++i) {
      auto re = effect_.col(i).array(), im = effect_.col(n_ + i).array();
      for (Index j = 0; j < n_; ++j) {
        const auto a = coupling_->a.col(i + n_ * j).array(), b = coupling_->b.col(i + n_ * j).array();
        const auto x = a * sum_.col(j).array() - b * difference_.col(n_ + j).array();
        const auto y = a * sum_.col(n_ + j).array() + b * difference_.col(j).array();
        if (j == 0) {
          re = x;
          im = y;
        } else {
          re += x;
          im += y;
        }
      }
    }
  }

  void answer() {
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

  const LoneModes& modes_;
  const Coupling* coupling_;
  Index l_, n_, M_;
  MatrixXd cosine_, sine_;  // M x 2n
  MatrixXd p_re_, p_im_, q_re_, q_im_;  // 2n x (M/2 + 1)
  MatrixXd sum_, difference_, effect_;  // z_j + z_-j, z_j - z_-j, g: n real parts, n imaginary ones
  fourier::SplitTransform z_;  // real parts of the lines, then imaginary ones
};

// The largest of all, and the number of its line.
struct Leading {
  double growth = -HUGE_VAL;
  std::size_t line = 0;
};

Leading next(std::vector<Line>& lines) {
  Leading leading;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double growth = lines[i].next();
    if (!std::isfinite(growth)) return {nan, i};
    if (growth > leading.growth) leading = {growth, i};
  }
  return leading;
}

}  // namespace mode_lines

double GrowthAccuracy::allowed(double change, double rate) const {
  return std::max(of_change * std::abs(change), of_rate * std::max(std::abs(rate), 0.01));
}

struct UncoupledSystems::Impl {
  struct Part {
    Index first;
    mode_lines::LoneModes modes;
    MatrixXd alpha, beta;  // without what the modes alone feel; M x count*count
    mode_lines::Coupling coupling;
  };

  Index M;
  std::optional<mode_lines::LoneModes> modes;
  std::vector<Part> parts;
  std::vector<Index> leading;  // modes that may lead
  std::vector<mode_lines::Line> lines;  // theirs
  std::vector<double> orders;  // the largest growth rate, so far

  Impl(std::span<const PeriodicCoefficients> systems, Index num_angles) : M(num_angles) {
    Index n = 0;
    for (const PeriodicCoefficients& system : systems) n += system.num_modes;
    MatrixXd stiffness(M, n);
    VectorXd damping(n);
    std::vector<MatrixXd> alphas;
    Index first = 0;
    for (const PeriodicCoefficients& system : systems) {
      const Index m = system.num_modes;
      alphas.push_back(mode_lines::at_angles(system.alpha, M));
      for (Index i = 0; i < m; ++i) {
        stiffness.col(first + i) = alphas.back().col(i * (m + 1));
        damping(first + i) = system.beta.c(i * (m + 1), 0).real();
      }
      first += m;
    }
    modes = mode_lines::lone_modes(stiffness, damping);
    if (!modes) return;
    first = 0;
    for (std::size_t r = 0; r < systems.size(); ++r) {
      const Index m = systems[r].num_modes;
      MatrixXd beta = systems[r].beta.c.col(0).real().transpose().replicate(M, 1);
      for (Index i = 0; i < m; ++i) {
        alphas[r].col(i * (m + 1)) = modes->left_out.col(first + i);
        beta.col(i * (m + 1)).setZero();
      }
      mode_lines::LoneModes own = modes->part(first, m);
      mode_lines::Coupling coupling(own, alphas[r], beta);
      parts.push_back({first, std::move(own), std::move(alphas[r]), std::move(beta), std::move(coupling)});
      first += m;
    }
    const double largest = -damping.minCoeff() / 2, least = largest - std::max(std::abs(largest), 0.01);
    for (const Part& part : parts)
      for (Index i = 0; i < part.modes.num_modes(); ++i)
        if (-part.modes.damping(i) / 2 >= least) {
          leading.push_back(part.first + i);
          lines.emplace_back(part.modes, part.coupling, i);
        }
  }

  double linear(std::size_t order) {
    while (orders.size() <= order) orders.push_back(mode_lines::next(lines).growth);
    return orders[order];
  }
};

UncoupledSystems::UncoupledSystems(std::span<const PeriodicCoefficients> parts, Index num_angles)
    : impl_(std::make_unique<Impl>(parts, num_angles)) {}

UncoupledSystems::~UncoupledSystems() = default;

Index UncoupledSystems::num_angles() const { return impl_->M; }

std::optional<GrowthChange> UncoupledSystems::growth(const NormalForm& change, const GrowthAccuracy& accuracy) {
  constexpr std::size_t most_orders = 12;
  // Lines more mixed than that may be locked to each other, which shows in no real part at first: two that are have 1/2
  // at least. The last order changes the answer by less than this part of what is allowed.
  constexpr double most_mixed = 0.3, settled = 0.1;
  if (!impl_->modes) return std::nullopt;
  const mode_lines::LoneModes& modes = *impl_->modes;
  const Index n = modes.num_modes(), M = modes.num_angles();
  const auto coupling_by = [&](const MatrixXd& alpha_samples, const MatrixXd& beta_samples) {
    MatrixXd alpha = mode_lines::at_angles(fourier::analyse(alpha_samples), M),
             beta = mode_lines::at_angles(fourier::analyse(beta_samples), M);
    for (const Impl::Part& part : impl_->parts)
      for (Index m = part.modes.num_modes(), j = 0; j < m; ++j) {
        const Index column = part.first + n * (part.first + j);
        alpha.middleCols(column, m) += part.alpha.middleCols(m * j, m);
        beta.middleCols(column, m) += part.beta.middleCols(m * j, m);
      }
    return mode_lines::Coupling(modes, alpha, beta);
  };
  const mode_lines::Coupling coupling = coupling_by(change.alpha, change.beta);
  std::vector<mode_lines::Line> lines;
  lines.reserve(impl_->leading.size());
  for (const Index l : impl_->leading) lines.emplace_back(modes, coupling, l);

  double last = HUGE_VAL;
  for (std::size_t order = 0; order < most_orders; ++order) {
    const mode_lines::Leading leading = mode_lines::next(lines);
    for (const mode_lines::Line& line : lines)
      if (!(line.mixed() <= most_mixed)) return std::nullopt;
    const double linear = impl_->linear(order), found = leading.growth - linear, moved = std::abs(found - last);
    if (!std::isfinite(found)) return std::nullopt;
    last = found;
    if (!(moved <= settled * accuracy.allowed(found, linear))) continue;
    // The leading line once more, from where it is.
    const auto half = Eigen::seqN(0, change.alpha.cols() / 2, 2);
    const mode_lines::Coupling by_half = coupling_by(change.alpha(Eigen::all, half), change.beta(Eigen::all, half));
    mode_lines::Line& line = lines[leading.line];
    line.feel(by_half);
    line.next();
    return GrowthChange{linear, found, line.next() - impl_->linear(order + 2)};
  }
  return std::nullopt;
}

}  // namespace hb
