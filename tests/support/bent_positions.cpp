#include "tests/support/bent_positions.hpp"

#include <array>
#include <cmath>

#include "lib/constants.hpp"
#include "tests/support/newton_euler.hpp"

namespace hb::bent_positions {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
constexpr Index num_times = 256;
constexpr Index panels = 8;  // along a rod, with five Gauss points each

constexpr std::array<double, 5> gauss_x = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                           0.953089922969332};
constexpr std::array<double, 5> gauss_w = {0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683,
                                           0.118463442528095};

struct RodPoint {
  double x, dx;
  Complex p;  // in the frame of the chord
  double psi, kappa;
};

struct BentRod {
  double chord = 0;
  std::vector<RodPoint> points;
};

// Points of a rod, and five more from each to the next (and to the end), with w' and w'' there per mode.
class RodShape {
 public:
  RodShape(double l, Index num_modes) {
    const double h = l / static_cast<double>(panels);
    std::vector<double> stations;
    double x = 0;
    const auto step = [&](double to) {
      for (std::size_t j = 0; j < 5; ++j) stations.push_back(x + (to - x) * gauss_x[j]);
      lengths_.push_back(to - x);
      x = to;
    };
    for (Index panel = 0; panel < panels; ++panel)
      for (std::size_t j = 0; j < 5; ++j) {
        step(h * (static_cast<double>(panel) + gauss_x[j]));
        x_.push_back(x);
        dx_.push_back(h * gauss_w[j]);
      }
    step(l);
    between_ = slopes(stations, l, num_modes);
    slopes_ = slopes(x_, l, num_modes);
    curvatures_.resize(slopes_.rows(), num_modes);
    for (Index k = 0; k < slopes_.rows(); ++k)
      for (Index i = 0; i < num_modes; ++i) {
        const double wave = static_cast<double>(i + 1) * pi / l;
        curvatures_(k, i) = -wave * wave * std::sin(wave * x_[static_cast<std::size_t>(k)]);
      }
  }

  // p' = e^{i psi}, integrated from one point to the next.
  BentRod bend(const Eigen::VectorXd& q) const {
    const Eigen::VectorXd between = between_ * q, slope = slopes_ * q, second = curvatures_ * q;
    BentRod rod;
    Complex p = 0;
    for (std::size_t k = 0; k < lengths_.size(); ++k) {
      for (std::size_t j = 0; j < 5; ++j) {
        const double sine = between(static_cast<Index>(5 * k + j));
        p += lengths_[k] * gauss_w[j] * Complex(std::sqrt(1 - sine * sine), sine);
      }
      if (k == x_.size()) break;
      const double sine = slope(static_cast<Index>(k));
      rod.points.push_back(
          {x_[k], dx_[k], p, std::asin(sine), second(static_cast<Index>(k)) / std::sqrt(1 - sine * sine)});
    }
    rod.chord = p.real();
    return rod;
  }

  const std::vector<double>& dx() const { return dx_; }

 private:
  static Eigen::MatrixXd slopes(const std::vector<double>& x, double l, Index num_modes) {
    Eigen::MatrixXd rows(static_cast<Index>(x.size()), num_modes);
    for (std::size_t k = 0; k < x.size(); ++k)
      for (Index i = 0; i < num_modes; ++i) {
        const double wave = static_cast<double>(i + 1) * pi / l;
        rows(static_cast<Index>(k), i) = wave * std::cos(wave * x[k]);
      }
    return rows;
  }

  std::vector<double> x_, dx_, lengths_;
  Eigen::MatrixXd between_, slopes_, curvatures_;
};

// Everything that moves, at the times t_j: rows of complex places or directions, and of real curvatures.
struct Places {
  Eigen::MatrixXcd rod_points, rod_sections, rod_frames;  // per point of all rods: r, direction of the section, e1
  Eigen::MatrixXd curvatures;
  Eigen::MatrixXcd centres, directions;  // rigid bodies
  Eigen::MatrixXcd sliders;
};

struct Masses {
  std::vector<const Body*> rods;  // per rod point
  std::vector<double> dx;
  std::vector<const Body*> bodies;
  std::vector<const Slider*> sliders;
};

void set_length(Linkage& linkage, int body, double length) {
  Dyad& dyad = linkage.dyads[static_cast<std::size_t>((body - 1) / 2)];
  (body % 2 == 1 ? dyad.coupler : std::get<Rocker>(dyad.closing).body).length = length;
}

