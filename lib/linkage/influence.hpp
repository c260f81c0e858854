// Influence coefficients, lib/README.md (M13): what loads of one unit on the bodies ask of joints, motor and frame
// along the turn. They depend on neither speed nor deflection: one table serves all.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "lib/linkage/balance.hpp"

namespace hb {

// At tau_j = 2 pi j / N. Rows: x, y of each of joint_rows, the torque, then forces x, y and moment on the frame.
struct Influence {
  // Of the rigid motion's loads, quantities x N: gravity, external damping, inertia. Sum with 1, Omega, Omega^2.
  std::array<Eigen::MatrixXd, 3> rigid;
  // Of a force of 1 applied to a slider along its guide.
  struct AppliedForce {
    std::size_t dyad = 0;
    Eigen::MatrixXd unit;
  };
  std::vector<AppliedForce> applied;  // of the sliders that have one
  // Of forces of 1 along and across an elastic link and of a moment of 1 about its joint 0.
  struct Rod {
    int link = 0;  // body number
    std::vector<RodMotion> motion;
    std::array<Eigen::MatrixXd, 3> unit;
  };
  std::vector<Rod> rods;

  Eigen::Index num_samples() const { return rigid[0].cols(); }
};

// Of one linkage, at as many angles as were asked for so far. Threads may share it; values are the same whoever asks
// first.
class InfluenceTable {
 public:
  explicit InfluenceTable(const Linkage& linkage) : linkage_(linkage) {}

  const Linkage& linkage() const { return linkage_; }

  // At num_samples angles, a power of two, or at a multiple of these. Others wait while it is computed; may end by
  // Stopped (lib/stop_wish.hpp), the table then as before.
  [[nodiscard]] std::shared_ptr<const Influence> at(Eigen::Index num_samples) const;

 private:
  const Linkage linkage_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const Influence> finest_;
};

}  // namespace hb
