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

// The row's vector, of the forces on the joints of the dyads: complex numbers, or several of them.
template <class Vector, class Dyads>
Vector force_of(const JointRow& row, const Vector& crank_pivot, const Dyads& dyads) {
  if (row.kind == JointRow::Kind::crank_pivot) return crank_pivot;
  const auto& dyad = dyads[static_cast<std::size_t>(row.dyad)];
  switch (row.kind) {
    case JointRow::Kind::joint0:
      return dyad.joint0;
    case JointRow::Kind::joint1:
      return dyad.joint1;
    case JointRow::Kind::rocker0:
      return Vector{} - dyad.ground;
    case JointRow::Kind::rocker1:
      return Vector{} - dyad.joint1;
    default:
      return dyad.ground;
  }
}

// x + i y in the row's frame; of a guide only y counts.
[[nodiscard]] std::complex<double> resolved(const JointRow& row, const MechanismForces& forces,
                                            const std::vector<BodyMotion>& motion);

}  // namespace hb