class Mechanism {
 public:
  Mechanism(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion)
      : linkage_(linkage), speed_(speed) {
    for (const LinkResponse& response : motion) {
      const Body* body = body_at(linkage, response.link);
      shapes_.emplace_back(body->length, response.q.num_components());
      for (const double dx : shapes_.back().dx()) {
        masses_.rods.push_back(body);
        masses_.dx.push_back(dx);
      }
    }
    for (int b = 0; b < linkage.num_bodies(); ++b) {
      const Body* body = body_at(linkage, b);
      if (body == nullptr)
        masses_.sliders.push_back(&std::get<Slider>(linkage.dyads[static_cast<std::size_t>((b - 1) / 2)].closing));
      else if (!body->elastic)
        masses_.bodies.push_back(body);
    }
  }

  Places places(const std::vector<LinkResponse>& motion) const {
    const auto points = static_cast<Index>(masses_.rods.size());
    Places at;
    at.rod_points.resize(points, num_times), at.rod_sections = at.rod_frames = at.rod_points;
    at.curvatures.resize(points, num_times);
    at.centres.resize(static_cast<Index>(masses_.bodies.size()), num_times), at.directions = at.centres;
    at.sliders.resize(static_cast<Index>(masses_.sliders.size()), num_times);
    std::vector<Eigen::MatrixXd> q;
    for (const LinkResponse& response : motion) q.push_back(fourier::synthesise(response.q, num_times));
    for (Index j = 0; j < num_times; ++j) place(motion, q, j, at);
    return at;
  }

  // d/dt over the turn.
  Eigen::MatrixXcd rate(const Eigen::MatrixXcd& f) const {
    const auto real_rate = [&](const Eigen::MatrixXd& part) -> Eigen::MatrixXd {
      if (part.rows() == 0) return part;
      return speed_ * fourier::synthesise(fourier::derivative(fourier::analyse(part)), num_times);
    };
    return real_rate(f.real()).cast<Complex>() + Complex(0, 1) * real_rate(f.imag()).cast<Complex>();
  }

  // Mean of T - V over the turn.
  double action(const Places& at) const {
    const Eigen::MatrixXcd v = rate(at.rod_points), turn = rate(at.rod_sections);
    double sum = 0;
    for (Index k = 0; k < v.rows(); ++k) {
      const Body& body = *masses_.rods[static_cast<std::size_t>(k)];
      const Elastic& elastic = *body.elastic;
      const double mu = body.mass / body.length;
      sum +=
          masses_.dx[static_cast<std::size_t>(k)] *
          (mu / 2 * v.row(k).squaredNorm() + elastic.density * elastic.second_moment / 2 * turn.row(k).squaredNorm() -
           mu * linkage_.gravity * at.rod_points.row(k).imag().sum() -
           elastic.youngs_modulus * elastic.second_moment / 2 * at.curvatures.row(k).squaredNorm());
    }
    const Eigen::MatrixXcd v_centre = rate(at.centres), turn_body = rate(at.directions);
    for (Index b = 0; b < v_centre.rows(); ++b) {
      const Body& body = *masses_.bodies[static_cast<std::size_t>(b)];
      sum += body.mass / 2 * v_centre.row(b).squaredNorm() + body.inertia / 2 * turn_body.row(b).squaredNorm() -
             body.mass * linkage_.gravity * at.centres.row(b).imag().sum();
    }
    const Eigen::MatrixXcd v_slider = rate(at.sliders);
    for (Index s = 0; s < v_slider.rows(); ++s) {
      const Slider& slider = *masses_.sliders[static_cast<std::size_t>(s)];
      sum += slider.mass / 2 * v_slider.row(s).squaredNorm() -
             slider.mass * linkage_.gravity * at.sliders.row(s).imag().sum();
    }
    return sum / static_cast<double>(num_times);
  }

  // Mean power that dampers take from a velocity (rows as rod_points, curvatures) when the motion is `at`.
  double damping_power(const Places& at, const Eigen::MatrixXcd& velocity, const Eigen::MatrixXd& bending) const {
    const Eigen::MatrixXcd v = rate(at.rod_points);
    const Eigen::MatrixXd kappa_t = rate(at.curvatures.cast<Complex>()).real();
    double sum = 0;
    for (Index k = 0; k < v.rows(); ++k) {
      const Elastic& elastic = *masses_.rods[static_cast<std::size_t>(k)]->elastic;
      for (Index j = 0; j < num_times; ++j) {
        const Complex own = std::conj(at.rod_frames(k, j)) * v(k, j);
        const Complex other = std::conj(at.rod_frames(k, j)) * velocity(k, j);
        sum +=
            masses_.dx[static_cast<std::size_t>(k)] *
            (elastic.damping_x * own.real() * other.real() + elastic.damping_y * own.imag() * other.imag() +
             elastic.youngs_modulus * elastic.second_moment * elastic.internal_damping * kappa_t(k, j) * bending(k, j));
      }
    }
    return sum / static_cast<double>(num_times);
  }

