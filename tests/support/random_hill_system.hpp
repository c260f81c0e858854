// Random linear systems with periodic coefficients for stress tests, by families that are hard in different ways.
#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

#include "lib/hill_system.hpp"

namespace hb::stress {

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  double operator()(double from, double to) {
    return from + (to - from) * std::generate_canonical<double, 53>(generator_);
  }
  double power(double from, double to) { return std::pow(10, (*this)(from, to)); }  // of ten
  bool chance(double probability) { return (*this)(0, 1) < probability; }
  Eigen::Index integer(Eigen::Index from, Eigen::Index to) {
    return from + std::min(to - from, Eigen::Index((*this)(0, 1) * double(to - from + 1)));
  }

 private:
  std::mt19937_64 generator_;
};

// HB_STRESS=100 runs a hundred times as many trials; HB_STRESS_SEED=7 other ones.
inline int multiplied(int trials) {
  const char* factor = std::getenv("HB_STRESS");
  return factor ? int(trials * std::max(1.0, std::atof(factor))) : trials;
}
inline std::uint64_t seed() {
  const char* text = std::getenv("HB_STRESS_SEED");
  return text ? std::strtoull(text, nullptr, 10) : 1;
}

enum class Family {
  plain,  // modal damping, decaying symmetric coupling
  stiff,  // internal damping: b/Omega up to 1e5
  full_matrices,  // mass and damping matrices full
  spread_masses,  // masses over twelve decades
  undamped,
  defective,  // a Jordan block in the mean, or critically damped modes
  tongue,  // crank speed next to 2 w_i/k, damping next to the threshold
  combination,  // crank speed next to (w_i +- w_j)/k
  many_harmonics,  // up to 200, decaying slowly
  discontinuous,  // coefficients of jumps, 1/k
  fast,  // w/Omega up to 1e4
  unsymmetric,  // unsymmetric stiffness, gyroscopic damping
  falling,  // negative mean stiffness
  strong,  // modulation beyond the mean
  alike,  // modes alike, in frequency or damping, coupled weakly or not at all
  sparse,  // the first harmonic and one far above: one of them strong, the other a trace
};
constexpr int num_families = 16;

struct Trial {
  HillSystem system;
  double speed = 1;
};

namespace detail {

inline void add(HillSystem& s, Eigen::Index i, Eigen::Index j, Eigen::Index k, std::complex<double> value) {
  s.stiffness[0].c(i + s.num_modes() * j, k) += value;
}

// Mass and damping of the families with full matrices.
inline void couple(Family family, Random& random, HillSystem& s) {
  using Index = Eigen::Index;
  const Index I = s.num_modes();
  if (family == Family::full_matrices)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j < i; ++j) {
        s.mass(i, j) = s.mass(j, i) = random(-0.6, 0.6) / double(I);
        const double size = 0.5 * std::sqrt(s.damping(i, i) * s.damping(j, j)) / double(I);
        s.damping(i, j) = size * random(-1, 1);
        s.damping(j, i) = random.chance(0.7) ? s.damping(i, j) : size * random(-1, 1);
      }
  if (family == Family::unsymmetric)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j < i; ++j) {
        s.damping(i, j) = random.power(-3, 0) * random(-1, 1);
        s.damping(j, i) = -s.damping(i, j);
      }
}

// The speed, at a resonance of the frequencies w (the lowest about w1) or anywhere.
inline double speed_near(Family family, Random& random, const Eigen::VectorXd& w, double w1) {
  using Index = Eigen::Index;
  const Index I = w.size();
  double speed = random.power(-0.3, 0.5);
  const double aside = (random.chance(0.5) ? 1 : -1) * random.power(-8, -1);
  const Index i = random.integer(0, I - 1), j = random.integer(0, I - 1);
  if (family == Family::tongue) speed = 2 * w(i) / double(random.integer(1, 4)) * (1 + aside);
  if (family == Family::combination) {
    const double sum = random.chance(0.6) ? w(i) + w(j) : std::abs(w(i) - w(j));
    if (sum > 0.05 * w1) speed = sum / double(random.integer(1, 2)) * (1 + aside);
  }
  return speed;
}

// Units of the unknowns as far apart as a thousand to one, and back.
inline void spread(Random& random, HillSystem& s) {
  using Index = Eigen::Index;
  const Index I = s.num_modes();
  for (Index r = 0; r < I; ++r) {
    const double scale = random.power(-3, 3);
    s.mass.row(r) *= scale;
    s.mass.col(r) *= scale;
    s.damping.row(r) *= scale;
    s.damping.col(r) *= scale;
    for (Index c = 0; c < I; ++c) {
      s.stiffness[0].c.row(r + I * c) *= scale;
      s.stiffness[0].c.row(c + I * r) *= scale;
    }
  }
}

}  // namespace detail

