#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/fourier/periodic_samples.hpp"
#include "lib/scene/scene_parts.hpp"
#include "lib/rod/section.hpp"
#include "lib/scene/table_file.hpp"

namespace hb {

using std::numbers::pi;

namespace {

constexpr std::size_t max_dyads = 200;
constexpr const char* polar_words = "[radius >= 0, angle]";
constexpr const char* position_words = "[x, y]";

// Names of bodies and points stand in paths, in lists of rods and in file names.
bool good_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::ranges::none_of(name, [](unsigned char c) {
    return c <= 0x20 || c == 0x7f || std::string_view("./\\*=,:;\"'#").find(char(c)) != std::string_view::npos;
  });
}

constexpr const char* name_words =
    "a name of 1 to 64 characters without blanks and without . / \\ * = , : ; # or quotes";

class LinkageReader {
 public:
  LinkageReader(const TableView& scene, const SceneContext& context, std::vector<std::string>& warnings)
      : scene_(scene), context_(context), problems_(scene.problems()), warnings_(warnings) {}

  Linkage read() {
    Linkage linkage;
    const double metre_per_second2 = context_.units.time_in_s * context_.units.time_in_s / context_.units.length_in_m;
    linkage.gravity = scene_.number("gravity", any_number).value_or(9.80665 * metre_per_second2);
    if (const auto crank = scene_.need_table("crank")) linkage.crank = read_crank(*crank);
    read_dyads(linkage);
    return linkage;
  }

 private:
  struct Known {  // a body that dyads may hang on
    std::string name;
    int index;
    std::map<std::string, std::complex<double>> points;
    bool elastic;
  };

  std::complex<double> polar(std::complex<double> radius_angle) const {
    return std::polar(radius_angle.real(), radius_angle.imag() * context_.angle_unit());
  }

  std::optional<std::complex<double>> read_polar(const TableView& table, std::string_view key) {
    const auto pair = table.pair(key, polar_words);
    if (!pair) return std::nullopt;
    if (!(pair->real() >= 0)) {
      table.problem(key, fmt::format("found radius {}, allowed {}", pair->real(), polar_words));
      return std::nullopt;
    }
    return polar(*pair);
  }

  std::map<std::string, std::complex<double>> read_points(const TableView& body) {
    std::map<std::string, std::complex<double>> points;
    const auto table = body.table("points");
    if (!table) return points;
    for (const auto& [key, value] : table->table()) {
      const std::string name(key.str());
      if (!good_name(name)) {
        table->problem(
            name, fmt::format("found the name {}, allowed {}", describe(toml::value<std::string>(name)), name_words));
        continue;
      }
      if (name == "0" || name == "1" || name == "pivot" || name == "guide") {
        table->problem(
            name, fmt::format("found the name {}, which every link has for a joint of its own, allowed another", name));
        continue;
      }
      if (const auto point = read_polar(*table, name)) points[name] = *point;
    }
    return points;
  }

  // A name not used before; notes problems at `body`.
  void check_name(const TableView& body, const std::string& name) {
    if (!good_name(name)) {
      body.problem("name", fmt::format("found {}, allowed {}", describe(*body.node("name")), name_words));
      return;
    }
    const bool taken = std::ranges::find(known_, name, &Known::name) != known_.end();
    if (taken || name == "crank") {
      body.problem("name", fmt::format("found \"{}\", which is another body's name, allowed a new name", name));
    }
  }

  // Path of a body in messages: its name, or where it stands if it has none.
  TableView named(const TableView& table) const {
    const toml::node* name = table.node("name");
    const std::string text = name && name->is_string() ? name->as_string()->get() : "";
    return good_name(text) ? TableView(table.table(), text, problems_) : table;
  }

  std::string name_of(const TableView& body) {
    const std::string name = body.need_text("name");
    const toml::node* node = body.node("name");
    if (node && node->is_string()) check_name(body, name);
    return name;
  }

