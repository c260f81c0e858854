#include "tools/report/rigid_forces.hpp"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "tools/output/json.hpp"

namespace hb::tools {

// Rigid forces are F0 + Omega F1 + Omega^2 F2: three speeds give the three series, by divided differences.
Json rigid_forces_json(const std::vector<ReportPlace>& places, ByteBlock& block) {
  std::vector<const ReportPlace*> known;
  for (const ReportPlace& place : places)
    if (place.result.forces) known.push_back(&place);
  if (known.empty()) return nullptr;
  const std::vector<const ReportPlace*> three =
      known.size() < 3 ? known : std::vector{known.front(), known[known.size() / 2], known.back()};
  const auto powers = [&](const std::function<const FourierSeries&(const JointForces&)>& of) {
    Eigen::Index H = 0;
    for (const ReportPlace* place : three) H = std::max(H, of(*place->result.forces).num_harmonics());
    std::vector<Eigen::MatrixXcd> d;
    std::vector<double> x;
    for (const ReportPlace* place : three) {
      d.push_back(fourier::resized(of(*place->result.forces), H).c);
      x.push_back(place->result.speed);
    }
    for (std::size_t order = 1; order < d.size(); ++order)
      for (std::size_t k = d.size() - 1; k >= order; --k) d[k] = (d[k] - d[k - 1]) / (x[k] - x[k - order]);
    // d0 + (Omega - x0) (d1 + (Omega - x1) d2) by powers.
    if (d.size() == 3) {
      d[0] += -x[0] * d[1] + x[0] * x[1] * d[2];
      d[1] -= (x[0] + x[1]) * d[2];
    } else if (d.size() == 2) {
      d[0] -= x[0] * d[1];
    }
    Json list = Json::array();
    for (const Eigen::MatrixXcd& c : d) list.push_back(block.series(FourierSeries(c), 1e-9));
    return list;
  };
  Json rigid;
  const std::vector<JointForce>& joints = three.front()->result.forces->joints;
  for (std::size_t j = 0; j < joints.size(); ++j)
    rigid["joints"][joints[j].name] =
        powers([j](const JointForces& f) -> const FourierSeries& { return f.joints[j].rigid; });
  rigid["torque"] = powers([](const JointForces& f) -> const FourierSeries& { return f.torque_rigid; });
  return rigid;
}

}  // namespace hb::tools
