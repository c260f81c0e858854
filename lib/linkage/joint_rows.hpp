// The list of joints whose forces are reported, in the order and frames of joint_forces.hpp. Used inside the library.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

// One joint: which vector of the balance, in which body's frame.
struct JointRow {
  enum class Kind { crank_pivot, joint0, joint1, ground, rocker0, rocker1, guide } kind;
  int dyad;  // whose force
  int frame;  // body whose frame it is resolved in
  std::string name;
};

[[nodiscard]] std::vector<JointRow> joint_rows(const Linkage& linkage);

// x + i y in the row's frame; of a guide only y counts.
[[nodiscard]] std::complex<double> resolved(const JointRow& row, const MechanismForces& forces,
                                            const std::vector<BodyMotion>& motion);

}  // namespace hb
