#include "cases.hpp"

#include "lib/rod/rod.hpp"
#include "lib/scene/scene.hpp"
#include "synthetic.hpp"

namespace hb::benchmarks {

namespace {

void add_rod(std::vector<Case>& cases, const std::string& name, const std::string& scene_file, double second_moment,
             double rpm, bool integrate) {
  std::vector<Override> overrides;
  if (second_moment > 0) overrides.push_back({"*.J", std::to_string(second_moment)});
  const Scene scene = read_scene(scene_file, overrides);
  const auto& linkage = std::get<Linkage>(scene.model);
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  cases.push_back({name, ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 5),
                   speed_from_rpm(rpm, scene.units), integrate});
}

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  HillSystem mathieu;
  mathieu.mass = Eigen::MatrixXd::Ones(1, 1);
  mathieu.damping = Eigen::MatrixXd::Constant(1, 1, 0.1);
  mathieu.stiffness[0] = FourierSeries(1, 1);
  mathieu.stiffness[0].c << 1.2, 0.2;
  mathieu.load[0] = FourierSeries(1, 1);
  mathieu.load[0].c << 0, 0.5;
  cases.push_back({"mathieu", mathieu, 1, true});
  const std::string six_link = HB_SOURCE_DIR "/results/six_link/scene.toml";
  for (const int rpm : {300, 1500, 3000})
    add_rod(cases, "six_link_45_" + std::to_string(rpm) + "rpm", six_link, 45, rpm, true);
  add_rod(cases, "six_link_4500_300rpm", six_link, 4500, 300, false);
  add_rod(cases, "slider_crank_9000rpm", HB_SOURCE_DIR "/results/slider_crank/scene.toml", 0, 9000, false);
  for (const int I : {1, 2, 5, 10, 20, 40}) cases.push_back({"synthetic_" + std::to_string(I), synthetic(I), 1, false});
  return cases;
}

}  // namespace hb::benchmarks
