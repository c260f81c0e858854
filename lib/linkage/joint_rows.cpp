#include "lib/linkage/joint_rows.hpp"

namespace hb {

std::vector<JointRow> joint_rows(const Linkage& linkage) {
  using Kind = JointRow::Kind;
  std::vector<JointRow> rows;
  rows.push_back(
      {Kind::crank_pivot, 0, linkage.dyads.empty() ? 0 : coupler_index(0), linkage.crank.body.name + ".pivot"});
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Dyad& dyad = linkage.dyads[at(d)];
    const int coupler = coupler_index(d), closing = closing_index(d);
    rows.push_back({Kind::joint0, d, coupler, dyad.coupler.name + ".0"});
    rows.push_back({Kind::joint1, d, coupler, dyad.coupler.name + ".1"});
    const std::string& name = body_name(linkage, closing);
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      rows.push_back({Kind::ground, d, coupler, name + ".pivot"});
      if (rocker->body.elastic) {
        rows.push_back({Kind::rocker0, d, closing, name + ".0"});
        rows.push_back({Kind::rocker1, d, closing, name + ".1"});
      }
    } else {
      rows.push_back({Kind::guide, d, closing, name + ".guide"});
    }
  }
  return rows;
}

std::complex<double> resolved(const JointRow& row, const MechanismForces& forces,
                              const std::vector<BodyMotion>& motion) {
  return std::conj(motion[at(row.frame)].e) * force_of(row, forces.crank_pivot, forces.dyads);
}

}  // namespace hb