  double force_power(const Eigen::MatrixXcd& slider_velocity) const {
    double sum = 0;
    for (Index s = 0; s < slider_velocity.rows(); ++s) {
      const Slider& slider = *masses_.sliders[static_cast<std::size_t>(s)];
      if (slider.force.c.size() == 0) continue;
      const Eigen::RowVectorXd force = fourier::synthesise(slider.force, num_times).row(0);
      const Complex u = std::polar(1.0, slider.direction);
      for (Index j = 0; j < num_times; ++j) sum += force(j) * (std::conj(u) * slider_velocity(s, j)).real();
    }
    return sum / static_cast<double>(num_times);
  }

 private:
  void place(const std::vector<LinkResponse>& motion, const std::vector<Eigen::MatrixXd>& q, Index j,
             Places& at) const {
    const double tau = 2 * pi * static_cast<double>(j) / static_cast<double>(num_times);
    Linkage bent = linkage_;
    std::vector<BentRod> rods;
    for (std::size_t r = 0; r < motion.size(); ++r) {
      rods.push_back(shapes_[r].bend(q[r].col(j)));
      set_length(bent, motion[r].link, rods[r].chord);
    }
    Index point = 0, body_row = 0, slider_row = 0;
    for (std::size_t r = 0; r < motion.size(); ++r) {
      const Complex z = newton_euler::place(bent, tau, motion[r].link, 0);
      const Complex e = newton_euler::place(bent, tau, motion[r].link, 1) - z;
      for (const RodPoint& p : rods[r].points) {
        at.rod_points(point, j) = z + e * p.p;
        at.rod_sections(point, j) = e * std::polar(1.0, p.psi);
        at.rod_frames(point, j) = e;
        at.curvatures(point++, j) = p.kappa;
      }
    }
    for (int b = 0; b < linkage_.num_bodies(); ++b) {
      const Body* body = body_at(linkage_, b);
      if (body == nullptr) {
        at.sliders(slider_row++, j) = newton_euler::place(bent, tau, b, 0);
      } else if (!body->elastic) {
        const Complex z = newton_euler::place(bent, tau, b, 0);
        at.centres(body_row, j) = newton_euler::place(bent, tau, b, body->com);
        at.directions(body_row++, j) = newton_euler::place(bent, tau, b, 1) - z;
      }
    }
  }

  const Linkage& linkage_;
  double speed_;
  std::vector<RodShape> shapes_;
  Masses masses_;
};

std::vector<LinkResponse> varied(std::vector<LinkResponse> motion, const LinkResponse& variation, double step) {
  for (LinkResponse& response : motion) {
    if (response.link != variation.link) continue;
    const Index H = std::max(response.q.num_harmonics(), variation.q.num_harmonics());
    response.q = FourierSeries(fourier::resized(response.q, H).c + step * fourier::resized(variation.q, H).c);
  }
  return motion;
}

}  // namespace

// Central differences of eighth order: sum_k a_k [f(k h) - f(-k h)]/h, a = 4/5, -1/5, 4/105, -1/280.
double residual_work(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion,
                     const LinkResponse& variation) {
  const Mechanism mechanism(linkage, speed, motion);
  constexpr double h = 0.02;
  constexpr std::array<double, 4> a = {0.8, -0.2, 4.0 / 105, -1.0 / 280};
  const Places here = mechanism.places(motion);
  double action = 0;
  Eigen::MatrixXcd points = Eigen::MatrixXcd::Zero(here.rod_points.rows(), num_times);
  Eigen::MatrixXcd sliders = Eigen::MatrixXcd::Zero(here.sliders.rows(), num_times);
  Eigen::MatrixXd curvatures = Eigen::MatrixXd::Zero(points.rows(), num_times);
  for (int k = 1; k <= 4; ++k) {
    const double weight = a[static_cast<std::size_t>(k - 1)] / h;
    const Places forward = mechanism.places(varied(motion, variation, k * h));
    const Places backward = mechanism.places(varied(motion, variation, -k * h));
    action += weight * (mechanism.action(forward) - mechanism.action(backward));
    points += weight * (forward.rod_points - backward.rod_points);
    sliders += weight * (forward.sliders - backward.sliders);
    curvatures += weight * (forward.curvatures - backward.curvatures);
  }
  return mechanism.damping_power(here, points, curvatures) - action - mechanism.force_power(sliders);
}

double lost_power(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion) {
  const Mechanism mechanism(linkage, speed, motion);
  const Places here = mechanism.places(motion);
  return mechanism.damping_power(here, mechanism.rate(here.rod_points),
                                 mechanism.rate(here.curvatures.cast<Complex>()).real());
}

double slider_power(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion) {
  const Mechanism mechanism(linkage, speed, motion);
  return mechanism.force_power(mechanism.rate(mechanism.places(motion).sliders));
}

}  // namespace hb::bent_positions
