#include "tools/attack/families.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "hb/engine/exponents/stability.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb::attack {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;
using stress::Random;

// Modes of frequencies w, masses 1, P harmonics, still without anything that varies.
HillSystem oscillators(const VectorXd& w, const VectorXd& b, Index P) {
  HillSystem s;
  const Index I = w.size();
  s.mass = MatrixXd::Identity(I, I);
  s.damping = b.asDiagonal();
  s.stiffness[0] = FourierSeries(I * I, P);
  for (Index i = 0; i < I; ++i) s.stiffness[0].c(i + I * i, 0) = w(i) * w(i);
  return s;
}

void add(HillSystem& s, Index i, Index j, Index k, cplx value) {
  s.stiffness[0].c(i + s.num_modes() * j, k) += k == 0 ? cplx(value.real()) : value;
}
void add_both(HillSystem& s, Index i, Index j, Index k, cplx value) {
  add(s, i, j, k, value);
  if (i != j) add(s, j, i, k, value);
}
cplx phase(Random& random) { return {random(-1, 1), random(-1, 1)}; }

// Symmetric harmonics of the size modulation decay^k w_i w_j.
void modulate(HillSystem& s, const VectorXd& w, double modulation, double decay, Random& random) {
  const Index I = w.size();
  for (Index k = 1; k <= s.stiffness[0].num_harmonics(); ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j <= i; ++j)
        add_both(s, i, j, k, 0.5 * modulation * std::pow(decay, double(k)) * w(i) * w(j) * phase(random));
}

VectorXd frequencies(Random& random, Index I) {
  const double w1 = random.power(-0.5, 0.6);
  const bool beam = random.chance(0.4);
  VectorXd w(I);
  for (Index i = 0; i < I; ++i) w(i) = w1 * double(beam ? (i + 1) * (i + 1) : i + 1) * random(0.85, 1.15);
  return w;
}

VectorXd modal_damping(Random& random, const VectorXd& w) { return 2 * random.power(-5, -0.7) * w; }

HillSystem random_system(Random& random, Index I, double least_modulation, double most_modulation) {
  const VectorXd w = frequencies(random, I);
  HillSystem s = oscillators(w, modal_damping(random, w), random.integer(1, 4));
  modulate(s, w, random.power(std::log10(least_modulation), std::log10(most_modulation)), random(0.2, 0.7), random);
  return s;
}

HillSystem twins(Random& random) {
  const Index I = random.chance(0.7) ? 2 : 3;
  const double w1 = random.power(-0.4, 0.6), apart = random.power(-14, -3), couple = random.power(-14, -3);
  VectorXd w(I), b = VectorXd::Constant(I, random.power(-4, -1));
  for (Index i = 0; i < I; ++i) w(i) = w1 * (1 + apart * random(-1, 1));
  if (random.chance(0.3)) b(0) *= 1 + random.power(-14, -3);
  HillSystem s = oscillators(w, b, random.integer(1, 2));
  const double modulation = random.power(-3, -0.3);
  const cplx common = phase(random);
  for (Index k = 1; k <= s.stiffness[0].num_harmonics(); ++k)
    for (Index i = 0; i < I; ++i)
      add(s, i, i, k, 0.5 * modulation * w1 * w1 / double(k) * (common + apart * phase(random)));
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < i; ++j) {
      add_both(s, i, j, 0, couple * w1 * w1 * random(-1, 1));
      if (random.chance(0.7)) add_both(s, i, j, 1, couple * w1 * w1 * phase(random));
    }
  return s;
}

HillSystem defective(Random& random) {
  const bool critical = random.chance(0.4);
  const double w1 = random.power(-0.4, 0.6), back = random.chance(0.3) ? 0 : random.power(-16, -4);
  const VectorXd w = VectorXd::Constant(2, w1);
  VectorXd b = VectorXd::Constant(2, random.power(-3, -0.5));
  if (critical) b(0) = 2 * w1;
  HillSystem s = oscillators(w, b, 1);
  const double forth = w1 * w1 * random.power(-2, 0) * (random.chance(0.5) ? 1 : -1);
  add(s, 0, 1, 0, forth);
  add(s, 1, 0, 0, forth * back);
  const double modulation = w1 * w1 * random.power(-6, -1);
  for (Index i = 0; i < 2; ++i)
    for (Index j = 0; j < 2; ++j) {
      const bool small = i == 1 && j == 0;
      add(s, i, j, 1, 0.5 * modulation * phase(random) * (small ? back : 1));
    }
  return s;
}

HillSystem unequal_coupling(Random& random, bool one_way) {
  const Index I = random.integer(2, 3);
  HillSystem s = random_system(random, I, 0.01, 0.5);
  const double size = random.power(one_way ? -3 : 0, 3), back = one_way ? 0 : random.power(-6, -2) / size;
  for (Index k = 0; k <= s.stiffness[0].num_harmonics(); ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j < i; ++j) {
        const cplx value = phase(random);
        s.stiffness[0].c(i + I * j, k) = 0;
        s.stiffness[0].c(j + I * i, k) = 0;
        add(s, i, j, k, value * size);
        add(s, j, i, k, value * back);
      }
  return s;
}

HillSystem gyroscopic(Random& random) {
  const Index I = random.integer(2, 3);
  HillSystem s = random_system(random, I, 0.01, 0.5);
  if (random.chance(0.5)) s.damping.setZero();
  const double size = random.power(-4, 0.5);
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < i; ++j) {
      s.damping(i, j) = size * random(-1, 1);
      s.damping(j, i) = -s.damping(i, j);
    }
  return s;
}

HillSystem circulatory(Random& random) {
  const Index I = random.integer(2, 3);
  HillSystem s = random_system(random, I, 0.01, 0.5);
  const double size = random.power(-3, 0);
  for (Index k = 0; k <= 1; ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j < I; ++j)
        if (i != j) add(s, i, j, k, size * phase(random));
  return s;
}

