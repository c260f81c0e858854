#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/scene_parts.hpp"

namespace hb {

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
  LinkageReader(const TableView& scene, const SceneContext& context)
      : scene_(scene), context_(context), problems_(scene.problems()) {}

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
    return good_name(text) ? table.renamed(text) : table;
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
    if (!table.has("pivot")) {
      table.problem("inertia_pivot",
                    fmt::format("found {}, allowed at least mass * radius^2 of com = {}", *about_joint, steiner));
    } else {
      const std::string unit = context_.units.mass + " " + context_.units.length + "^2";
      context_.remarks.push_back(
          {Concern::note,
           fmt::format("{}: {}", problems_.place(*table.node("inertia_pivot")), table.path_of("inertia_pivot")),
           fmt::format("found {:.6g} {}, below mass radius^2 of com = {:.6g} {}, which no body has; taken as "
                       "given: the link turns about a fixed pivot, where inertia_pivot alone counts",
                       *about_joint, unit, steiner, unit)});
    }
  }

  Body read_body(const TableView& table, const std::string& name, bool is_crank) {
    Body body;
    body.name = name;
    body.length = table.need_number("length", positive);
    const auto elastic = is_crank ? std::nullopt : table.table("elastic");
    if (elastic) {
      read_elastic(table, *elastic, context_, body);
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

  Slider read_slider(const TableView& table, int branch) {
    Slider slider;
    slider.name = name_of(table);
    slider.mass = table.number("mass", not_negative).value_or(0);
    slider.guide = table.need_pair("guide", position_words);
    slider.direction = table.number("direction", any_number).value_or(0) * context_.angle_unit();
    slider.force = read_slider_force(table, branch, context_);
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
    on.name = dyad.need_text("on", "a point of an earlier link: " + attachments());
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
      const TableView table = scene_.inside(*list->get(d)->as_table(), path, "dyad");
      linkage.dyads.push_back(read_dyad(table, static_cast<int>(d), linkage.crank, all_names));
    }
  }

  Dyad read_dyad(const TableView& table, int d, const Crank& crank, const std::vector<std::string>& all_names) {
    Dyad dyad;
    dyad.on = read_attachment(table, crank, all_names);
    dyad.branch = read_branch(table);
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
      Slider closing = read_slider(named(*slider), dyad.branch);
      known_.push_back({closing.name, closing_index(d), closing.points, false});
      dyad.closing = std::move(closing);
    }
    return dyad;
  }

  int read_branch(const TableView& dyad) {
    const toml::node* node = dyad.node("branch");
    const auto* value = node ? node->as_integer() : nullptr;
    if (value && (value->get() == 1 || value->get() == -1)) return static_cast<int>(value->get());
    const toml::node_view<const toml::node> table(dyad.table());
    const std::string coupler = table["coupler"]["name"].value_or(std::string("coupler"));
    const std::string meaning =
        dyad.has("slider")
            ? fmt::format(
                  "the slider stands on the positive (1) or negative (-1) side, along its direction, of the foot "
                  "of the perpendicular from joint 0 of {}",
                  printable(coupler, 64))
            : fmt::format(
                  "seen from its pivot the rocker lies counter-clockwise (1) or clockwise (-1) of joint 0 of {}",
                  printable(coupler, 64));
    const std::string allowed = "1 or -1: " + meaning;
    if (!node) {
      dyad.missing("branch", allowed);
    } else {
      dyad.problem("branch", fmt::format("found {}, allowed {}", describe(*node), allowed));
    }
    return 1;
  }

  const TableView& scene_;
  const SceneContext& context_;
  Problems& problems_;
  std::vector<Known> known_;
};

}  // namespace

Linkage read_linkage(const TableView& scene, const SceneContext& context) {
  return LinkageReader(scene, context).read();
}

}  // namespace hb
