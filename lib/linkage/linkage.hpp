// What a mechanism is: a crank at constant speed and dyads hung on it, one after the other. Immutable values, no
// computation. Plane positions are complex numbers x + i y; a point of a body is complex in the body's own frame
// (origin joint 0, real axis toward joint 1). Units are the scene's own, consistent (force = mass length / time^2).
#pragma once

#include <complex>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lib/fourier/fourier.hpp"

namespace hb {

// Shear of a thick rod: shear force = k G F (w' - rotation of the section).
struct Shear {
  double modulus = 0;  // G
  double coefficient = 0;  // k
};

// What a material bears, stresses as magnitudes; 0: unknown.
struct Strength {
  double yield = 0;  // S_y, yield strength
  double tensile = 0;  // S_u, ultimate tensile strength
  double endurance = 0;  // S_e, amplitude borne for ever at mean stress 0, of this part: surface, size, notches
};

// Uniform pinned-pinned elastic link (physics of the rod; the paper's letters in brackets).
struct Elastic {
  double youngs_modulus = 0;  // E
  double area = 0;  // F
  double second_moment = 0;  // J
  double density = 0;  // rho
  double internal_damping = 0;  // alpha_c, unit time: stress = E (strain + alpha_c d strain/dt)
  double damping_x = 0;  // c_x, external damping per length, along the rod
  double damping_y = 0;  // c_y, across the rod
  double section_height = 0;  // in the plane of motion; 0: unknown
  std::optional<Shear> shear = std::nullopt;  // none: rigid in shear
  Strength strength = {};
};

struct Body {
  std::string name;
  double length = 0;  // joint 0 to joint 1
  double mass = 0;
  std::complex<double> com = 0;  // centre of mass, body frame
  double inertia = 0;  // about the centre of mass
  std::map<std::string, std::complex<double>> points;  // further joints, body frame
  // Set for an elastic link: then mass is spread evenly (mu = mass/length), com = length/2,
  // inertia = mass length^2/12 + rho J length, and there are no points.
  std::optional<Elastic> elastic;
};

struct Crank {
  Body body;  // joint 0 is the pivot, joint 1 the tip
  std::complex<double> pivot = 0;
};

struct Rocker {
  Body body;  // joint 0 is the pivot, joint 1 the coupler's end
  std::complex<double> pivot = 0;
};

struct Slider {
  std::string name;
  double mass = 0;
  std::complex<double> guide = 0;  // a point of the guide
  double direction = 0;  // rad, of the guide
  FourierSeries force;  // applied along the direction, over the crank angle; one component, empty = none
  std::map<std::string, std::complex<double>> points;  // slider frame: origin its joint, real axis along the guide
};

// Where a dyad hangs: a point of an earlier body. Bodies are numbered 0 crank, 1+2d coupler, 2+2d rocker or slider of
// dyad d.
struct Attachment {
  int body = 0;
  std::complex<double> point = 0;
  std::string name;  // as written in the scene: "crank", "O2BC.C"
};

struct Dyad {
  Attachment on;
  Body coupler;  // joint 0 at `on`, joint 1 at the rocker or slider
  std::variant<Rocker, Slider> closing;
  // RRR: rocker direction = direction pivot -> driving joint, turned by branch * (the triangle's angle at the pivot).
  // RRP: sign of the slider's position relative to the foot of the perpendicular from the driving joint on the guide.
  int branch = 1;
};

struct Linkage {
  double gravity = 0;  // along -y
  Crank crank;
  std::vector<Dyad> dyads;

  int num_bodies() const { return 1 + 2 * static_cast<int>(dyads.size()); }
};

constexpr int coupler_index(int dyad) { return 1 + 2 * dyad; }
constexpr int closing_index(int dyad) { return 2 + 2 * dyad; }

// The rigid or elastic body with this number, or nullptr for a slider.
[[nodiscard]] const Body* body_at(const Linkage& linkage, int index);
[[nodiscard]] const std::string& body_name(const Linkage& linkage, int index);

// Numbers of the elastic links, in the scene's order.
[[nodiscard]] std::vector<int> elastic_links(const Linkage& linkage);

}  // namespace hb
