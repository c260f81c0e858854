#include "lib/scene/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "lib/scene/quantity.hpp"

namespace hb {

namespace {

struct Window {
  double least, most;  // in m, kg, s, rad
  bool holds(double value) const { return value >= least && value <= most; }
};

double in_si(double value, Dimension dimension, const Units& units) {
  return converted(value, base_unit({dimension}, units), Unit{1, 0, dimension});
}

void remark(const TableView& table, std::string_view key, Concern concern, const std::string& words,
            const SceneContext& context) {
  const toml::node* node = table.node(key);
  context.remarks.push_back(
      {concern, fmt::format("{}: {}", table.problems().place(node ? *node : table.table()), table.path_of(key)),
       words});
}

// A value of SI size in the largest of these units that leaves it at least 1.
std::string in_best_unit(double si, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const double value = si / size_of(*parse_unit(name).unit);
    if (std::abs(value) >= 1 || name == *(names.end() - 1)) return fmt::format("{:.4g} {}", value, name);
  }
  return "";
}

// "; 210 GPa if the number was in MPa": the first unit in which the number as written is likely.
std::string likely_slip(const TableView& table, std::string_view key, const Window& likely,
                        std::initializer_list<const char*> units, std::initializer_list<const char*> shown) {
  const toml::node* node = table.node(key);
  if (!node) return "";
  std::optional<double> number;
  if (node->is_number()) number = node->value<double>();
  if (const auto* text = node->as_string()) {
    if (const auto written = number_and_unit(text->get())) number = written->value;
  }
  if (!number) return "";
  for (const char* name : units) {
    const double si = *number * size_of(*parse_unit(name).unit);
    if (likely.holds(si)) return fmt::format("; {} if the number was in {}", in_best_unit(si, shown), name);
  }
  return "";
}

void remark_on_density(const TableView& link, const TableView& elastic, const Body& body, const SceneContext& context) {
  constexpr Window solid{100, 25000}, with_mass{20, 500000};
  const double density = in_si(body.elastic->density, dimension::density, context.units);
  if (elastic.has("density") && !link.has("mass") && !solid.holds(density)) {
    remark(elastic, "density", Concern::material,
           fmt::format("found {:.4g} kg/m^3{} (solids have 100 to 25000); taken as given", density,
                       likely_slip(elastic, "density", {500, 23000},
                                   {"kg/m^3", "g/cm^3", "t/mm^3", "kg/mm^3", "lb/in^3"}, {"kg/m^3"})),
           context);
  }
  if (link.has("mass") && !elastic.has("density") && !elastic.has("material") && !with_mass.holds(density)) {
    remark(link, "mass", Concern::material,
           fmt::format("found {:.4g} kg, which over length and area is a density of {:.4g} kg/m^3 (solids have 100 to "
                       "25000); taken as given",
                       in_si(body.mass, dimension::mass, context.units), density),
           context);
  }
}

void remark_on_strength(const TableView& elastic, const Strength& strength, const SceneContext& context) {
  constexpr Window solid{1e6, 1e10}, likely{2e7, 3e9};
  for (const auto& [key, value] : {std::pair("yield", strength.yield), std::pair("tensile", strength.tensile),
                                   std::pair("endurance", strength.endurance)}) {
    if (!(value > 0)) continue;
    const double stress = in_si(value, dimension::pressure, context.units);
    if (!solid.holds(stress)) {
      const std::initializer_list<const char*> shown = {"GPa", "MPa", "kPa", "Pa"};
      remark(elastic, key, Concern::material,
             fmt::format("found {}{} (solids have 1 MPa to 10 GPa); taken as given", in_best_unit(stress, shown),
                         likely_slip(elastic, key, likely, {"MPa", "GPa", "ksi", "psi", "kPa", "Pa"}, shown)),
             context);
    }
    if (!elastic.has("section"))
      remark(elastic, key, Concern::section,
             "found beside area and J, which do not say how far the outer fibre is from the axis; a safety takes "
             "section = { shape = \"rectangle\", width, height } in their place",
             context);
  }
}

void remark_on_shear(const TableView& elastic, const Elastic& rod, const SceneContext& context) {
  const auto shear = elastic.table("shear");
  if (!shear || !rod.shear) return;
  constexpr Window of_solids{0.01, 0.6}, share{0.05, 1};
  const double E = in_si(rod.youngs_modulus, dimension::pressure, context.units);
  const double G = in_si(rod.shear->modulus, dimension::pressure, context.units);
  if (!of_solids.holds(G / E)) {
    const std::initializer_list<const char*> shown = {"GPa", "MPa", "kPa", "Pa"};
    remark(*shear, "G", Concern::material,
           fmt::format("found {}{} (metals have 0.3 to 0.5 of E, here {}); taken as given", in_best_unit(G, shown),
                       likely_slip(*shear, "G", {0.02 * E, 0.5 * E}, {"MPa", "GPa", "psi", "ksi", "kPa", "Pa"}, shown),
                       in_best_unit(E, shown)),
           context);
  }
  if (!share.holds(rod.shear->coefficient))
    remark(*shear, "k", Concern::section,
           fmt::format("found {:.4g} (the share of the section that carries the shear force is 0.05 to 1, of a "
                       "rectangle 5/6); taken as given",
                       rod.shear->coefficient),
           context);
}

// zeta = alpha_c omega_1/2 with the frequency of a slender rod.
void remark_on_damping(const TableView& elastic, const Body& body, const SceneContext& context) {
  constexpr double most = 0.5;
  const Elastic& rod = *body.elastic;
  const double k = std::numbers::pi / body.length;
  const double omega = k * k * std::sqrt(rod.youngs_modulus * rod.second_moment * body.length / body.mass);
  const double ratio = rod.internal_damping * omega / 2;
  if (!elastic.has("damping_internal") || ratio <= most) return;
  remark(elastic, "damping_internal", Concern::material,
         fmt::format("found {:.4g} {}, a damping ratio of {:.3g} of mode 1 (steel has 0.0005 to 0.01); taken as given; "
                     "damping_ratio takes a ratio",
                     rod.internal_damping, context.units.time, ratio),
         context);
}

// A section whose own size is that of the rod's length: numbers in another unit than the length.
bool remark_on_stoutness(const TableView& elastic, const Body& body, const SceneContext& context) {
  constexpr double least_slenderness = 8;  // height = 0.43 length of a rectangle
  const double F = body.elastic->area, J = body.elastic->second_moment, l = body.length;
  const double slenderness = l / std::sqrt(J / F);
  if (slenderness >= least_slenderness && F <= l * l / 4) return false;
  const char* key = elastic.has("section") ? "section" : "J";
  remark(elastic, key, Concern::size,
         fmt::format("found length/sqrt(J/area) = {:.3g} and area = {:.3g} length^2: no rod; are section and length in "
                     "their units? taken as given",
                     slenderness, F / (l * l)),
         context);
  return true;
}

// A link or slider, the crank and its flywheel aside, much heavier than all others together.
void remark_on_masses(const TableView& scene, const Linkage& linkage, const SceneContext& context) {
  constexpr double most = 100;
  struct BodyMass {
    std::string name;
    double mass;
    bool elastic;
  };
  std::vector<BodyMass> bodies;
  for (const Dyad& dyad : linkage.dyads) {
    bodies.push_back({dyad.coupler.name, dyad.coupler.mass, dyad.coupler.elastic.has_value()});
    if (const auto* slider = std::get_if<Slider>(&dyad.closing)) {
      bodies.push_back({slider->name, slider->mass, false});
    } else {
      const Body& rocker = std::get<Rocker>(dyad.closing).body;
      bodies.push_back({rocker.name, rocker.mass, rocker.elastic.has_value()});
    }
  }
  double all = linkage.crank.body.mass;
  for (const BodyMass& body : bodies) all += body.mass;
  for (const auto& [name, mass, elastic] : bodies) {
    if (elastic) continue;  // its density says more
    const double others = all - mass;
    if (!(others > 0 && mass > most * others)) continue;
    remark(
        scene, "dyad", Concern::size,
        fmt::format("found {} with {:.4g} kg, {:.3g} times all other bodies together; is its mass in its unit? taken "
                    "as given",
                    name, in_si(mass, dimension::mass, context.units), mass / others),
        context);
  }
}

}  // namespace