// One degree of freedom per frequency w_i; time unit such that Omega is about 1, then scaled.
inline Trial random_trial(Family family, Random& random, Eigen::Index most_modes) {
  using Index = Eigen::Index;
  const bool wide = family == Family::many_harmonics || family == Family::discontinuous;
  const bool pair = family == Family::combination || family == Family::alike || family == Family::full_matrices;
  const Index least = pair ? 2 : 1;
  Index I = random.integer(
      least, std::max(least, family == Family::fast || wide ? std::min<Index>(2, most_modes) : most_modes));
  const Index P = wide                       ? random.integer(8, family == Family::many_harmonics ? 200 : 80)
                  : family == Family::sparse ? random.integer(2, 40)
                                             : random.integer(1, 6);
  double modulation = 0.8 * random.power(-3, 0);
  if (family == Family::strong) modulation = random(1, 4);
  const double decay = family == Family::many_harmonics ? random(0.8, 0.97) : random(0.2, 0.7);
  const bool first_strong = family == Family::sparse && random.chance(0.5);
  const double w1 = family == Family::fast ? random.power(1.5, 4) : random.power(-0.7, 1);
  const bool beam = random.chance(0.5);

  Trial trial;
  HillSystem& s = trial.system;
  s.mass = Eigen::MatrixXd::Identity(I, I);
  s.damping = Eigen::MatrixXd::Zero(I, I);
  s.stiffness[0] = FourierSeries(I * I, P);
  Eigen::VectorXd w(I);
  const double zeta = random.power(-5, -0.3), internal = family == Family::stiff ? random.power(-3, 1) : 0;
  const double shared = random.power(-4, -1);
  for (Index i = 0; i < I; ++i) {
    w(i) = w1 * double(beam ? (i + 1) * (i + 1) : i + 1) * random(0.9, 1.1);
    if (family == Family::alike) w(i) = random.chance(0.5) ? w1 : w1 * (1 + random.power(-14, -1));
    s.damping(i, i) = 2 * zeta * w(i) + internal * w(i) * w(i) / w1;
    if (family == Family::stiff) s.damping(i, i) = std::min(s.damping(i, i), 1e5);
    if (family == Family::alike || family == Family::tongue || family == Family::combination) s.damping(i, i) = shared;
    if (family == Family::undamped) s.damping(i, i) = 0;
    if (family == Family::defective && i % 2 == 0) s.damping(i, i) = 2 * w(i);
  }
  for (Index i = 0; i < I; ++i)
    detail::add(s, i, i, 0, family == Family::falling && i == 0 ? -w(i) * w(i) : w(i) * w(i));
  if (family == Family::defective && I > 1) {
    detail::add(s, 1, 1, 0, w(0) * w(0) - w(1) * w(1));
    s.damping(1, 1) = s.damping(0, 0);
    detail::add(s, 0, 1, 0, w(0) * w(0) * random(-1, 1));
  }
  for (Index k = 1; k <= P; ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j <= i; ++j) {
        double size = modulation * w(i) * w(j) / double(1 + i - j) * std::pow(decay, double(k));
        if (family == Family::discontinuous) size = modulation * w(i) * w(j) / double(k);
        if (family == Family::sparse) {
          const double trace = first_strong ? random.power(-4, -1.5) : random.power(-12, -2);
          size = modulation * w(i) * w(j) / double(1 + i - j);
          size *= k == (first_strong ? 1 : P) ? 1 : k == 1 || k == P ? trace : 0;
        }
        if (family == Family::alike && i != j) size *= random.chance(0.5) ? 0 : random.power(-6, 0);
        const std::complex<double> value(0.5 * size * random(-1, 1), 0.5 * size * random(-1, 1));
        detail::add(s, i, j, k, value);
        if (i != j) detail::add(s, j, i, k, family == Family::unsymmetric ? value * random(-2, 2) : value);
      }
  detail::couple(family, random, s);
  trial.speed = detail::speed_near(family, random, w, w1);
  if (family == Family::spread_masses) detail::spread(random, s);
  // Time unit: 1 to 100 000 rpm.
  const double unit = random.power(-1, 4) / trial.speed;
  trial.speed *= unit;
  s.damping *= unit;
  s.stiffness[0].c *= unit * unit;
  return trial;
}

}  // namespace hb::stress
