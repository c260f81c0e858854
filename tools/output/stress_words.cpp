#include "tools/output/stress_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/output/json.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {

void add_stress(nlohmann::ordered_json& rod, const RodStress& stress) {
  rod["axial_force"] = {{"tension", stress.tension},
                        {"compression", stress.compression},
                        {"buckling_load", stress.buckling_load},
                        {"buckling_share", stress.buckling_share()},
                        {"error", number(stress.force_error)},
                        {"buckling_share_error", number(stress.buckling_share_error())}};
  rod["stress"] = {{"axial", stress.axial},
                   {"axial_error", number(stress.axial_error)},
                   {"bending", stress.bending},
                   {"height_known", stress.height_known}};
  if (stress.bending_error) rod["stress"]["bending_error"] = number(*stress.bending_error);
  rod["strain"] = stress.strain;
}

// Digits that an engineer uses, no more than the error leaves: the model is not better than that.
std::string stress_lines(const RodStress& stress, const Body& link, const OutputUnits& units) {
  std::string text =
      fmt::format("  axial force       {:.4g} N pull, {:.4g} N push = {:.3g} of its buckling load\n",
                  stress.tension * units.force, stress.compression * units.force, stress.buckling_share());
  const int digits = stress.bending_error ? std::min(3, trusted_digits(stress.bending, *stress.bending_error)) : 3;
  text +=
      fmt::format("  stress            axial {:.3g} MPa, bending {:.{}g}{} MPa{}\n", stress.axial * units.megapascal,
                  stress.bending * units.megapascal, digits,
                  stress.bending_error ? fmt::format(" +/- {:.1e}", *stress.bending_error * units.megapascal) : "",
                  stress.height_known
                      ? ""
                      : fmt::format(" (as of a rectangle {:.3g} {} high: the scene gives no section)",
                                    2 * std::sqrt(3 * link.elastic->second_moment / link.elastic->area), units.length));
  return text;
}

}  // namespace hb::tools