  // Mass, centre of mass and inertia of a rigid link. With a mass but neither centre nor inertia the link is a uniform
  // slender bar. `turns_evenly`: the inertia does no work (crank).
  void read_rigid_mass(const TableView& table, Body& body, bool turns_evenly) {
    body.mass = table.number("mass", not_negative).value_or(0);
    const auto com = read_polar(table, "com");
    const auto about_com = table.number("inertia", not_negative);
    const auto about_joint = table.number("inertia_pivot", not_negative);
    const bool has_inertia = table.has("inertia") || table.has("inertia_pivot");
    if (table.has("inertia") && table.has("inertia_pivot")) {
      table.problem("inertia_pivot", "found both inertia and inertia_pivot, allowed one of the two");
    }
    if (body.mass > 0 && !table.has("com") && !has_inertia) {
      body.com = body.length / 2;
      body.inertia = body.mass * body.length * body.length / 12;
      return;
    }
    if (body.mass > 0 && !table.has("com")) {
      table.missing("com", "the centre of mass [radius, angle] beside mass and inertia");
    }
    if (body.mass > 0 && !has_inertia && !turns_evenly) {
      table.missing("inertia",
                    "inertia (about the centre of mass) or inertia_pivot (about joint 0) beside mass and com");
    }
    body.com = com.value_or(0);
    body.inertia = about_com.value_or(0);
    if (!about_joint) return;
    // Steiner: J_0 = J_S + m r^2, so J_0 >= m r^2 for any real body. A link about a fixed pivot moves by J_0 alone, and
    // published data break the inequality there; elsewhere a negative J_S would be wrong physics.
    const double steiner = body.mass * std::norm(body.com);
    body.inertia = *about_joint - steiner;
    if (body.inertia >= 0) return;
    if (body.inertia >= -1e-14 * steiner) {  // a point mass, up to rounding
      body.inertia = 0;
      return;
    }
    const std::string message =
        fmt::format("found {}, allowed at least mass * radius^2 of com = {}", *about_joint, steiner);
    if (!table.has("pivot")) {
      table.problem("inertia_pivot", message);
    } else {
      warnings_.push_back(fmt::format("{}: {}: {}; taken as given, the link turns about a fixed pivot",
                                      problems_.place(*table.node("inertia_pivot")), table.path_of("inertia_pivot"),
                                      message));
    }
  }

  // Area and J: given as such, or by the section's shape.
  SectionValues read_section(const TableView& elastic) {
    const auto section = elastic.table("section");
    if (!section) {
      if (elastic.has("section")) return {1, 1};
      return {elastic.need_number("area", positive), elastic.need_number("J", positive)};
    }
    for (const char* key : {"area", "J"}) {
      if (elastic.has(key)) elastic.problem(key, "found beside section, allowed either area and J or section");
    }
    struct Shape {
      std::string_view name, first, second;
    };
    static constexpr Shape shapes[] = {
        {"rectangle", "width", "height"}, {"tube", "diameter", "wall"}, {"round", "diameter", ""}};
    const std::string name = section->need_text("shape");
    const auto shape = std::ranges::find(shapes, name, &Shape::name);
    if (shape == std::end(shapes)) {
      if (section->has("shape") && section->node("shape")->is_string())
        section->problem("shape",
                         fmt::format("found {}, allowed rectangle, tube, round", describe(*section->node("shape"))));
      return {1, 1};
    }
    for (const std::string_view key : {"width", "height", "diameter", "wall"}) {
      if (section->has(key) && key != shape->first && key != shape->second)
        section->problem(key, fmt::format("found on the shape {}, allowed {}{}{}", name, shape->first,
                                          shape->second.empty() ? "" : " and ", shape->second));
    }
    const double first = section->need_number(shape->first, positive);
    if (shape->second.empty()) return round_section(first);
    const double second = section->need_number(shape->second, positive);
    if (name == "rectangle") return rectangular_section(first, second);
    if (!(second <= first / 2)) {
      section->problem("wall", fmt::format("found {}, allowed at most half the diameter, {}", second, first / 2));
      return {1, 1};
    }
    return tubular_section(first, second);
  }

