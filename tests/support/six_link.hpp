// The paper's six-link mechanism (mm, kg, s) as a hand-built linkage: crank O1A, coupler AB, rocker O2BC, coupler CD,
// rocker O3D; AB and CD elastic.
#pragma once

#include <complex>

#include "lib/linkage/linkage.hpp"

namespace hb::six_link {

struct Options {
  double J = 45;  // second moment of AB and CD, mm^4
  double gravity = 9810;
  double internal_damping = 1e-4;
  double external_damping = 1e-6;
  double crank_length = 55;
};

// Uniform elastic link: mass spread evenly, rotary inertia included.
inline Body elastic_body(const std::string& name, double length, double mass, const Elastic& elastic) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = mass;
  body.com = length / 2;
  body.inertia = mass * length * length / 12 + elastic.density * elastic.second_moment * length;
  body.elastic = elastic;
  return body;
}

// Rigid link; inertia given about joint 0.
inline Body rigid_body(const std::string& name, double length, double mass, std::complex<double> com,
                       double inertia_pivot) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = mass;
  body.com = com;
  body.inertia = inertia_pivot - mass * std::norm(com);
  return body;
}

inline Elastic steel(const Options& options, double area, double mass, double length) {
  return {.youngs_modulus = 21e7,
          .area = area,
          .second_moment = options.J,
          .density = mass / (length * area),
          .internal_damping = options.internal_damping,
          .damping_x = options.external_damping,
          .damping_y = options.external_damping};
}

inline Linkage linkage(const Options& options = {}) {
  Linkage six;
  six.gravity = options.gravity;
  six.crank.body = rigid_body("crank", options.crank_length, 0, 0, 0);

  Dyad first;
  first.on = {0, options.crank_length, "crank"};
  first.coupler = elastic_body("AB", 259, 0.165, steel(options, 10, 0.165, 259));
  Rocker o2bc;
  o2bc.pivot = 270;
  o2bc.body = rigid_body("O2BC", 200, 1.84, std::polar(118.0, -0.15), 18300);
  o2bc.body.points["C"] = std::polar(200.0, -0.3);
  first.closing = o2bc;
  first.branch = -1;

  Dyad second;
  second.on = {2, std::polar(200.0, -0.3), "O2BC.C"};
  second.coupler = elastic_body("CD", 258, 0.163, steel(options, 9, 0.163, 258));
  Rocker o3d;
  o3d.pivot = 570;
  o3d.body = rigid_body("O3D", 220, 1.35, 113, 11500);
  second.closing = o3d;
  second.branch = -1;

  six.dyads = {first, second};
  return six;
}

}  // namespace hb::six_link