void remark_on_bore(const TableView& pressure, double bore, const SceneContext& context) {
  constexpr Window likely{1e-3, 2};
  const double metres = in_si(bore, dimension::length, context.units);
  if (likely.holds(metres)) return;
  const std::initializer_list<const char*> shown = {"m", "mm", "um"};
  remark(pressure, "bore", Concern::size,
         fmt::format("found {}{}; taken as given", in_best_unit(metres, shown),
                     likely_slip(pressure, "bore", {5e-3, 1}, {"mm", "m", "in", "cm"}, shown)),
         context);
}

void remark_on_elastic(const TableView& link, const TableView& elastic, const Body& body, const SceneContext& context) {
  const Elastic& rod = *body.elastic;
  constexpr Window stiff{1e9, 1.5e12}, likely{5e9, 7e11};
  const double E = in_si(rod.youngs_modulus, dimension::pressure, context.units);
  if (elastic.has("E") && !stiff.holds(E)) {
    const std::initializer_list<const char*> shown = {"GPa", "MPa", "kPa", "Pa"};
    remark(elastic, "E", Concern::material,
           fmt::format("found {}{} (solids have 1 GPa to 1.5 TPa); taken as given", in_best_unit(E, shown),
                       likely_slip(elastic, "E", likely, {"MPa", "GPa", "psi", "ksi", "kPa", "Pa"}, shown)),
           context);
  }
  remark_on_density(link, elastic, body, context);
  remark_on_strength(elastic, rod.strength, context);
  remark_on_shear(elastic, rod, context);
  remark_on_damping(elastic, body, context);

  // A square has J/F^2 = 1/12, a strip on edge or flat h/b times as much or as little.
  constexpr Window solid{1.0 / 240, 4};
  const double F = rod.area, J = rod.second_moment;
  if (!elastic.has("section") && !solid.holds(J / (F * F))) {
    remark(elastic, "J", Concern::section,
           fmt::format("found J/area^2 = {:.4g} (sections have 1/240 to 4, a square 1/12); are J and area in "
                       "the scene's unit of length?",
                       J / (F * F)),
           context);
  }
  const bool plausible = elastic.has("section") || solid.holds(J / (F * F));
  if (!plausible || remark_on_stoutness(elastic, body, context)) return;
  // The static deflection in one half wave grows by E/(k G) pi^2 J/(F l^2), E/(k G) = 3.1 with Poisson's ratio 0.3 and
  // k = 5/6: by 1 %, and omega_1 falls by half of that, from here.
  constexpr double per_size = 3.1, most_left_out = 0.003;
  const double size = std::numbers::pi * std::numbers::pi * J / (F * body.length * body.length);
  if (!rod.shear && !(size <= most_left_out)) {
    remark(
        elastic, elastic.has("J") ? "J" : "section", Concern::slenderness,
        fmt::format("found length/sqrt(J/area) = {:.3g}, a thick rod: shear, left out, would add about {:.2g} % to its "
                    "deflection; shear = {{ G, k }} in its elastic table takes it into account",
                    body.length / std::sqrt(J / F), 100 * per_size * size),
        context);
  }
}