  void read_elastic(const TableView& table, const TableView& elastic, Body& body) {
    for (const char* key : {"com", "inertia", "inertia_pivot", "points"}) {
      if (!table.has(key)) continue;
      table.problem(key, std::string(key) == "points"
                             ? "found points on an elastic link, allowed exactly two joints"
                             : "found beside elastic, allowed on rigid links only (an elastic link is uniform)");
    }
    Elastic link;
    link.youngs_modulus = elastic.need_number("E", positive);
    const SectionValues section = read_section(elastic);
    link.area = section.area;
    link.second_moment = section.second_moment;
    link.internal_damping = elastic.number("damping_internal", not_negative).value_or(0);
    link.damping_x = elastic.number("damping_x", not_negative).value_or(0);
    link.damping_y = elastic.number("damping_y", not_negative).value_or(0);
    const double volume = link.area * body.length;
    if (elastic.has("density") && !table.has("mass")) {
      link.density = elastic.need_number("density", positive);
      body.mass = link.density * volume;
    } else {
      body.mass = table.need_number("mass", positive);
      link.density = elastic.number("density", positive).value_or(body.mass / volume);
    }
    body.com = body.length / 2;
    body.inertia = body.mass * body.length * body.length / 12 + link.density * link.second_moment * body.length;
    body.elastic = link;
  }

  Body read_body(const TableView& table, const std::string& name, bool is_crank) {
    Body body;
    body.name = name;
    body.length = table.need_number("length", positive);
    const auto elastic = is_crank ? std::nullopt : table.table("elastic");
    if (elastic) {
      read_elastic(table, *elastic, body);
    } else {
      read_rigid_mass(table, body, is_crank);
      body.points = read_points(table);
    }
    return body;
  }

  Crank read_crank(const TableView& table) {
    Crank crank;
    std::string name = "crank";
    if (table.has("name")) {
      name = table.need_text("name");
      const toml::node* node = table.node("name");
      if (node->is_string() && name != "crank") check_name(table, name);
    }
    crank.pivot = table.need_pair("pivot", position_words);
    crank.body = read_body(table, name, true);
    known_.push_back({name, 0, crank.body.points, false});
    return crank;
  }

  FourierSeries read_force(const TableView& slider) {
    const toml::node* node = slider.node("force");
    if (!node) return {};
    if (!node->is_table()) {
      static constexpr Limits words{-largest_number, largest_number, true,
                                    "a number, { cos = [...], sin = [...] } or { file = \"...\" }"};
      FourierSeries force(1, 0);
      force.c(0, 0) = slider.number("force", words).value_or(0);
      return force.c(0, 0) == 0.0 ? FourierSeries() : force;
    }
    const TableView table = *slider.table("force");
    const bool by_terms = table.has("cos") || table.has("sin");
    if (by_terms == table.has("file")) {
      slider.problem("force", fmt::format("found {}, allowed either cos and sin or file",
                                          by_terms ? "cos or sin beside file" : "an empty table"));
      return {};
    }
    if (!by_terms) return force_from_file(table);
    const std::vector<double> cos = table.numbers("cos", any_number).value_or(std::vector<double>());
    const std::vector<double> sin = table.numbers("sin", any_number).value_or(std::vector<double>());
    const std::size_t count = std::max(cos.size(), sin.size());
    if (count > max_harmonic + 1) {
      slider.problem("force", fmt::format("found {} harmonics, allowed at most {}", count - 1, max_harmonic));
      return {};
    }
    if (!sin.empty() && sin[0] != 0) {
      table.problem("sin", fmt::format("found {} first, allowed 0 (it belongs to harmonic 0)", sin[0]));
    }
    FourierSeries force(1, std::max<Eigen::Index>(1, static_cast<Eigen::Index>(count)) - 1);
    for (std::size_t k = 0; k < count; ++k) {
      force.c(0, static_cast<Eigen::Index>(k)) =
          harmonic_coefficient(int(k), k < cos.size() ? cos[k] : 0, k < sin.size() ? sin[k] : 0);
    }
    return force;
  }

  // Rows (crank angle, force) over one turn.
  FourierSeries force_from_file(const TableView& force) {
    const std::string file = force.need_text("file");
    if (file.empty()) return {};
    try {
      return force_series(read_table(context_.folder / file, 2, 3));
    } catch (const SceneError& error) {
      force.problem("file", fmt::format("found \"{}\" with {}", file, error.what()));
      return {};
    }
  }

