#include "tests/support/random_linkage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/constants.hpp"
#include "lib/linkage/kinematics.hpp"
#include "tests/support/newton_euler.hpp"

namespace hb {
namespace {

using Complex = std::complex<double>;
enum class Ending { rocker, elastic_rocker, slider };
enum class Hang { end, point };  // at the body's joint 1 (slider: its joint), or at a further point

struct DyadPlan {
  int on = 0;  // body
  Hang hang = Hang::end;
  Ending ending = Ending::rocker;
  bool elastic_coupler = true;
};

struct Plan {
  std::string kind;
  std::vector<DyadPlan> dyads;
};

// What the linkage's numbers are measured in, and the speed it is meant for.
struct Scale {
  double length = 1, mass = 1, speed = 1;
};

const std::vector<Plan>& plans() {
  using enum Ending;
  using enum Hang;
  static const std::vector<Plan> list = {
      {"four-bar, elastic coupler", {{0, end, rocker, true}}},
      {"four-bar, elastic rocker", {{0, end, elastic_rocker, false}}},
      {"four-bar, both elastic", {{0, end, elastic_rocker, true}}},
      {"slider-crank, elastic rod", {{0, end, slider, true}}},
      {"slider-crank beside a rod on the crank's point", {{0, end, slider, false}, {0, point, slider, true}}},
      {"six-link, second dyad on the rocker's point", {{0, end, rocker, true}, {2, point, rocker, true}}},
      {"six-link, second dyad on the rocker's end", {{0, end, rocker, true}, {2, end, elastic_rocker, true}}},
      {"slider on the rocker's point", {{0, end, rocker, true}, {2, point, slider, true}}},
      {"rocker on the rigid coupler's point", {{0, end, rocker, false}, {1, point, rocker, true}}},
      {"slider on the rigid coupler's point", {{0, end, rocker, false}, {1, point, slider, true}}},
      {"rocker on the connecting rod's point", {{0, end, slider, false}, {1, point, elastic_rocker, true}}},
      {"rocker on the slider's joint", {{0, end, slider, true}, {2, end, rocker, true}}},
      {"slider on the slider's point", {{0, end, slider, true}, {2, point, slider, true}}},
      {"two dyads on one crank", {{0, end, slider, true}, {0, end, elastic_rocker, true}}},
      {"eight-link", {{0, end, rocker, true}, {2, point, elastic_rocker, true}, {2, point, slider, true}}},
      {"eight-link in a row", {{0, end, rocker, true}, {2, point, rocker, false}, {3, point, slider, true}}},
      {"ten-link",
       {{0, end, rocker, false}, {1, point, rocker, true}, {4, point, slider, true}, {6, point, rocker, true}}},
  };
  return list;
}

// A chain in which every dyad hangs on any earlier link that may carry it.
Plan random_plan(Random& random) {
  Plan plan{"free chain", {}};
  std::vector<int> carriers{0};
  const int num_dyads = 3 + random.below(4);
  for (int d = 0; d < num_dyads; ++d) {
    DyadPlan dyad;
    dyad.on = carriers[static_cast<std::size_t>(random.below(static_cast<int>(carriers.size())))];
    const bool coupler_end = dyad.on % 2 == 1;  // its joint 1 belongs to the dyad's own closing link
    dyad.hang = coupler_end || random.below(3) > 0 ? Hang::point : Hang::end;
    dyad.ending = static_cast<Ending>(random.below(3));
    dyad.elastic_coupler = random.below(3) > 0;
    if (!dyad.elastic_coupler) carriers.push_back(coupler_index(d));
    if (dyad.ending != Ending::elastic_rocker) carriers.push_back(closing_index(d));
    plan.dyads.push_back(dyad);
  }
  return plan;
}

Body rigid_body(const std::string& name, double length, const Scale& scale, Random& random) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = random.below(6) == 0 ? 0 : scale.mass * random.log_uniform(0.1, 10);
  body.com = length * std::polar(random.uniform(0, 0.7), random.uniform(-pi, pi));
  body.inertia = body.mass * length * length * random.uniform(0.02, 0.3);
  return body;
}

Body elastic_body(const std::string& name, double length, const Scale& scale, Random& random) {
  Body body;
  body.name = name;
  body.length = length;
  body.mass = scale.mass * random.log_uniform(0.1, 10);
  const double mu = body.mass / length;
  const double omega1 = scale.speed * random.log_uniform(3, 30);  // first bending frequency
  Elastic elastic;
  elastic.area = std::pow(length * random.uniform(0.01, 0.1), 2);
  elastic.second_moment = elastic.area * elastic.area * random.uniform(0.02, 0.1);
  elastic.density = mu / elastic.area * random.uniform(0.8, 1.2);
  elastic.youngs_modulus = mu * std::pow(omega1, 2) * std::pow(length / pi, 4) / elastic.second_moment;
  const double damping = random.below(4) == 0 ? 0 : 1;
  elastic.internal_damping = damping * random.uniform(0, 0.05) / omega1;
  elastic.damping_x = damping * mu * scale.speed * random.uniform(0, 0.2);
  elastic.damping_y = damping * mu * scale.speed * random.uniform(0, 0.2);
  body.com = length / 2;
  body.inertia = body.mass * length * length / 12 + elastic.density * elastic.second_moment * length;
  body.elastic = elastic;
  return body;
}

// Places of the driving joint over the turn.
std::vector<Complex> path(const Linkage& linkage, const Attachment& on) {
  std::vector<Complex> places;
  for (int j = 0; j < 90; ++j) places.push_back(newton_euler::place(linkage, 2 * pi * j / 90, on.body, on.point));
  return places;
}

struct Disc {
  Complex centre;
  double radius = 0;
};

Disc around(const std::vector<Complex>& places) {
  Disc disc;
  for (const Complex z : places) disc.centre += z / static_cast<double>(places.size());
  for (const Complex z : places) disc.radius = std::max(disc.radius, std::abs(z - disc.centre));
  return disc;
}

Attachment attachment(const Linkage& linkage, const DyadPlan& plan, const Scale& scale, Random& random) {
  const Body* body = body_at(linkage, plan.on);
  const double length = body ? body->length : scale.length;
  Attachment on;
  on.body = plan.on;
  on.name = body_name(linkage, plan.on);
  if (plan.hang == Hang::end) {
    on.point = body ? body->length : 0;
  } else {
    on.point = length * std::polar(random.uniform(0.4, 1.2), random.uniform(-pi, pi));
    on.name += ".P";
  }
  return on;
}

FourierSeries random_force(const Scale& scale, Random& random) {
  const Eigen::Index H = random.below(5);
  FourierSeries force(1, H);
  const double size = scale.mass * scale.length * scale.speed * scale.speed;
  force.c(0, 0) = size * random.uniform(-1, 1);
  for (Eigen::Index n = 1; n <= H; ++n) force.c(0, n) = size * Complex(random.uniform(-1, 1), random.uniform(-1, 1));
  return force;
}

// A dyad whose closing margin is about `margin` where its driving joint is farthest from the pivot (from the guide).
Dyad random_dyad(const Linkage& linkage, const DyadPlan& plan, int number, double margin, const Scale& scale,
                 Random& random) {
  const std::string tag = std::to_string(number);
  Dyad dyad;
  dyad.on = attachment(linkage, plan, scale, random);
  dyad.branch = random.sign();
  const std::vector<Complex> places = path(linkage, dyad.on);
  const Disc disc = around(places);
  const double cosine = std::sqrt(1 - margin * margin);
  double coupler_length = 0;
  if (plan.ending == Ending::slider) {
    Slider slider;
    slider.name = "slider" + tag;
    slider.mass = random.below(6) == 0 ? 0 : scale.mass * random.log_uniform(0.1, 10);
    slider.direction = random.uniform(-pi, pi);
    const Complex e = std::polar(1.0, slider.direction);
    slider.guide = disc.centre + e * disc.radius * Complex(random.uniform(-3, 3), random.uniform(-1, 1));
    slider.force = random_force(scale, random);
    double height = 0;
    for (const Complex z : places) height = std::max(height, std::abs((std::conj(e) * (z - slider.guide)).imag()));
    coupler_length = height / cosine;
    dyad.closing = slider;
  } else {
    Rocker rocker;
    rocker.pivot = disc.centre + disc.radius * std::polar(random.uniform(1.5, 4), random.uniform(-pi, pi));
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (const Complex z : places) {
      nearest = std::min(nearest, std::abs(z - rocker.pivot));
      farthest = std::max(farthest, std::abs(z - rocker.pivot));
    }
    // d^2 = l^2 + r^2 + 2 l r cosine at the farthest place, with s = l + r and the difference l - r chosen.
    const double difference = nearest * random.uniform(-0.8, 0.8);
    const double sum = std::sqrt((2 * farthest * farthest - difference * difference * (1 - cosine)) / (1 + cosine));
    coupler_length = (sum + difference) / 2;
    const double length = (sum - difference) / 2;
    rocker.body = plan.ending == Ending::elastic_rocker ? elastic_body("rocker" + tag, length, scale, random)
                                                        : rigid_body("rocker" + tag, length, scale, random);
    dyad.closing = rocker;
  }
  dyad.coupler = plan.elastic_coupler ? elastic_body("coupler" + tag, coupler_length, scale, random)
                                      : rigid_body("coupler" + tag, coupler_length, scale, random);
  return dyad;
}

// Gives the carrying body the point that an attachment names.
void name_point(Linkage& linkage, const Attachment& on, const std::string& name) {
  if (on.body == 0) {
    linkage.crank.body.points[name] = on.point;
    return;
  }
  Dyad& carrier = linkage.dyads[static_cast<std::size_t>((on.body - 1) / 2)];
  if (on.body % 2 == 1)
    carrier.coupler.points[name] = on.point;
  else if (auto* rocker = std::get_if<Rocker>(&carrier.closing))
    rocker->body.points[name] = on.point;
  else
    std::get<Slider>(carrier.closing).points[name] = on.point;
}

bool turns_freely(const Linkage& linkage, const Margins& margins) {
  double least = 1;
  for (int j = 0; j < 720; ++j) {
    const double margin = newton_euler::closing_margin(linkage, 2 * pi * j / 720);
    if (!(margin >= margins.from)) return false;
    least = std::min(least, margin);
  }
  return least <= margins.to && !find_obstruction(linkage);
}

RandomLinkage random_linkage(const Plan& plan, const Margins& margins, Random& random) {
  const Scale scale{random.log_uniform(1e-2, 1e3), random.log_uniform(1e-3, 1e2), random.log_uniform(1, 1e3)};
  RandomLinkage result{plan.kind, {}, scale.speed};
  Linkage& linkage = result.linkage;
  linkage.gravity = random.below(6) == 0 ? 0 : scale.length * scale.speed * scale.speed * random.uniform(0, 2);
  linkage.crank.body = rigid_body("crank", scale.length, scale, random);
  linkage.crank.pivot = scale.length * Complex(random.uniform(-1, 1), random.uniform(-1, 1));
  const int num_dyads = static_cast<int>(plan.dyads.size());
  for (int d = 0; d < num_dyads; ++d) {
    const Linkage carrier = linkage;
    const Margins wanted{margins.from, d + 1 < num_dyads ? 1 : margins.to};  // the last dyad is the critical one
    do {
      Dyad dyad = random_dyad(carrier, plan.dyads[static_cast<std::size_t>(d)], d,
                              random.log_uniform(wanted.from, std::min(wanted.to, 0.95)), scale, random);
      linkage = carrier;
      if (dyad.on.name.ends_with(".P")) {
        const std::string name = std::to_string(d).insert(0, 1, 'P');
        dyad.on.name.replace(dyad.on.name.size() - 1, 1, name);
        name_point(linkage, dyad.on, name);
      }
      linkage.dyads.push_back(std::move(dyad));
    } while (!turns_freely(linkage, wanted));
  }
  return result;
}

}  // namespace

double Random::log_uniform(double from, double to) { return std::exp(uniform(std::log(from), std::log(to))); }

std::vector<RandomLinkage> random_linkages(int count, std::uint64_t seed, const Margins& margins) {
  Random random(seed);
  std::vector<RandomLinkage> result;
  for (int k = 0; k < count; ++k) {
    const auto slot = static_cast<std::size_t>(k) % (plans().size() + 3);
    result.push_back(random_linkage(slot < plans().size() ? plans()[slot] : random_plan(random), margins, random));
  }
  return result;
}

FourierSeries random_deflection(const Body& link, Eigen::Index num_modes, Random& random) {
  FourierSeries q(num_modes, 6);
  for (Eigen::Index k = 0; k < num_modes; ++k)
    for (Eigen::Index n = 0; n <= 6; ++n) {
      const double size = 0.05 * link.length / static_cast<double>((k + 1) * (k + 1)) * std::pow(0.5, n);
      q.c(k, n) = size * Complex(random.uniform(-1, 1), n > 0 ? random.uniform(-1, 1) : 0);
    }
  return q;
}

}  // namespace hb
