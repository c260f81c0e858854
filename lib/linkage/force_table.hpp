// What joint forces, torque and forces on the frame are made of at any speed, over the turn: the rigid ones in powers
// of the speed, and those of unit loads on each elastic link. Sampled once for a linkage, at its first use.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "lib/linkage/balance.hpp"
#include "lib/linkage/joint_rows.hpp"

namespace hb {

class ForceTable {
 public:
  // Crank angles next to each other in the samples, which operations serve at once.
  static constexpr Eigen::Index together = 8;
  using Angles = Eigen::Array<double, together, 1>;

  // Of n components: x and y of every row of joint_rows, the torque, then x, y and moment of the frame.
  struct Rod {
    RodMotion<Angles> motion;
    std::vector<RodLoad<Angles>> forces;  // n, of a unit of each load
  };
  struct Samples {
    std::array<std::vector<Angles>, 3> rigid;  // n, with 1, Omega, Omega^2
    std::vector<Rod> rods;  // in the order of links()
  };

  explicit ForceTable(Linkage linkage);

  const Linkage& linkage() const { return linkage_; }
  const std::vector<JointRow>& rows() const { return rows_; }
  const std::vector<int>& links() const { return links_; }  // body numbers of the elastic links
  Eigen::Index num_components() const { return 2 * static_cast<Eigen::Index>(rows_.size()) + 4; }

  // At tau_j = 2 pi j / N, j = begin, begin + step, ...: `count` of them, a multiple of `together`. Safe to call in
  // parallel.
  using Turn = std::vector<Samples>;
  [[nodiscard]] std::shared_ptr<const Turn> at(Eigen::Index N, Eigen::Index begin, Eigen::Index step,
                                               Eigen::Index count) const;

 private:
  [[nodiscard]] Turn sampled(Eigen::Index N, Eigen::Index begin, Eigen::Index step, Eigen::Index count) const;

  Linkage linkage_;
  std::vector<JointRow> rows_;
  std::vector<int> links_;
  using Place = std::tuple<Eigen::Index, Eigen::Index, Eigen::Index>;  // N, begin, step
  mutable std::mutex mutex_;
  mutable std::map<Place, std::shared_ptr<const Turn>> kept_;
};

}  // namespace hb
