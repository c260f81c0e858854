#include "tests/fuzz/scene_mutations.hpp"

#include <cmath>

#include "lib/linkage/kinematics.hpp"
#include "lib/scene/scene.hpp"

namespace hb::fuzz {

namespace {

bool positive(double x) { return x > 0 && std::isfinite(x); }
bool not_negative(double x) { return x >= 0 && std::isfinite(x); }
bool finite(std::complex<double> z) { return std::isfinite(z.real()) && std::isfinite(z.imag()); }

std::string wrong_body(const Body& body, bool grounded) {
  if (body.name.empty() || body.name.find_first_of("./* ") != std::string::npos) return "name";
  if (!positive(body.length)) return "length";
  if (!not_negative(body.mass) || !finite(body.com)) return "mass";
  if (grounded ? !std::isfinite(body.inertia) : !not_negative(body.inertia)) return "inertia";
  for (const auto& [name, point] : body.points) {
    if (name.empty() || !finite(point)) return "point";
  }
  if (!body.elastic) return "";
  const Elastic& e = *body.elastic;
  if (!positive(e.youngs_modulus) || !positive(e.area) || !positive(e.second_moment) || !positive(e.density) ||
      !positive(body.mass)) {
    return "elastic";
  }
  if (!not_negative(e.internal_damping) || !not_negative(e.damping_x) || !not_negative(e.damping_y)) return "damping";
  return body.points.empty() ? "" : "point on an elastic link";
}

std::string wrong_linkage(const Linkage& linkage) {
  if (!std::isfinite(linkage.gravity)) return "gravity";
  if (linkage.dyads.empty() || linkage.dyads.size() > 200) return "number of dyads";
  std::string wrong = wrong_body(linkage.crank.body, true);
  for (std::size_t d = 0; d < linkage.dyads.size() && wrong.empty(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    if (dyad.branch != 1 && dyad.branch != -1) return "branch";
    if (dyad.on.body < 0 || dyad.on.body > 2 * static_cast<int>(d) || !finite(dyad.on.point)) return "attachment";
    wrong = wrong_body(dyad.coupler, false);
    if (!wrong.empty()) break;
    if (const Rocker* rocker = std::get_if<Rocker>(&dyad.closing)) {
      wrong = finite(rocker->pivot) ? wrong_body(rocker->body, true) : "pivot";
    } else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      if (!not_negative(slider.mass) || !finite(slider.guide) || !std::isfinite(slider.direction)) return "slider";
      if (!slider.force.c.allFinite() || slider.force.num_harmonics() > 10000) return "force";
    }
  }
  if (!wrong.empty()) return wrong;
  for (int j = 0; j < 8; ++j) {
    for (const BodyMotion& motion : motion_at(linkage, 0.8 * j)) {
      if (!finite(motion.z) || !finite(motion.e) || !std::isfinite(motion.phi2)) return "motion";
    }
  }
  return "";
}

std::string wrong_scene(const Scene& scene) {
  const AnalysisDefaults& analysis = scene.analysis;
  if (!(analysis.tolerance >= 1e-14 && analysis.tolerance <= 0.1)) return "tolerance";
  if (analysis.rpm && !(analysis.rpm->from > 0 && analysis.rpm->from <= analysis.rpm->to)) return "rpm";
  if (analysis.omega && !(positive(analysis.omega->from) && analysis.omega->from <= analysis.omega->to)) return "omega";
  if (!positive(scene.units.length_in_m) || !positive(scene.units.time_in_s)) return "units";
  if (const Linkage* linkage = std::get_if<Linkage>(&scene.model)) return wrong_linkage(*linkage);
  try {
    validate(std::get<HillSystem>(scene.model));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

}  // namespace

std::string check_scene_text(const std::string& text, const std::string& folder, bool& accepted) {
  accepted = false;
  try {
    const Scene scene = parse_scene(text, "scene", {}, folder);
    accepted = true;
    const std::string wrong = wrong_scene(scene);
    return wrong.empty() ? "" : "accepted with a wrong " + wrong;
  } catch (const SceneError& error) {
    const std::string message = error.what();
    if (!message.starts_with("scene")) return "message without a place: " + message;
    if (message.find("found") == std::string::npos || message.find("allowed") == std::string::npos) {
      return "message without what was found and what is allowed: " + message;
    }
    return "";
  } catch (const std::exception& error) {
    return std::string("an exception that is no SceneError: ") + error.what();
  }
}

}  // namespace hb::fuzz