void remark_on_linkage(const TableView& scene, const Linkage& linkage, const SceneContext& context) {
  const double g = std::abs(in_si(linkage.gravity, dimension::acceleration, context.units));
  if (linkage.gravity < 0)
    remark(scene, "gravity", Concern::gravity,
           fmt::format("found {:.4g}, which points up: a positive number is along -y; taken as given", linkage.gravity),
           context);
  if (scene.has("gravity") && g > 0 && !Window{1, 30}.holds(g)) {
    remark(scene, "gravity", Concern::gravity,
           fmt::format(
               "found {:.4g} m/s^2{}; taken as given", g,
               likely_slip(scene, "gravity", {9, 10.5}, {"m/s^2", "mm/s^2", "in/s^2", "ft/s^2", "cm/s^2"}, {"m/s^2"})),
           context);
  }
  double longest = linkage.crank.body.length;
  std::string name = "crank";
  for (int b = 1; b < linkage.num_bodies(); ++b) {
    const Body* body = body_at(linkage, b);
    if (body && body->length > longest) longest = body->length, name = body->name;
  }
  remark_on_masses(scene, linkage, context);
  const double metres = in_si(longest, dimension::length, context.units);
  if (Window{5e-4, 50}.holds(metres)) return;
  std::string slip;
  for (const char* unit : {"mm", "m", "in", "cm"}) {
    if (!slip.empty() || !Window{0.01, 5}.holds(longest * size_of(*parse_unit(unit).unit))) continue;
    slip = fmt::format("; {:.4g} {} if the numbers were in {} ([units] length = \"{}\")", longest, unit, unit, unit);
  }
  remark(scene, "crank", Concern::size,
         fmt::format("found {} with a length of {}{}; taken as given", name,
                     in_best_unit(metres, {"km", "m", "mm", "um"}), slip),
         context);
}

void remark_on_speed(const TableView& analysis, const AnalysisDefaults& defaults, const Linkage& linkage,
                     const SceneContext& context) {
  double omega = defaults.omega ? defaults.omega->to : 0;
  if (defaults.rpm) omega = speed_from_rpm(defaults.rpm->to, context.units);
  const double tip =
      omega / context.units.time_in_s * in_si(linkage.crank.body.length, dimension::length, context.units);
  if (!(tip > 300)) return;
  remark(analysis, defaults.rpm ? "rpm" : "omega", Concern::speed,
         fmt::format("found a crank whose tip moves at {:.4g} m/s; are speed and lengths in their units?", tip),
         context);
}

std::vector<std::string> warning_lines(std::vector<Remark> remarks) {
  std::erase_if(remarks, [](const Remark& remark) { return remark.concern == Concern::note; });
  std::ranges::stable_sort(remarks, std::greater{}, &Remark::concern);
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < remarks.size();) {
    const Concern concern = remarks[i].concern;
    const auto others = std::ranges::count(remarks, concern, &Remark::concern) - 1;
    lines.push_back(remarks[i].line() + (others == 0 ? "" : fmt::format(" (and {} more of this kind)", others)));
    i += static_cast<std::size_t>(others) + 1;
  }
  return lines;
}

std::vector<std::string> note_lines(const std::vector<Remark>& remarks) {
  std::vector<std::string> lines;
  for (const Remark& remark : remarks) {
    if (remark.concern == Concern::note) lines.push_back(remark.line());
  }
  return lines;
}

}  // namespace hb