HillSystem stiff(Random& random) {
  const Index I = random.integer(1, 3);
  const VectorXd w = frequencies(random, I);
  const double internal = random.power(-2, 1);
  const VectorXd b = modal_damping(random, w) + VectorXd((internal * w.array().square()).min(120.0));
  HillSystem s = oscillators(w, b, random.integer(1, 4));
  modulate(s, w, random.power(-2, -0.2), random(0.2, 0.7), random);
  return s;
}

HillSystem crowded(Random& random) {
  const Index I = random.integer(4, 6);
  VectorXd w(I);
  for (Index i = 0; i < I; ++i) w(i) = random(0.4, 2.5);
  HillSystem s = oscillators(w, modal_damping(random, w), random.integer(1, 3));
  modulate(s, w, random.power(-3, -0.5), random(0.2, 0.7), random);
  return s;
}

// |Im s| of mode i with its modulation, were it alone, with its stiffness so many times as large; NaN in a tongue.
double frequency_alone(const HillSystem& s, Index i, double stiffer) {
  HillSystem alone = oscillators(VectorXd::Zero(1), s.damping.diagonal().segment(i, 1), s.stiffness[0].num_harmonics());
  alone.stiffness[0].c = stiffer * s.stiffness[0].c.row(i + s.num_modes() * i);
  const Stability stability = analyse_stability(alone, 1);
  return stability.exponents.empty() ? NAN : std::abs(stability.exponents.front().value.imag());
}

HillSystem shifted(Random& random) {
  const Index I = random.chance(0.7) ? 2 : random.integer(3, 5), P = random.integer(1, 3);
  const bool fast = random.chance(0.5);
  const double slowest = fast ? random(22, 34) : random(0.6, 6), most = random.chance(0.8) ? 0.22 : 0.05;
  VectorXd w(I);
  for (Index i = 0; i < I; ++i) w(i) = slowest + (i > 0 ? random(0.3, 8) : 0);
  VectorXd b = VectorXd::Constant(I, fast ? random.power(-11, -3) : random.power(-5, -1.5));
  for (Index i = 0; i < I; ++i) b(i) *= random.chance(0.5) ? 1 : random(0.7, 1.3);
  HillSystem s = oscillators(w, b, P);
  for (Index i = 0; i < I; ++i)
    for (Index k = 1; k <= P; ++k) add(s, i, i, k, w(i) * w(i) * random(0, most) / double(k * k) * phase(random));
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < I; ++j) {
      const double size = random.power(-7, 0.3);
      for (Index k = 0; k <= P && i != j; ++k)
        add(s, i, j, k, size / double(k + 1) * phase(random) * (random.chance(0.3) ? random.power(-9, -1) : 1));
    }
  // Stiffness of the second mode such that its frequency and the first one's, or their sum, is `off` from a multiple of
  // the speed.
  const double off = random.power(-7, -1), other = (random.chance(0.3) ? 1 : -1) * frequency_alone(s, 0, 1);
  const auto apart = [&](double stiffer) {
    const double turns = frequency_alone(s, 1, stiffer) + other - off;
    return turns - std::round(turns);
  };
  double low = 1, high = 1;
  do {
    low = high;
    high += 0.01;
  } while (high < 1.6 &&
           !(apart(low) * apart(high) <= 0 && std::abs(apart(low)) < 0.25 && std::abs(apart(high)) < 0.25));
  for (int step = 0; step < 45; ++step) {
    const double middle = 0.5 * (low + high);
    (apart(middle) * apart(low) <= 0 ? high : low) = middle;
  }
  s.stiffness[0].c.row(1 + I) *= low;
  return s;
}

}  // namespace

Case random_case(Family family, std::uint64_t number) {
  Random random(number * 1000003 + std::uint64_t(family) * 7919 + 1);
  Case result;
  HillSystem& s = result.system;
  result.speed = 1;
  switch (family) {
    case Family::random:
      s = random_system(random, random.integer(1, 4), 1e-3, 0.8);
      break;
    case Family::twins:
      s = twins(random);
      break;
    case Family::tongue: {
      s = random_system(random, random.integer(1, 2), 1e-3, 0.5);
      const Index I = s.num_modes(), i = random.integer(0, I - 1), j = random.integer(0, I - 1);
      const auto w = [&](Index m) { return std::sqrt(s.stiffness[0].c(m + I * m, 0).real()); };
      result.speed =
          (w(i) + w(j)) / double(random.integer(1, 3)) * (1 + random.power(-9, -1) * (random.chance(0.5) ? 1 : -1));
      break;
    }
    case Family::defective:
      s = defective(random);
      break;
    case Family::one_way:
      s = unequal_coupling(random, true);
      break;
    case Family::non_normal:
      s = unequal_coupling(random, false);
      break;
    case Family::gyroscopic:
      s = gyroscopic(random);
      break;
    case Family::circulatory:
      s = circulatory(random);
      break;
    case Family::stiff:
      s = stiff(random);
      break;
    case Family::undamped:
      s = random_system(random, random.integer(1, 3), 1e-3, 0.5);
      s.damping.setZero();
      break;
    case Family::strong:
      s = random_system(random, random.integer(1, 2), 0.8, 4);
      break;
    case Family::crowded:
      s = crowded(random);
      break;
    case Family::shifted:
      s = shifted(random);
      break;
  }
  // Any unit of time.
  if (random.chance(0.5)) {
    const double unit = random.power(-1, 4);
    result.speed *= unit;
    s.damping *= unit;
    s.stiffness[0].c *= unit * unit;
  }
  return result;
}

}  // namespace hb::attack