  FourierSeries force_series(const NumberTable& table) {
    const auto fail = [&](Eigen::Index row, const std::string& message) {
      throw SceneError(fmt::format("{}:{}: {}", table.name, table.lines[static_cast<std::size_t>(row)], message));
    };
    const Eigen::VectorXd angles = table.values.col(0) * context_.angle_unit();
    const Eigen::VectorXd values = table.values.col(1);
    Eigen::Index n = angles.size();
    for (Eigen::Index j = 1; j < n; ++j) {
      if (!(angles(j) - angles(j - 1) >= 1e-9)) {
        fail(j, fmt::format("found crank angle {} after {}, allowed strictly increasing angles", table.values(j, 0),
                            table.values(j - 1, 0)));
      }
    }
    // Angles are often rounded to a few decimals: they are compared to a small part of the spacing.
    constexpr double closing = 0.01, even = 0.005;
    const double turn = 2 * pi, span = angles(n - 1) - angles(0);
    if (std::abs(span - turn) <= closing * turn / double(n)) {  // the first row once more
      const double largest = values.cwiseAbs().maxCoeff();
      if (!(std::abs(values(n - 1) - values(0)) <= 1e-6 * largest)) {
        fail(n - 1, fmt::format("found {} one turn after {}, allowed the same force", values(n - 1), values(0)));
      }
      --n;
    } else if (!(span < turn)) {
      fail(n - 1,
           fmt::format("found crank angle {}, allowed angles less than one turn after the first, {}, or one last "
                       "row a turn after it that repeats its force",
                       table.values(n - 1, 0), table.values(0, 0)));
    }
    if (n < 3) fail(n - 1, fmt::format("found {} different angles, allowed at least 3", n));
    double widest = angles(0) + turn - angles(n - 1);
    for (Eigen::Index j = 1; j < n; ++j) widest = std::max(widest, angles(j) - angles(j - 1));
    if (!(widest <= pi)) fail(n - 1, "found more than half a turn without a row, allowed rows all over one turn");

    const double step = turn / double(n);
    double uneven = 0;
    for (Eigen::Index j = 0; j < n; ++j) uneven = std::max(uneven, std::abs(angles(j) - angles(0) - double(j) * step));
    return uneven <= even * step ? interpolate(values.head(n).transpose(), angles(0))
                                 : spline_series(angles.head(n), values.head(n));
  }

  Slider read_slider(const TableView& table) {
    Slider slider;
    slider.name = name_of(table);
    slider.mass = table.number("mass", not_negative).value_or(0);
    slider.guide = table.need_pair("guide", position_words);
    slider.direction = table.number("direction", any_number).value_or(0) * context_.angle_unit();
    slider.force = read_force(table);
    slider.points = read_points(table);
    return slider;
  }

  // Names that `on` may take, given the bodies read so far.
  std::string attachments() const {
    std::vector<std::string> names = {"crank"};
    for (const Known& body : known_) {
      for (const auto& [point, position] : body.points) names.push_back(body.name + "." + point);
    }
    return joined(names);
  }

  Attachment read_attachment(const TableView& dyad, const Crank& crank, const std::vector<std::string>& all_names) {
    Attachment on;
    on.name = dyad.need_text("on");
    if (!dyad.has("on") || !dyad.node("on")->is_string()) return on;
    if (on.name == "crank" || on.name == crank.body.name) {
      on.point = crank.body.length;
      return on;
    }
    const std::size_t dot = on.name.find('.');
    const std::string link = on.name.substr(0, dot);
    const std::string point = dot == std::string::npos ? "" : on.name.substr(dot + 1);
    const auto body = std::ranges::find_if(
        known_, [&](const Known& known) { return known.name == link || (link == "crank" && known.index == 0); });
    const std::string found = describe(*dyad.node("on"));
    if (body == known_.end()) {
      const bool later = std::ranges::find(all_names, link) != all_names.end();
      dyad.problem("on", fmt::format("found {}{}, allowed a point of an earlier link: {}", found,
                                     later ? ", a link of this or a later dyad" : ", an unknown link", attachments()));
    } else if (body->elastic) {
      dyad.problem("on", fmt::format("found {}, a further joint on an elastic link, allowed {}", found, attachments()));
    } else if (const auto at = body->points.find(point); at != body->points.end()) {
      on.body = body->index;
      on.point = at->second;
    } else {
      dyad.problem("on", fmt::format("found {}, allowed {}", found, attachments()));
    }
    return on;
  }

