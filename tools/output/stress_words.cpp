#include "tools/output/stress_words.hpp"

#include <fmt/core.h>

#include <cmath>

namespace hb::tools {

void add_stress(nlohmann::ordered_json& rod, const RodStress& stress) {
  rod["axial_force"] = {{"tension", stress.tension},
                        {"compression", stress.compression},
                        {"buckling_load", stress.buckling_load},
                        {"buckling_share", stress.buckling_share()}};
  rod["stress"] = {{"axial", stress.axial}, {"bending", stress.bending}, {"height_known", stress.height_known}};
  rod["strain"] = stress.strain;
}

// Digits that an engineer uses: the model is not better than that.
std::string stress_lines(const RodStress& stress, const Body& link, const OutputUnits& units) {
  std::string text =
      fmt::format("  axial force       {:.4g} N pull, {:.4g} N push = {:.3g} of its buckling load\n",
                  stress.tension * units.force, stress.compression * units.force, stress.buckling_share());
  text +=
      fmt::format("  stress            axial {:.3g} MPa, bending {:.3g} MPa{}\n", stress.axial * units.megapascal,
                  stress.bending * units.megapascal,
                  stress.height_known
                      ? ""
                      : fmt::format(" (as of a rectangle {:.3g} {} high: the scene gives no section)",
                                    2 * std::sqrt(3 * link.elastic->second_moment / link.elastic->area), units.length));
  return text;
}

}  // namespace hb::tools