  void read_dyads(Linkage& linkage) {
    const toml::node* node = scene_.node("dyad");
    if (!node) {
      scene_.missing("dyad", "one or more [[dyad]]");
      return;
    }
    const toml::array* list = node->as_array();
    if (!list || list->empty() || list->size() > max_dyads) {
      scene_.problem("dyad", fmt::format("found {}, allowed 1 to {} tables [[dyad]]", describe(*node), max_dyads));
      return;
    }
    std::vector<std::string> all_names;
    for (const toml::node& dyad : *list) {
      for (const char* role : {"coupler", "rocker", "slider"}) {
        if (const auto name = toml::node_view<const toml::node>(dyad)[role]["name"].value<std::string>()) {
          all_names.push_back(*name);
        }
      }
    }
    for (std::size_t d = 0; d < list->size(); ++d) {
      const std::string path = fmt::format("dyad.{}", d);
      if (!list->get(d)->is_table()) {
        problems_.add(*list->get(d), path, fmt::format("found {}, allowed a table", describe(*list->get(d))));
        continue;
      }
      const TableView table(*list->get(d)->as_table(), path, problems_);
      linkage.dyads.push_back(read_dyad(table, static_cast<int>(d), linkage.crank, all_names));
    }
  }

  Dyad read_dyad(const TableView& table, int d, const Crank& crank, const std::vector<std::string>& all_names) {
    Dyad dyad;
    dyad.on = read_attachment(table, crank, all_names);
    if (const auto coupler = table.need_table("coupler")) {
      const TableView body = named(*coupler);
      dyad.coupler = read_body(body, name_of(body), false);
      known_.push_back({dyad.coupler.name, coupler_index(d), dyad.coupler.points, dyad.coupler.elastic.has_value()});
    }
    if (table.has("rocker") == table.has("slider")) {
      table.problem(table.has("rocker") ? "slider" : "rocker",
                    fmt::format("found {}, allowed exactly one of the two",
                                table.has("rocker") ? "both rocker and slider" : "neither rocker nor slider"));
    } else if (const auto rocker = table.table("rocker")) {
      const TableView body = named(*rocker);
      Rocker closing;
      closing.body = read_body(body, name_of(body), false);
      closing.pivot = body.need_pair("pivot", position_words);
      known_.push_back({closing.body.name, closing_index(d), closing.body.points, closing.body.elastic.has_value()});
      dyad.closing = std::move(closing);
    } else if (const auto slider = table.table("slider")) {
      Slider closing = read_slider(named(*slider));
      known_.push_back({closing.name, closing_index(d), closing.points, false});
      dyad.closing = std::move(closing);
    }
    dyad.branch = read_branch(table);
    return dyad;
  }

  int read_branch(const TableView& dyad) {
    if (!dyad.has("branch")) dyad.missing("branch", "1 or -1");
    const toml::node* node = dyad.node("branch");
    if (!node) return 1;
    const auto* value = node->as_integer();
    if (value && (value->get() == 1 || value->get() == -1)) return static_cast<int>(value->get());
    dyad.problem("branch", fmt::format("found {}, allowed 1 or -1", describe(*node)));
    return 1;
  }

  const TableView& scene_;
  const SceneContext& context_;
  Problems& problems_;
  std::vector<std::string>& warnings_;
  std::vector<Known> known_;
};

}  // namespace

Linkage read_linkage(const TableView& scene, const SceneContext& context, std::vector<std::string>& warnings) {
  return LinkageReader(scene, context, warnings).read();
}

}  // namespace hb
